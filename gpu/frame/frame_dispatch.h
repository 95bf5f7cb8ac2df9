/* The dispatch of a frame job: the rendering shader's module, its specialization constants and its
 * push constants. */
#ifndef FRAME_DISPATCH_H
#define FRAME_DISPATCH_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"
#include "ref/frame.h"

#define FRAME_BINDINGS  8u  /* storage buffers: ABI_BIND_STATE and so on */
#define FRAME_CONSTANTS 14u /* ABI_SPEC_* */

_Static_assert(ABI_BIND_SHADE == FRAME_BINDINGS - 1, "the rendering shaders have bindings 0 to 7");
_Static_assert(ABI_SPEC_LOOK == FRAME_CONSTANTS - 1, "the rendering shaders have constants 0-13");

/* What job.general's pipeline has room for, beside stacks of layout_stack_most. */
#define FRAME_GENERAL_LIGHTS  8u
#define FRAME_GENERAL_BOUNCES 8u

struct frame_dispatch {
    const struct shader *shader;
    uint32_t constant[FRAME_CONSTANTS]; /* what is recorded: the caller's */
    struct frame_push push;             /* all but the view and the place in the picture */
    enum frame_plan plan; /* FRAME_WHOLE or FRAME_STEPS, as the constant: frame_dispatch_plan */
    uint32_t tile;
    uint32_t rays; /* dispatches in steps */
    uint32_t part; /* triangles of one of them */
    uint64_t cost; /* nodes and triangles that a path may visit */
};

/* `brute`: without a tree. Errors: as dispatch_tree; STATUS_LIMIT more lights or bounces than
 * job->general has room for; STATUS_UNSUPPORTED a tile over the device's limit. */
enum status frame_dispatch_make(const struct frame_job *job, bool brute,
                                const struct vk_limits *limits, struct frame_dispatch *out,
                                struct reason *reason) MUST_USE;

void frame_dispatch_plan(struct frame_dispatch *dispatch, enum frame_plan plan);

/* What vk_pipeline_make needs; borrows the dispatch. */
struct vk_shader frame_dispatch_shader(const struct frame_dispatch *dispatch);

#endif

/* The dispatch of a frame job: the rendering shader's module, specialization constants and push
 * constants. */
#ifndef FRAME_DISPATCH_H
#define FRAME_DISPATCH_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"
#include "ref/frame.h"

#define FRAME_BINDINGS  8u  /* storage buffers, by ABI_BIND_* */
#define FRAME_CONSTANTS 14u /* by ABI_SPEC_* */

_Static_assert(ABI_BIND_SHADE == FRAME_BINDINGS - 1, "the rendering shaders have bindings 0 to 7");
_Static_assert(ABI_SPEC_LOOK == FRAME_CONSTANTS - 1, "the rendering shaders have constants 0-13");

/* Limits of the pipeline for job.general; its stack is layout_stack_most. */
#define FRAME_GENERAL_LIGHTS  8u
#define FRAME_GENERAL_BOUNCES 8u

struct frame_dispatch {
    const struct shader *shader;
    uint32_t constant[FRAME_CONSTANTS]; /* LOOK: the caller adds the recording flags */
    struct frame_push push;             /* all but the view and the position in the picture */
    enum frame_plan plan;               /* FRAME_WHOLE or FRAME_STEPS; set by frame_dispatch_plan */
    uint32_t tile;
    uint32_t rays; /* dispatches of FRAME_STEPS */
    uint32_t part; /* triangles of one dispatch */
    uint64_t cost; /* most nodes and triangles that a path visits */
};

/* Makes the dispatch; `brute`: without a tree. Errors: as dispatch_tree; STATUS_LIMIT more lights
 * or bounces than the pipeline for job->general takes; STATUS_UNSUPPORTED a tile over the device's
 * limit. */
enum status frame_dispatch_make(const struct frame_job *job, bool brute,
                                const struct vk_limits *limits, struct frame_dispatch *out,
                                struct reason *reason) MUST_USE;

void frame_dispatch_plan(struct frame_dispatch *dispatch, enum frame_plan plan);

/* Returns the argument for vk_pipeline_make; borrows the dispatch. */
struct vk_shader frame_dispatch_shader(const struct frame_dispatch *dispatch);

#endif

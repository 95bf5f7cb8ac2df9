/* One dispatch of a tracing shader: which module, its specialization constants, its push constants.
 * Used by the engines, and by `raydiff export`, which writes it to a file. */
#ifndef DISPATCH_H
#define DISPATCH_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"
#include "ref/engine.h"

#define DISPATCH_BINDINGS  7u /* storage buffers, by ABI_BIND_* */
#define DISPATCH_CONSTANTS 8u /* by ABI_SPEC_* */

_Static_assert(ABI_BIND_FOUND == DISPATCH_BINDINGS - 1, "the tracing shaders have bindings 0 to 6");
_Static_assert(ABI_SPEC_LAYOUT_1 == DISPATCH_CONSTANTS - 1, "the tracing shaders have 0 to 7");

/* Triangles of one dispatch of engine vulkan_brute: under lavapipe 22's loop cap of 65,535. */
#define DISPATCH_PART 16384u

struct dispatch {
    const struct shader *shader;
    uint32_t constant[DISPATCH_CONSTANTS];
    struct push push; /* ray_count is 0 and capacity 1 unless the caller sets them */
    bool accel;       /* binding DISPATCH_BINDINGS is an acceleration structure */
};

/* Of engine vulkan: job->packed is needed. The stack is the smallest that is enough: a larger
 * private array costs every ray. Errors: STATUS_LIMIT the tree needs a deeper stack than there is;
 * STATUS_UNSUPPORTED no shader for the layout. */
enum status dispatch_tree(const struct job *job, uint32_t workgroup, struct dispatch *out,
                          struct reason *reason) MUST_USE;

/* Of engine vulkan_brute: the first DISPATCH_PART triangles; `push` for those from `first` on. */
struct dispatch dispatch_brute(const struct job *job, uint32_t workgroup);
struct push dispatch_brute_push(uint32_t tri_count, uint32_t first);

/* Of engine rayquery. */
struct dispatch dispatch_query(const struct job *job, uint32_t workgroup);

/* Workgroups for so many rays. */
uint32_t dispatch_groups(const struct dispatch *dispatch, uint32_t ray_count);

/* Describes why a ray was not finished, by its flags. */
const char *dispatch_cause(uint32_t flag);

/* What vk_pipeline_make needs; borrows the dispatch. */
struct vk_shader dispatch_shader(const struct dispatch *dispatch);

#endif

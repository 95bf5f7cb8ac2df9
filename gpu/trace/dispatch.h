/* One dispatch of a tracing shader: its module, specialization constants and push constants. Used
 * by the engines, and by `raydiff export`, which writes it to a file. */
#ifndef DISPATCH_H
#define DISPATCH_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"
#include "ref/engine.h"

#define DISPATCH_BINDINGS  7u /* storage buffers, by ABI_BIND_* */
#define DISPATCH_CONSTANTS 8u /* by ABI_SPEC_* */

_Static_assert(ABI_BIND_FOUND == DISPATCH_BINDINGS - 1, "the tracing shaders have bindings 0 to 6");
_Static_assert(ABI_SPEC_LAYOUT_1 == DISPATCH_CONSTANTS - 1, "the tracing shaders have 0 to 7");

/* Triangles of one dispatch of engine vulkan_brute: fewer than lavapipe 22's limit of 65,535
 * iterations. */
#define DISPATCH_PART 16384u

struct dispatch {
    const struct shader *shader;
    uint32_t constant[DISPATCH_CONSTANTS];
    struct push push; /* ray_count is 0 and capacity 1 unless the caller sets them */
    bool accel;       /* binding DISPATCH_BINDINGS is an acceleration structure */
};

/* Makes the dispatch of engine vulkan; job->packed must be set. The stack is the smallest that
 * suffices, as a larger private array costs every ray. Errors: STATUS_LIMIT the tree needs a deeper
 * stack than there is; STATUS_UNSUPPORTED no shader for the layout. */
enum status dispatch_tree(const struct job *job, uint32_t workgroup, struct dispatch *out,
                          struct reason *reason) MUST_USE;

/* Finds the smallest stack that holds `need` entries: 16, 32, 64 and so on. Errors: STATUS_LIMIT
 * `need` is over `most`. */
enum status dispatch_stack(uint32_t need, uint32_t most, uint32_t *out,
                           struct reason *reason) MUST_USE;

/* Makes the dispatch of engine vulkan_brute for the first DISPATCH_PART triangles, or the push
 * constants for those from `first` on. */
struct dispatch dispatch_brute(const struct job *job, uint32_t workgroup);
struct push dispatch_brute_push(uint32_t tri_count, uint32_t first);

/* Makes the dispatch of engine rayquery. */
struct dispatch dispatch_query(const struct job *job, uint32_t workgroup);

/* Returns the number of workgroups for `ray_count` rays. */
uint32_t dispatch_groups(const struct dispatch *dispatch, uint32_t ray_count);

/* Returns why a ray was not finished, from its flags. */
const char *dispatch_cause(uint32_t flag);

/* Returns the argument for vk_pipeline_make; borrows the dispatch. */
struct vk_shader dispatch_shader(const struct dispatch *dispatch);

#endif

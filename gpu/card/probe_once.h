/* Runs a shader that measures the driver: one input buffer, one output buffer, one dispatch. */
#ifndef PROBE_ONCE_H
#define PROBE_ONCE_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"

struct probe_job {
    const struct shader *shader;
    uint32_t group, groups; /* invocations of a workgroup, and workgroups */
    const void *push;
    uint32_t push_bytes;
    const void *in; /* binding 0 */
    uint64_t in_bytes;
    void *out; /* binding 1 */
    uint64_t out_bytes;
};

/* Compiles and runs the shader and reads its output; keeps nothing. Errors: as vk_pipeline_make,
 * vk_buffer_make and vk_dispatch. */
enum status probe_once(struct vk *vk, const struct probe_job *job, struct reason *reason) MUST_USE;

#endif

/* A shader that measures the driver: one buffer in, one buffer out, one dispatch. */
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

/* Compiles, runs and reads back; nothing is kept. Errors: as vk_pipeline_make, vk_buffer_make and
 * vk_dispatch. */
enum status probe_once(struct vk *vk, const struct probe_job *job, struct reason *reason) MUST_USE;

#endif

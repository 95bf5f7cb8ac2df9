/* A cache of pipelines, by shader and constants. */
#ifndef PIPELINES_H
#define PIPELINES_H

#include "gpu/vk/vk.h"

struct pipelines {
    struct pipeline_kept *kept;
    size_t count, capacity;
};

/* Finds or makes the pipeline of the shader as the device's compiler has it; the list owns it.
 * Errors: as vk_compile and vk_pipeline_make. */
enum status pipelines_find(struct pipelines *pipelines, struct vk *vk,
                           const struct vk_shader *shader, struct vk_pipeline **out,
                           struct reason *reason) MUST_USE;

/* Frees all pipelines and zeroes the list. Does nothing on a zero list. */
void pipelines_free(struct pipelines *pipelines, struct vk *vk);

#endif

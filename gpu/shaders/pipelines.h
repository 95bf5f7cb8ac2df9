/* Pipelines by shader and constants: made once, kept. */
#ifndef PIPELINES_H
#define PIPELINES_H

#include "gpu/vk/vk.h"

struct pipelines {
    struct pipeline_kept *kept;
    size_t count, capacity;
};

/* Finds or makes the pipeline; it belongs to the list. Errors: as vk_pipeline_make. */
enum status pipelines_find(struct pipelines *pipelines, struct vk *vk,
                           const struct vk_shader *shader, struct vk_pipeline **out,
                           struct reason *reason) MUST_USE;

/* Frees all and zeroes the list. A zero list is fine. */
void pipelines_free(struct pipelines *pipelines, struct vk *vk);

#endif

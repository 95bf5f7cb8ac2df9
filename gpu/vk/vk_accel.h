/* Acceleration structures for ray queries (VK_KHR_acceleration_structure, VK_KHR_ray_query). Only
 * for devices opened with vk_options.ray_query. */
#ifndef VK_ACCEL_H
#define VK_ACCEL_H

#include "gpu/vk/vk.h"

struct vk_accel; /* one mesh, and one instance of it without a transform */

/* Builds a structure from `tri_count` triples of indices (uint32_t) into vertices (three floats),
 * at least 1 of each. The buffers may be freed afterwards. *out is NULL on error.
 * Errors: STATUS_LIMIT more triangles than the device allows, or too large a structure;
 * STATUS_MEMORY; STATUS_DEVICE. */
enum status vk_accel_make(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                          struct vk_buffer *indices, uint32_t tri_count, struct vk_accel **out,
                          struct reason *reason) MUST_USE;

void vk_accel_free(struct vk *vk, struct vk_accel *accel); /* NULL is fine */
uint64_t vk_accel_bytes(const struct vk_accel *accel);     /* NULL: 0 */

/* Binds the structure to a pipeline made with vk_shader.accel, for later dispatches. */
void vk_pipeline_use(struct vk *vk, struct vk_pipeline *pipeline, const struct vk_accel *accel);

#endif

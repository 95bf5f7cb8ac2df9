/* Buffers of triangles in the form that the tracing shaders read. */
#ifndef GATHER_H
#define GATHER_H

#include "gpu/vk/vk.h"
#include "ref/scene/scene.h"

/* Bytes of a buffer of `count` triangles: ABI_TRI_FLOATS floats each, padded to whole quads, which
 * shaders read. */
uint64_t gather_bytes(uint64_t count);

/* Makes a buffer of all triangles, in scene order. *out is NULL on error. Errors: as vk_buffer_make
 * and _write. */
enum status gather_triangles(struct vk *vk, const struct scene *scene, struct vk_buffer **out,
                             struct reason *reason) MUST_USE;

/* Writes all triangles behind the first `first` of a buffer. Errors: as vk_buffer_write;
 * STATUS_MEMORY. */
enum status gather_write(struct vk *vk, const struct scene *scene, struct vk_buffer *buffer,
                         uint64_t first, struct reason *reason) MUST_USE;

#endif

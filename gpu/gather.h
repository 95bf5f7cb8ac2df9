/* Triangles as the tracing shaders read them. */
#ifndef GATHER_H
#define GATHER_H

#include "gpu/vk.h"
#include "ref/scene.h"

/* Makes a buffer of ABI_TRI_FLOATS floats per triangle, in scene order, padded to whole quads of
 * floats: shaders read quads. *out is NULL on error. Errors: as vk_buffer_make and _write. */
enum status gather_triangles(struct vk *vk, const struct scene *scene, struct vk_buffer **out,
                             struct reason *reason) MUST_USE;

#endif

/* Copies a packed world to a device; for gpu/trace/world_runner.c. */
#ifndef WORLD_UPLOAD_H
#define WORLD_UPLOAD_H

#include "gpu/vk/vk.h"
#include "ref/abi_world.h"
#include "ref/engine.h"

struct world;

#define WORLD_BINDINGS (ABI_BIND_WORLD + 1u)

/* Whether the shaders can read the job's trees. Errors: STATUS_UNSUPPORTED trees of several layouts
 * or storages, a triangle test that the storage does not have. */
enum status world_upload_check(const struct world_job *job, struct reason *reason) MUST_USE;

/* Makes the buffers of nodes, items, triangles and the world, and sets those members of *push that
 * depend on the world. Without job->packed there are no trees. A buffer of the right size is kept
 * and written again; on error buffers that were made are left in `buffer`. Errors: STATUS_LIMIT a
 * buffer over the device's limits, or, without job->packed, the inverse of a transform beyond
 * float32; STATUS_DEVICE; STATUS_MEMORY. */
enum status world_upload(struct vk *vk, const struct world_job *job,
                         struct vk_buffer *buffer[WORLD_BINDINGS], struct world_push *push,
                         struct reason *reason) MUST_USE;

/* Makes the buffer of the world for shader query_world, and sets *push likewise. Errors: the
 * same. */
enum status world_upload_query(struct vk *vk, const struct world *world, struct vk_buffer **out,
                               struct world_push *push, struct reason *reason) MUST_USE;

#endif

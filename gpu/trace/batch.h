/* Rays of one dispatch with the buffers that they are answered in: what the engines without a
 * packed tree share. */
#ifndef BATCH_H
#define BATCH_H

#include "gpu/vk/vk.h"
#include "ref/engine.h"

#define BATCH_BINDINGS (ABI_BIND_FOUND + 1u)

struct batch {
    struct vk *vk; /* borrowed */
    uint32_t workgroup;
    bool lists;        /* QUERY_ALL: `capacity` hits a ray, and their number */
    uint32_t capacity; /* else 1 */
    uint32_t most;     /* rays */
    struct vk_buffer *rays, *flags, *none;
    struct vk_buffer *hits[2],
        *found[2]; /* the second ones for engines that continue from the first */
    uint32_t *flag;
};

/* Makes buffers for `ray_count` rays, or for as many as the device, and 64 MiB of lists, allow
 * (batch->most); `two` for both buffers of each kind (lists of hits grow in place in the first).
 * batch_free in any case. Errors: STATUS_LIMIT one ray's hits are over the device's buffers;
 * STATUS_MEMORY; STATUS_DEVICE. */
enum status batch_make(struct vk *vk, uint32_t workgroup, size_t ray_count, bool lists,
                       uint32_t capacity, bool two, struct batch *out,
                       struct reason *reason) MUST_USE;
void batch_free(struct batch *batch);

uint64_t batch_bytes(const struct batch *batch);

/* Uploads the rays of the next dispatches, at most batch->most. */
enum status batch_rays(struct batch *batch, const struct ray *ray, uint32_t count,
                       struct reason *reason) MUST_USE;

/* Dispatches push->ray_count invocations and sees that each of them ran to its end; ray `first` is
 * the first one, for messages. Errors: as vk_dispatch; STATUS_DEVICE a ray was not finished. */
enum status batch_run(struct batch *batch, struct vk_pipeline *pipeline,
                      struct vk_buffer *const buffer[BATCH_BINDINGS], const struct push *push,
                      size_t first, struct vk_time *time, struct reason *reason) MUST_USE;

/* Reads the answers of `count` rays out of hits[which] and, for lists, found[turn]. */
enum status batch_read(struct batch *batch, int which, int turn, uint32_t count, struct hit *hit,
                       uint32_t *found, struct reason *reason) MUST_USE;

#endif

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

/* Where the answers of a call go. */
struct batch_answers {
    struct hit *hit;
    uint32_t *found; /* QUERY_ALL, else NULL */
    uint32_t capacity;
};

/* What an engine begins with that answers its rays batch by batch. */
struct batch_engine {
    struct vk *vk;
    uint32_t workgroup;
    struct vk_pipeline *chosen; /* of the job; NULL: none prepared */
    bool lists;                 /* prepared for QUERY_ALL */
    bool two;                   /* as batch_make */
    bool empty;                 /* no triangle: every ray misses, without a batch */
    uint64_t bytes;             /* of what was uploaded for the job */
    /* The most rays of the next batch, at least 1. */
    uint64_t (*most)(const struct batch_engine *engine);
    /* Answers `count` rays, which begin at ray `first`, and adds to the report's time. */
    enum status (*answer)(struct batch_engine *engine, struct batch *batch, const struct ray *ray,
                          size_t first, uint32_t count, const struct batch_answers *to,
                          struct trace_report *report, struct reason *reason);
};

/* engine.trace and engine.trace_all of an engine that begins with a struct batch_engine. Errors: as those;
 * STATUS_DEVICE the engine is not prepared for this query, or the validation layers have messages. */
enum status batch_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                        struct trace_report *report, struct reason *reason) MUST_USE;
enum status batch_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                            struct hit *hit, uint32_t *hit_count, struct reason *reason) MUST_USE;

#endif

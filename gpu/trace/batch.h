/* The rays of one dispatch and the buffers for their results. Shared by the engines without a
 * packed tree. */
#ifndef BATCH_H
#define BATCH_H

#include "gpu/vk/vk.h"
#include "ref/engine.h"

#define BATCH_BINDINGS (ABI_BIND_FOUND + 1u)

struct batch {
    struct vk *vk; /* borrowed */
    uint32_t workgroup;
    bool lists;        /* QUERY_ALL: `capacity` hits a ray, and their number */
    uint32_t capacity; /* 1 unless `lists` */
    uint32_t most;     /* most rays of a batch */
    struct vk_buffer *rays, *flags, *none;
    struct vk_buffer *hits[2],
        *found[2]; /* second buffers: for engines that continue from the first */
    uint32_t *flag;
};

/* Makes buffers for `ray_count` rays, or for as many as the device and 64 MiB of lists allow
 * (batch->most). `two`: two buffers of each kind, except that lists of hits grow in place in the
 * first. Call batch_free also on error. Errors: STATUS_LIMIT one ray's hits are over the device's
 * buffers; STATUS_MEMORY; STATUS_DEVICE. */
enum status batch_make(struct vk *vk, uint32_t workgroup, size_t ray_count, bool lists,
                       uint32_t capacity, bool two, struct batch *out,
                       struct reason *reason) MUST_USE;
void batch_free(struct batch *batch);

uint64_t batch_bytes(const struct batch *batch);

/* Uploads the rays of the next dispatches, at most batch->most. */
enum status batch_rays(struct batch *batch, const struct ray *ray, uint32_t count,
                       struct reason *reason) MUST_USE;

/* Dispatches push->ray_count invocations and checks that each ran to its end. `first` is the index
 * of the first ray, for messages. Errors: as vk_dispatch; STATUS_DEVICE a ray was not finished. */
enum status batch_run(struct batch *batch, struct vk_pipeline *pipeline,
                      struct vk_buffer *const buffer[BATCH_BINDINGS], const struct push *push,
                      size_t first, struct vk_time *time, struct reason *reason) MUST_USE;

/* Reads the results of `count` rays from hits[which] and, for lists, found[turn]. */
enum status batch_read(struct batch *batch, int which, int turn, uint32_t count, struct hit *hit,
                       uint32_t *found, struct reason *reason) MUST_USE;

/* The caller's arrays for results. */
struct batch_answers {
    struct hit *hit;
    uint32_t *found; /* QUERY_ALL; else NULL */
    uint32_t capacity;
};

/* The first member of an engine that traces its rays in batches. */
struct batch_engine {
    struct vk *vk;
    uint32_t workgroup;
    struct vk_pipeline *chosen; /* for the job; NULL: none prepared */
    bool lists;                 /* prepared for QUERY_ALL */
    bool two;                   /* argument of batch_make */
    bool empty;                 /* no triangles: every ray misses, without a dispatch */
    uint64_t bytes;             /* uploaded for the job */
    /* Returns the most rays of the next batch, at least 1. */
    uint64_t (*most)(const struct batch_engine *engine);
    /* Traces `count` rays, the first of which is ray `first`, and adds to the report's time. */
    enum status (*answer)(struct batch_engine *engine, struct batch *batch, const struct ray *ray,
                          size_t first, uint32_t count, const struct batch_answers *to,
                          struct trace_report *report, struct reason *reason);
};

/* engine.trace and engine.trace_all of an engine that begins with a struct batch_engine. Errors: as
 * those; STATUS_DEVICE the engine is not prepared for this query, or the validation layers have
 * messages. */
enum status batch_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                        struct trace_report *report, struct reason *reason) MUST_USE;
enum status batch_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                            struct hit *hit, uint32_t *hit_count, struct reason *reason) MUST_USE;

#endif

#include "gpu/trace/batch.h"

#include <stdlib.h>
#include <string.h>

#define RAYS_MOST (1u << 18)
#define LIST_MOST (1u << 22) /* hits of all lists */

static uint64_t least_of(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t rays_at_once(const struct batch *batch)
{
    const struct vk_limits *limits = vk_limits(batch->vk);
    const uint64_t hits = batch->capacity ? batch->capacity : 1;
    uint64_t most = least_of(RAYS_MOST, (uint64_t)limits->groups * batch->workgroup);
    if (batch->lists)
        most = least_of(most, LIST_MOST / hits ? LIST_MOST / hits : 1);
    most = least_of(most, limits->buffer_bytes / (hits * sizeof(struct hit)));
    return least_of(most, vk_quad_bytes(batch->vk) / sizeof(struct ray));
}

static enum status make_answers(struct batch *batch, bool two, struct reason *reason)
{
    const uint64_t word = sizeof *batch->flag;
    const uint64_t hits = (uint64_t)batch->most * (batch->capacity ? batch->capacity : 1);
    enum status status = STATUS_OK;
    for (int i = 0; i < (two ? 2 : 1) && !status; i++) {
        if (!batch->lists || i == 0)
            status = vk_buffer_make(batch->vk, hits * sizeof(struct hit), &batch->hits[i], reason);
        if (!status)
            status = vk_buffer_make(batch->vk, batch->lists ? batch->most * word : 0,
                                    &batch->found[i], reason);
    }
    return status;
}

enum status batch_make(struct vk *vk, uint32_t workgroup, size_t ray_count, bool lists,
                       uint32_t capacity, bool two, struct batch *out, struct reason *reason)
{
    *out = (struct batch){
        .vk = vk, .workgroup = workgroup, .lists = lists, .capacity = lists ? capacity : 1};
    const uint64_t most = least_of(rays_at_once(out), ray_count ? ray_count : 1);
    if (most == 0)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %u hits of a ray are over %s's buffers of %llu bytes", capacity,
                    vk_limits(vk)->device, (unsigned long long)vk_limits(vk)->buffer_bytes);
    out->most = (uint32_t)most;
    out->flag = alloc_zeroed(most, sizeof *out->flag);
    if (!out->flag)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the flags of %u rays", out->most);
    enum status status = vk_buffer_make(vk, most * sizeof(struct ray), &out->rays, reason);
    if (!status)
        status = vk_buffer_make(vk, most * sizeof *out->flag, &out->flags, reason);
    if (!status)
        status = vk_buffer_make(vk, 0, &out->none, reason);
    return status ? status : make_answers(out, two, reason);
}

void batch_free(struct batch *batch)
{
    struct vk_buffer *all[] = {batch->rays,    batch->flags,    batch->none,    batch->hits[0],
                               batch->hits[1], batch->found[0], batch->found[1]};
    for (size_t i = 0; i < ARRAY_COUNT(all); i++)
        vk_buffer_free(batch->vk, all[i]);
    free(batch->flag);
    *batch = (struct batch){0};
}

uint64_t batch_bytes(const struct batch *batch)
{
    return vk_buffer_bytes(batch->rays) + vk_buffer_bytes(batch->flags) +
           vk_buffer_bytes(batch->hits[0]) + vk_buffer_bytes(batch->hits[1]) +
           vk_buffer_bytes(batch->found[0]) + vk_buffer_bytes(batch->found[1]);
}

enum status batch_rays(struct batch *batch, const struct ray *ray, uint32_t count,
                       struct reason *reason)
{
    return vk_buffer_write(batch->vk, batch->rays, 0, ray, count * sizeof *ray, reason);
}

static enum status check_flags(const struct batch *batch, size_t first, uint32_t count,
                               struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (batch->flag[i] != ABI_FLAG_DONE)
            return fail(reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                        vk_limits(batch->vk)->device, first + i,
                        batch->flag[i] & ABI_FLAG_LOOP ? "the driver ended its loop early"
                                                       : "its invocation did not run to the end");
    return STATUS_OK;
}

enum status batch_run(struct batch *batch, struct vk_pipeline *pipeline,
                      struct vk_buffer *const buffer[BATCH_BINDINGS], const struct push *push,
                      size_t first, struct vk_time *time, struct reason *reason)
{
    const uint64_t flag_bytes = push->ray_count * sizeof *batch->flag;
    memset(batch->flag, 0, flag_bytes); /* so that a ray that is not traced has no DONE */
    enum status status =
        vk_buffer_write(batch->vk, batch->flags, 0, batch->flag, flag_bytes, reason);
    uint32_t groups = (push->ray_count + batch->workgroup - 1) / batch->workgroup;
    if (!status)
        status = vk_dispatch(batch->vk, pipeline, buffer, push, groups, time, reason);
    if (!status)
        status = vk_buffer_read(batch->vk, batch->flags, 0, batch->flag, flag_bytes, reason);
    return status ? status : check_flags(batch, first, push->ray_count, reason);
}

enum status batch_read(struct batch *batch, int which, int turn, uint32_t count, struct hit *hit,
                       uint32_t *found, struct reason *reason)
{
    const uint64_t hits = (uint64_t)count * batch->capacity;
    enum status status = STATUS_OK;
    if (batch->lists)
        status =
            vk_buffer_read(batch->vk, batch->found[turn], 0, found, count * sizeof *found, reason);
    if (!status && hits)
        status = vk_buffer_read(batch->vk, batch->hits[which], 0, hit, hits * sizeof *hit, reason);
    return status;
}

static void answer_nothing(const struct batch_answers *to, size_t ray_count)
{
    for (size_t i = 0; i < ray_count; i++) {
        if (to->found)
            to->found[i] = 0;
        else
            to->hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    }
}

static enum status trace_rays(struct batch_engine *engine, const struct ray *ray, size_t ray_count,
                              const struct batch_answers *to, struct trace_report *report,
                              struct reason *reason)
{
    *report = (struct trace_report){.device_clock = true};
    if (!engine->chosen || engine->lists != (to->found != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: not prepared for this query");
    if (engine->empty || !ray_count) {
        answer_nothing(to, ray_count);
        return STATUS_OK;
    }
    struct batch batch;
    enum status status = batch_make(engine->vk, engine->workgroup, ray_count, engine->lists,
                                    to->capacity, engine->two, &batch, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint64_t part = least_of(least_of(engine->most(engine), batch.most), ray_count - done);
        status = engine->answer(engine, &batch, ray, done, (uint32_t)part, to, report, reason);
        done += part;
    }
    report->memory_bytes = engine->bytes + batch_bytes(&batch);
    batch_free(&batch);
    if (!status && vk_messages(engine->vk, reason))
        status = STATUS_DEVICE;
    return status;
}

enum status batch_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                        struct trace_report *report, struct reason *reason)
{
    const struct batch_answers to = {hit, NULL, 1};
    return trace_rays(self, ray, ray_count, &to, report, reason);
}

enum status batch_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                            struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    const struct batch_answers to = {hit, hit_count, capacity};
    struct trace_report unused;
    return trace_rays(self, ray, ray_count, &to, &unused, reason);
}

#include "gpu/trace/tracer_private.h"

#include "gpu/trace/gather.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

/* Rays of one dispatch. The number starts small (all rays may visit every node), doubles while
 * dispatches are quick and halves when one is slow, so that neither the wait nor a driver's
 * watchdog ends a long job. */
#define BATCH_FIRST 16384u
#define QUICK_NS    100000000u
#define SLOW_NS     1000000000u

/* Hits that one dispatch of QUERY_ALL may list, 64 MiB. A single ray may list more. */
#define LIST_MOST (1u << 22)

/* The caller's arrays for results. */
struct tracer_answers {
    struct hit *hit;
    uint32_t capacity; /* hits per ray: 1 unless QUERY_ALL */
    uint32_t *found;   /* QUERY_ALL: number of hits of each ray; else NULL */
};

enum status tracer_open(const struct vk_options *options, uint32_t workgroup, struct tracer **out,
                        struct reason *reason)
{
    struct tracer *tracer = alloc_zeroed(1, sizeof *tracer);
    *out = tracer;
    if (!tracer)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    tracer->workgroup = workgroup ? workgroup : ABI_WORKGROUP;
    enum status status = vk_open(options, &tracer->vk, reason);
    if (!status && tracer->workgroup > vk_limits(tracer->vk)->group_size)
        status = fail(reason, STATUS_UNSUPPORTED, "vulkan: workgroups of %u: %s allows 1 to %u",
                      tracer->workgroup, vk_limits(tracer->vk)->device,
                      vk_limits(tracer->vk)->group_size);
    if (status) {
        (void)tracer_close(tracer, NULL);
        *out = NULL;
    }
    return status;
}

static void free_buffers(struct tracer *tracer)
{
    vk_buffers_free(tracer->vk, tracer->buffer, DISPATCH_BINDINGS);
    free(tracer->flag);
    tracer->flag = NULL;
    tracer->ray_capacity = 0;
}

uint32_t tracer_close(struct tracer *tracer, struct reason *reason)
{
    if (!tracer)
        return 0;
    free_buffers(tracer);
    tracer_tasks_free(tracer);
    pipelines_free(&tracer->pipelines, tracer->vk);
    uint32_t messages = vk_close(tracer->vk, reason);
    free(tracer);
    return messages;
}

struct arithmetic tracer_arithmetic(struct tracer *tracer)
{
    if (!tracer->measured)
        tracer->arithmetic = probe_measure(tracer->vk);
    tracer->measured = true;
    return tracer->arithmetic;
}

struct vk *tracer_device(struct tracer *tracer)
{
    return tracer->vk;
}

uint32_t tracer_pipelines(const struct tracer *tracer)
{
    return (uint32_t)tracer->pipelines.count;
}

enum status tracer_pipeline(struct tracer *tracer, const struct dispatch *dispatch,
                            struct vk_pipeline **out, struct reason *reason)
{
    const struct vk_shader shader = dispatch_shader(dispatch);
    return pipelines_find(&tracer->pipelines, tracer->vk, &shader, out, reason);
}

/* Uploads the items. For traversal without a stack the parent links follow them. */
static enum status upload_items(struct tracer *tracer, const struct job *job, struct reason *reason)
{
    const struct packed *packed = job->packed;
    struct vk_buffer **buffer = &tracer->buffer[ABI_BIND_ITEMS];
    uint64_t items = packed_item_bytes(packed), links = 4 * (uint64_t)packed->ref_count;
    if (!job->parent)
        return vk_buffer_make_of(tracer->vk, packed->item, items, buffer, reason);
    enum status status = vk_buffer_make(tracer->vk, items + links, buffer, reason);
    if (!status && items)
        status = vk_buffer_write(tracer->vk, *buffer, 0, packed->item, items, reason);
    if (!status && links)
        status = vk_buffer_write(tracer->vk, *buffer, items, job->parent, links, reason);
    return status;
}

static uint32_t first_batch(const struct tracer *tracer, uint32_t node_count)
{
    uint32_t batch = TRACER_VISITS_MOST / (node_count + 1);
    if (batch > BATCH_FIRST)
        return BATCH_FIRST;
    return batch > tracer->workgroup ? batch : tracer->workgroup;
}

enum status tracer_prepare(struct tracer *tracer, const struct job *job, struct reason *reason)
{
    const struct packed *packed = job->packed;
    free_buffers(tracer);
    tracer->pipeline = NULL;
    tracer->lists = job->query == QUERY_ALL;
    tracer->batch = first_batch(tracer, packed->ref_count);
    struct dispatch dispatch;
    enum status status = dispatch_tree(job, tracer->workgroup, &dispatch, reason);
    tracer->push = dispatch.push;
    if (!status)
        status = tracer_pipeline(tracer, &dispatch, &tracer->pipeline, reason);
    if (!status)
        status = vk_buffer_make_of(tracer->vk, packed->word, packed_node_bytes(packed),
                                   &tracer->buffer[ABI_BIND_NODES], reason);
    if (!status)
        status = upload_items(tracer, job, reason);
    if (!status)
        status =
            tri_store_reads_scene(packed->store)
                ? gather_triangles(tracer->vk, job->scene, &tracer->buffer[ABI_BIND_TRIS], reason)
                : vk_buffer_make(tracer->vk, 0, &tracer->buffer[ABI_BIND_TRIS], reason);
    if (status) {
        free_buffers(tracer);
        tracer->pipeline = NULL;
    }
    return status;
}

static enum status rewrite(struct tracer *tracer, uint32_t binding, const void *from,
                           uint64_t bytes, struct reason *reason)
{
    return bytes && from
               ? vk_buffer_write(tracer->vk, tracer->buffer[binding], 0, from, bytes, reason)
               : STATUS_OK;
}

enum status tracer_move(struct tracer *tracer, const struct job *job, struct reason *reason)
{
    const struct packed *packed = job->packed;
    struct dispatch dispatch;
    if (!tracer->pipeline || job->parent)
        return tracer_prepare(tracer, job, reason);
    enum status status = dispatch_tree(job, tracer->workgroup, &dispatch, reason);
    tracer->push = dispatch.push;
    if (!status)
        status = rewrite(tracer, ABI_BIND_NODES, packed->word, packed_node_bytes(packed), reason);
    if (!status)
        status = rewrite(tracer, ABI_BIND_ITEMS, packed->item, packed_item_bytes(packed), reason);
    if (!status && tri_store_reads_scene(packed->store))
        status = gather_write(tracer->vk, job->scene, tracer->buffer[ABI_BIND_TRIS], 0, reason);
    if (status) {
        free_buffers(tracer);
        tracer->pipeline = NULL;
    }
    return status;
}

/* Makes the buffer of `binding` hold at least `bytes`. */
static enum status grow(struct tracer *tracer, uint32_t binding, uint64_t bytes,
                        struct reason *reason)
{
    return vk_buffer_grow(tracer->vk, bytes, &tracer->buffer[binding], reason);
}

static uint64_t least_of(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Makes buffers for *at_once rays: `count`, or as many as the device allows. */
static enum status reserve_rays(struct tracer *tracer, size_t count, uint32_t capacity,
                                uint32_t *at_once, struct reason *reason)
{
    const struct vk_limits *limits = vk_limits(tracer->vk);
    const uint64_t hit_bytes = (uint64_t)(capacity ? capacity : 1) * sizeof(struct hit);
    uint64_t most = least_of(vk_quad_bytes(tracer->vk) / sizeof(struct ray),
                             (uint64_t)limits->groups * tracer->workgroup);
    most = least_of(most, TRACER_RAYS_MOST);
    if (tracer->lists) {
        uint64_t lists = LIST_MOST * sizeof(struct hit) / hit_bytes;
        most = least_of(most, lists ? lists : 1);
    }
    most = least_of(most, limits->buffer_bytes / hit_bytes);
    if (most == 0)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %u hits of a ray are over %s's buffers of %llu bytes", capacity,
                    limits->device, (unsigned long long)limits->buffer_bytes);
    uint32_t need = (uint32_t)least_of(count, most);
    *at_once = need;
    if (need > tracer->ray_capacity) {
        free(tracer->flag);
        tracer->ray_capacity = 0;
        tracer->flag = alloc_zeroed(need, sizeof *tracer->flag);
        if (!tracer->flag)
            return fail(reason, STATUS_MEMORY, "vulkan: no memory for the flags of %u rays", need);
        tracer->ray_capacity = need;
    }
    const uint64_t word = sizeof *tracer->flag;
    enum status status = grow(tracer, ABI_BIND_RAYS, need * sizeof(struct ray), reason);
    if (!status)
        status = grow(tracer, ABI_BIND_HITS, need * hit_bytes, reason);
    if (!status)
        status = grow(tracer, ABI_BIND_FLAGS, need * word, reason);
    if (!status)
        status = grow(tracer, ABI_BIND_FOUND, tracer->lists ? need * word : 0, reason);
    return status;
}

static enum status check_flags(struct tracer *tracer, size_t first, uint32_t count,
                               struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++) {
        if (tracer->flag[i] == ABI_FLAG_DONE)
            continue;
        tracer->trouble = tracer->flag[i];
        tracer->unfinished = true;
        return fail(reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                    vk_limits(tracer->vk)->device, first + i, dispatch_cause(tracer->flag[i]));
    }
    return STATUS_OK;
}

/* Reads the results of `count` rays, the first of which is ray `first`. */
static enum status read_answers(struct tracer *tracer, size_t first, uint32_t count,
                                const struct tracer_answers *to, struct reason *reason)
{
    const size_t hits = (size_t)count * to->capacity;
    enum status status = STATUS_OK;
    if (to->found)
        status = vk_buffer_read(tracer->vk, tracer->buffer[ABI_BIND_FOUND], 0, to->found + first,
                                count * sizeof *to->found, reason);
    if (!status && hits)
        status = vk_buffer_read(tracer->vk, tracer->buffer[ABI_BIND_HITS], 0,
                                to->hit + first * to->capacity, hits * sizeof *to->hit, reason);
    return status;
}

/* Traces `count` rays from `ray` on, the first of which is ray `first`. */
static enum status trace_batch(struct tracer *tracer, const struct ray *ray, size_t first,
                               uint32_t count, const struct tracer_answers *to,
                               struct vk_time *time, struct reason *reason)
{
    struct vk_buffer *flags = tracer->buffer[ABI_BIND_FLAGS];
    const uint64_t flag_bytes = (uint64_t)count * sizeof *tracer->flag;
    memset(tracer->flag, 0, flag_bytes); /* so that a ray that is not traced has no DONE */
    enum status status = vk_buffer_write(tracer->vk, flags, 0, tracer->flag, flag_bytes, reason);
    if (!status)
        status = vk_buffer_write(tracer->vk, tracer->buffer[ABI_BIND_RAYS], 0, ray,
                                 (uint64_t)count * sizeof *ray, reason);
    if (status)
        return status;
    tracer->push.ray_count = count;
    tracer->push.capacity = to->capacity;
    uint32_t groups = (count + tracer->workgroup - 1) / tracer->workgroup;
    status = vk_dispatch(tracer->vk, tracer->pipeline, tracer->buffer, &tracer->push, groups, time,
                         reason);
    if (!status)
        status = vk_buffer_read(tracer->vk, flags, 0, tracer->flag, flag_bytes, reason);
    if (!status)
        status = check_flags(tracer, first, count, reason);
    return status ? status : read_answers(tracer, first, count, to, reason);
}

static enum status trace_rays(struct tracer *tracer, const struct ray *ray, size_t ray_count,
                              const struct tracer_answers *to, struct trace_report *report,
                              struct reason *reason)
{
    *report = (struct trace_report){.device_clock = true};
    if (!tracer->pipeline)
        return fail(reason, STATUS_DEVICE, "vulkan: nothing is prepared to be traced");
    if (tracer->lists != (to->found != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: prepared for another query");
    if (!ray_count)
        return STATUS_OK;
    uint32_t at_once = 0;
    tracer->trouble = 0;
    tracer->unfinished = false;
    enum status status = reserve_rays(tracer, ray_count, to->capacity, &at_once, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint32_t part = tracer->batch < at_once ? tracer->batch : at_once;
        part = ray_count - done < part ? (uint32_t)(ray_count - done) : part;
        struct vk_time time = {0};
        status = trace_batch(tracer, ray + done, done, part, to, &time, reason);
        report->ns += time.ns;
        report->device_clock = report->device_clock && time.device_clock;
        if (part == tracer->batch && time.ns < QUICK_NS && tracer->batch < TRACER_RAYS_MOST)
            tracer->batch *= 2;
        else if (time.ns > SLOW_NS && tracer->batch > tracer->workgroup)
            tracer->batch /= 2;
        done += part;
    }
    report->flags = tracer->trouble;
    if (!status && vk_messages(tracer->vk, reason))
        status = STATUS_DEVICE;
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++)
        report->memory_bytes += vk_buffer_bytes(tracer->buffer[i]);
    return status;
}

enum status tracer_trace(struct tracer *tracer, const struct ray *ray, size_t ray_count,
                         struct hit *hit, struct trace_report *report, struct reason *reason)
{
    const struct tracer_answers to = {hit, 1, NULL};
    return trace_rays(tracer, ray, ray_count, &to, report, reason);
}

enum status tracer_trace_all(struct tracer *tracer, const struct ray *ray, size_t ray_count,
                             uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                             struct reason *reason)
{
    const struct tracer_answers to = {hit, capacity, hit_count};
    struct trace_report unused;
    return trace_rays(tracer, ray, ray_count, &to, &unused, reason);
}

/* Traces many small jobs in one submission. Their data lie in seven large buffers, one after the
 * other, and each dispatch sees only its own parts. */
#include "gpu/trace/ray_order.h"
#include "gpu/trace/tracer_private.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The most dispatches of one submission. */
#define GROUP_MOST 128u

#define QUAD_BYTES 16u

/* The host's copy of one buffer. */
struct arena {
    uint8_t *byte;
    size_t capacity, used;
};

/* A task of the current submission. */
struct tasks_entry {
    struct engine_task *task;
    struct push push;
    size_t order; /* offset in tasks.order; ray i of the dispatch is ray order[i] of the task */
    bool ordered; /* else ray i of the task */
};

struct tracer_tasks {
    struct vk_sets *sets;
    struct vk_buffer *buffer[DISPATCH_BINDINGS];
    struct arena arena[DISPATCH_BINDINGS];
    struct vk_work work[GROUP_MOST];
    struct tasks_entry entry[GROUP_MOST];
    struct arena order; /* orders of all entries; not uploaded */
    uint32_t count;
    uint64_t visits; /* most node visits of all entries */
};

void tracer_tasks_free(struct tracer *tracer)
{
    struct tracer_tasks *tasks = tracer->tasks;
    if (!tasks)
        return;
    vk_sets_free(tracer->vk, tasks->sets);
    vk_buffers_free(tracer->vk, tasks->buffer, DISPATCH_BINDINGS);
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++)
        free(tasks->arena[i].byte);
    free(tasks->order.byte);
    free(tasks);
    tracer->tasks = NULL;
}

static enum status need_tasks(struct tracer *tracer, struct reason *reason)
{
    if (tracer->tasks)
        return STATUS_OK;
    tracer->tasks = alloc_zeroed(1, sizeof *tracer->tasks);
    if (!tracer->tasks)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for many jobs");
    return vk_sets_make(tracer->vk, DISPATCH_BINDINGS, vk_ways(tracer->vk), false, GROUP_MOST,
                        &tracer->tasks->sets, reason);
}

/* Allocates `bytes` of the arena, at least one quad, zeroed and aligned for a part of a buffer.
 * Returns NULL without memory. */
static void *take(struct tracer *tracer, struct vk_work *work, uint32_t binding, uint64_t bytes)
{
    struct arena *arena = &tracer->tasks->arena[binding];
    size_t align = (size_t)vk_limits(tracer->vk)->alignment;
    if (align < QUAD_BYTES)
        align = QUAD_BYTES;
    size_t first = (arena->used + align - 1) / align * align;
    size_t size = bytes ? (bytes + QUAD_BYTES - 1) / QUAD_BYTES * QUAD_BYTES : QUAD_BYTES;
    if (array_reserve(&arena->byte, &arena->capacity, first + size, 1))
        return NULL;
    arena->used = first + size;
    work->part[binding].offset = first;
    work->part[binding].bytes = size;
    memset(arena->byte + first, 0, size); /* so that a ray that is not traced has no DONE */
    return arena->byte + first;
}

static bool put(struct tracer *tracer, struct vk_work *work, uint32_t binding, const void *data,
                uint64_t bytes)
{
    void *at = take(tracer, work, binding, bytes);
    if (at && bytes)
        memcpy(at, data, bytes);
    return at != NULL;
}

/* Returns the order of the entry's rays, or NULL. */
static const uint32_t *order_of(const struct tracer_tasks *tasks, const struct tasks_entry *entry)
{
    return entry->ordered ? (const uint32_t *)(const void *)(tasks->order.byte + entry->order)
                          : NULL;
}

/* Orders the rays by their expected work. */
static bool make_order(struct tracer_tasks *tasks, const struct engine_task *task,
                       struct tasks_entry *entry)
{
    size_t bytes = task->ray_count * sizeof(uint32_t);
    entry->ordered = task->expected && task->ray_count > 0;
    entry->order = tasks->order.used;
    if (!entry->ordered)
        return true;
    if (array_reserve(&tasks->order.byte, &tasks->order.capacity, tasks->order.used + 2 * bytes, 1))
        return false;
    uint32_t *order = (void *)(tasks->order.byte + tasks->order.used);
    ray_order_by_work(task->expected, task->ray_count, order, order + task->ray_count);
    tasks->order.used += bytes; /* the spare part is free again */
    return true;
}

static bool put_rays(struct tracer *tracer, struct vk_work *work, const struct tasks_entry *entry)
{
    const struct engine_task *task = entry->task;
    const uint32_t *order = order_of(tracer->tasks, entry);
    if (!order)
        return put(tracer, work, ABI_BIND_RAYS, task->ray, task->ray_count * sizeof *task->ray);
    struct ray *ray = take(tracer, work, ABI_BIND_RAYS, task->ray_count * sizeof *ray);
    for (size_t i = 0; ray && i < task->ray_count; i++)
        ray[i] = task->ray[order[i]];
    return ray != NULL;
}

static bool put_triangles(struct tracer *tracer, struct vk_work *work, const struct job *job)
{
    const struct scene *scene = job->scene;
    uint32_t count = tri_store_reads_scene(job->packed->store) ? scene->tri_count : 0;
    float(*tri)[3][3] = take(tracer, work, ABI_BIND_TRIS, sizeof *tri * (uint64_t)count);
    for (uint32_t i = 0; tri && i < count; i++)
        scene_tri(scene, i, tri[i]);
    return tri != NULL;
}

/* The most node visits of a task. */
static uint64_t visits_of(const struct engine_task *task)
{
    return (uint64_t)task->ray_count * (task->job.packed->ref_count + 1);
}

/* Adds a task to the submission. */
static enum status add(struct tracer *tracer, struct engine_task *task, struct reason *reason)
{
    struct tracer_tasks *tasks = tracer->tasks;
    const struct packed *packed = task->job.packed;
    struct vk_work *work = &tasks->work[tasks->count];
    struct tasks_entry *entry = &tasks->entry[tasks->count];
    struct dispatch dispatch;
    task->status = dispatch_tree(&task->job, tracer->workgroup, &dispatch, &task->reason);
    if (!task->status)
        task->status = tracer_pipeline(tracer, &dispatch, &work->pipeline, &task->reason);
    if (task->status == STATUS_LIMIT || task->status == STATUS_UNSUPPORTED)
        return STATUS_OK;
    if (task->status)
        return fail(reason, task->status, "%s", task->reason.text);
    const uint64_t rays = task->ray_count;
    entry->task = task;
    if (!make_order(tasks, task, entry) || !put_rays(tracer, work, entry) ||
        !take(tracer, work, ABI_BIND_HITS, rays * sizeof *task->hit) ||
        !take(tracer, work, ABI_BIND_FLAGS, rays * sizeof *task->flag) ||
        !put(tracer, work, ABI_BIND_NODES, packed->word, packed_node_bytes(packed)) ||
        !put(tracer, work, ABI_BIND_ITEMS, packed->item, packed_item_bytes(packed)) ||
        !put_triangles(tracer, work, &task->job) || !take(tracer, work, ABI_BIND_FOUND, 0))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for many jobs");
    task->status = vk_work_check(tracer->vk, tasks->sets, work, &task->reason);
    if (task->status)
        return STATUS_OK;
    entry->push = dispatch.push;
    entry->push.ray_count = (uint32_t)rays;
    work->push = &entry->push;
    work->groups = dispatch_groups(&dispatch, (uint32_t)rays);
    tasks->visits += visits_of(task);
    tasks->count++;
    return STATUS_OK;
}

/* Makes the buffers large enough and uploads those that shaders read, and the flags. */
static enum status upload(struct tracer *tracer, struct reason *reason)
{
    struct tracer_tasks *tasks = tracer->tasks;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < DISPATCH_BINDINGS && !status; i++) {
        const struct arena *arena = &tasks->arena[i];
        status = vk_buffer_grow(tracer->vk, arena->capacity, &tasks->buffer[i], reason);
        if (!status && i != ABI_BIND_HITS && i != ABI_BIND_FOUND)
            status =
                vk_buffer_write(tracer->vk, tasks->buffer[i], 0, arena->byte, arena->used, reason);
    }
    return status;
}

/* Sets the task's status from its first ray that was not finished. */
static void check_flags(struct tracer *tracer, struct engine_task *task)
{
    task->status = STATUS_OK;
    for (size_t i = 0; i < task->ray_count && !task->status; i++)
        if (task->flag[i] != ABI_FLAG_DONE)
            task->status =
                fail(&task->reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                     vk_limits(tracer->vk)->device, i, dispatch_cause(task->flag[i]));
}

/* Copies the results to the task, in the task's order of rays. */
static void take_answers(const struct tasks_entry *entry, const uint32_t *order, const void *hits,
                         const void *flags)
{
    const struct hit *hit = hits;
    const uint32_t *flag = flags;
    struct engine_task *task = entry->task;
    if (!order) {
        memcpy(task->hit, hit, task->ray_count * sizeof *hit);
        memcpy(task->flag, flag, task->ray_count * sizeof *flag);
        return;
    }
    for (size_t i = 0; i < task->ray_count; i++) {
        task->hit[order[i]] = hit[i];
        task->flag[order[i]] = flag[i];
    }
}

static enum status download(struct tracer *tracer, struct reason *reason)
{
    struct tracer_tasks *tasks = tracer->tasks;
    struct arena *hits = &tasks->arena[ABI_BIND_HITS], *flags = &tasks->arena[ABI_BIND_FLAGS];
    enum status status =
        vk_buffer_read(tracer->vk, tasks->buffer[ABI_BIND_HITS], 0, hits->byte, hits->used, reason);
    if (!status)
        status = vk_buffer_read(tracer->vk, tasks->buffer[ABI_BIND_FLAGS], 0, flags->byte,
                                flags->used, reason);
    for (uint32_t i = 0; i < tasks->count && !status; i++) {
        take_answers(&tasks->entry[i], order_of(tasks, &tasks->entry[i]),
                     hits->byte + tasks->work[i].part[ABI_BIND_HITS].offset,
                     flags->byte + tasks->work[i].part[ABI_BIND_FLAGS].offset);
        check_flags(tracer, tasks->entry[i].task);
    }
    return status;
}

static int by_pipeline(const void *a, const void *b)
{
    uintptr_t x = (uintptr_t)((const struct vk_work *)a)->pipeline;
    uintptr_t y = (uintptr_t)((const struct vk_work *)b)->pipeline;
    return order_numbers(x, y);
}

/* Traces the tasks that were added. */
static enum status flush(struct tracer *tracer, struct reason *reason)
{
    struct tracer_tasks *tasks = tracer->tasks;
    enum status status = STATUS_OK;
    if (tasks->count) {
        struct vk_work sorted[GROUP_MOST];
        memcpy(sorted, tasks->work, tasks->count * sizeof sorted[0]);
        qsort(sorted, tasks->count, sizeof sorted[0], by_pipeline);
        status = upload(tracer, reason);
        if (!status)
            status = vk_dispatch_many(tracer->vk, tasks->sets, tasks->buffer, sorted, tasks->count,
                                      reason);
        if (!status)
            status = download(tracer, reason);
    }
    tasks->count = 0;
    tasks->visits = 0;
    tasks->order.used = 0;
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++)
        tasks->arena[i].used = 0;
    return status;
}

/* Returns true if a task is too large for a shared submission. It is then traced in batches of its
 * own. */
static bool is_large(const struct tracer *tracer, const struct engine_task *task)
{
    const struct vk_limits *limits = vk_limits(tracer->vk);
    return visits_of(task) > TRACER_VISITS_MOST || task->ray_count > TRACER_RAYS_MOST ||
           task->ray_count / tracer->workgroup >= limits->groups;
}

/* Traces a task with tracer_prepare and tracer_trace. With a ray that was not finished the task has
 * its flags for all. */
static enum status trace_large(struct tracer *tracer, struct engine_task *task,
                               struct reason *reason)
{
    struct trace_report report;
    tracer->unfinished = false;
    task->status = tracer_prepare(tracer, &task->job, &task->reason);
    if (!task->status)
        task->status =
            tracer_trace(tracer, task->ray, task->ray_count, task->hit, &report, &task->reason);
    uint32_t flag = tracer->unfinished ? tracer->trouble
                    : task->status     ? ABI_FLAG_EXHAUSTED
                                       : ABI_FLAG_DONE;
    for (size_t i = 0; i < task->ray_count; i++)
        task->flag[i] = flag;
    if (task->status == STATUS_OK || task->status == STATUS_LIMIT ||
        task->status == STATUS_UNSUPPORTED || tracer->unfinished)
        return STATUS_OK;
    return fail(reason, task->status, "%s", task->reason.text);
}

enum status tracer_trace_tasks(struct tracer *tracer, struct engine_task *task, size_t count,
                               struct reason *reason)
{
    enum status status = need_tasks(tracer, reason);
    for (size_t i = 0; i < count && !status; i++) {
        task[i].status = STATUS_OK;
        if (is_large(tracer, &task[i])) {
            status = trace_large(tracer, &task[i], reason);
            continue;
        }
        struct tracer_tasks *tasks = tracer->tasks;
        if (tasks->count == GROUP_MOST || tasks->visits + visits_of(&task[i]) > TRACER_VISITS_MOST)
            status = flush(tracer, reason);
        if (!status && task[i].ray_count)
            status = add(tracer, &task[i], reason);
    }
    if (!status)
        status = flush(tracer, reason);
    if (!status && vk_messages(tracer->vk, reason))
        status = STATUS_DEVICE;
    return status;
}

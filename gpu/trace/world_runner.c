#include "gpu/trace/world_runner.h"

#include "gpu/shaders/pipelines.h"
#include "gpu/trace/dispatch.h"
#include "gpu/trace/world_part.h"
#include "gpu/trace/world_upload.h"
#include "gpu/vk/vk_accel.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays of the first dispatch and of the largest; the number doubles while dispatches are quick and
 * halves when one is slow, as in gpu/trace/tracer.c. */
#define WORLD_BATCH_FIRST 4096u
#define WORLD_BATCH_MOST  (1u << 18)
#define WORLD_QUICK_NS    100000000u
#define WORLD_SLOW_NS     1000000000u

/* Most hits of one dispatch of QUERY_ALL; a single ray may list more. */
#define WORLD_LIST_MOST (1u << 20)

#define RAY_BYTES (ABI_WORLD_RAY * ABI_WORLD_QUAD_BYTES)
#define HIT_BYTES (ABI_WORLD_HIT * ABI_WORLD_QUAD_BYTES)

/* A ray and a hit as the shaders have them. */
struct world_ray {
    struct ray ray;
    struct ray_mode mode;
    uint32_t none[2];
};
_Static_assert(sizeof(struct world_ray) == RAY_BYTES, "the shader reads ABI_WORLD_RAY quads");

struct world_hit {
    struct hit hit;
    uint32_t tag, none[3];
};
_Static_assert(sizeof(struct world_hit) == HIT_BYTES, "the shader writes ABI_WORLD_HIT quads");

struct world_runner {
    struct vk *vk;
    uint32_t workgroup;
    struct pipelines pipelines;
    struct vk_pipeline *pipeline; /* for the job; borrowed */
    struct vk_buffer *buffer[WORLD_BINDINGS];
    struct world_push push;
    uint32_t batch;
    bool lists;                /* prepared for QUERY_ALL */
    const struct world *brute; /* tested triangle by triangle; NULL: not so */
    /* What a dispatch reads and writes, on this side. */
    struct world_ray *ray;
    struct world_hit *hit;
    uint32_t *flag;
    size_t ray_room, hit_room, flag_room;
    uint32_t trouble; /* flags of the first ray that was not finished */
};

/* The caller's arrays for results, and where its rays are. */
struct world_answers {
    const struct ray *ray;
    const struct ray_mode *mode;
    struct hit *hit;
    uint32_t *tag;
    uint32_t *found; /* QUERY_ALL; else NULL */
    uint32_t capacity;
};

struct world_runner *world_runner_make(struct vk *vk, uint32_t workgroup)
{
    struct world_runner *runner = alloc_zeroed(1, sizeof *runner);
    if (runner) {
        runner->vk = vk;
        runner->workgroup = workgroup ? workgroup : ABI_WORKGROUP;
    }
    return runner;
}

void world_runner_free(struct world_runner *runner)
{
    if (!runner)
        return;
    vk_buffers_free(runner->vk, runner->buffer, WORLD_BINDINGS);
    pipelines_free(&runner->pipelines, runner->vk);
    free(runner->ray);
    free(runner->hit);
    free(runner->flag);
    free(runner);
}

/* --- prepare ---------------------------------------------------------------------------------- */

static enum status take_pipeline(struct world_runner *runner, const struct shader *shader,
                                 const uint32_t *constant, bool accel, struct reason *reason)
{
    const struct vk_shader made = {.name = shader->name,
                                   .word = shader->word,
                                   .word_count = shader->word_count,
                                   .binding_count = WORLD_BINDINGS,
                                   .push_bytes = sizeof(struct world_push),
                                   .accel = accel,
                                   .constant = constant,
                                   .constant_count = DISPATCH_CONSTANTS};
    return pipelines_find(&runner->pipelines, runner->vk, &made, &runner->pipeline, reason);
}

static enum status find_pipeline(struct world_runner *runner, const struct world_job *job,
                                 struct reason *reason)
{
    const struct packed_world *packed = job->packed;
    const struct layout *layout = packed->top.layout;
    char name[64];
    snprintf(name, sizeof name, "world_%s", layout_shader(layout));
    const struct shader *shader = shader_find(name);
    uint32_t constant[DISPATCH_CONSTANTS] = {
        [ABI_SPEC_WORKGROUP] = runner->workgroup,
        [ABI_SPEC_BOX] = job->box->id,
        [ABI_SPEC_TRI] = job->tri->id,
        [ABI_SPEC_QUERY] = (uint32_t)job->query,
        [ABI_SPEC_STORE] = packed->mesh_count ? packed->bottom->store->id : ABI_STORE_INDEXED,
        [ABI_SPEC_LAYOUT_0] = layout->constant[0],
        [ABI_SPEC_LAYOUT_1] = layout->constant[1]};
    enum status status = dispatch_stack(packed->stack_need, layout_stack_most(layout),
                                        &constant[ABI_SPEC_STACK], reason);
    if (status)
        return status;
    if (!shader) {
        shader_why_not(layout->name, reason);
        return STATUS_UNSUPPORTED;
    }
    return take_pipeline(runner, shader, constant, false, reason);
}

static void start_job(struct world_runner *runner, const struct world_job *job)
{
    vk_buffers_free(runner->vk, runner->buffer, WORLD_BINDINGS);
    runner->pipeline = NULL;
    runner->lists = job->query == QUERY_ALL;
    runner->brute = NULL;
    runner->batch = WORLD_BATCH_FIRST;
}

static enum status end_job(struct world_runner *runner, enum status status)
{
    if (status) {
        vk_buffers_free(runner->vk, runner->buffer, WORLD_BINDINGS);
        runner->pipeline = NULL;
    }
    return status;
}

enum status world_runner_prepare(struct world_runner *runner, const struct world_job *job,
                                 struct reason *reason)
{
    start_job(runner, job);
    enum status status = world_upload_check(job, reason);
    if (!status)
        status = find_pipeline(runner, job, reason);
    if (!status)
        status = world_upload(runner->vk, job, runner->buffer, &runner->push, reason);
    return end_job(runner, status);
}

enum status world_runner_move(struct world_runner *runner, const struct world_job *job,
                              struct reason *reason)
{
    if (!runner->pipeline)
        return world_runner_prepare(runner, job, reason);
    return end_job(runner, world_upload(runner->vk, job, runner->buffer, &runner->push, reason));
}

/* The pipeline of a shader that reads no tree of ours. */
static enum status take_plain(struct world_runner *runner, const char *shader, enum query query,
                              uint32_t tri, bool accel, struct reason *reason)
{
    const uint32_t constant[DISPATCH_CONSTANTS] = {[ABI_SPEC_WORKGROUP] = runner->workgroup,
                                                   [ABI_SPEC_BOX] = ABI_BOX_ROBUST,
                                                   [ABI_SPEC_TRI] = tri,
                                                   [ABI_SPEC_QUERY] = (uint32_t)query,
                                                   [ABI_SPEC_STACK] = 16};
    return take_pipeline(runner, shader_find(shader), constant, accel, reason);
}

enum status world_runner_prepare_query(struct world_runner *runner, const struct world_job *job,
                                       const struct vk_accel *accel, struct reason *reason)
{
    start_job(runner, job);
    enum status status = take_plain(runner, "query_world", job->query, ABI_TRI_MT, true, reason);
    for (uint32_t i = ABI_BIND_NODES; i <= ABI_BIND_TRIS && !status; i++) /* not read */
        status = vk_buffer_make(runner->vk, 0, &runner->buffer[i], reason);
    if (!status)
        status = world_upload_query(runner->vk, job->world, &runner->buffer[ABI_BIND_WORLD],
                                    &runner->push, reason);
    if (!status)
        vk_pipeline_use(runner->vk, runner->pipeline, accel);
    return end_job(runner, status);
}

enum status world_runner_prepare_brute(struct world_runner *runner, const struct world_job *job,
                                       struct reason *reason)
{
    const struct world_job whole = {.world = job->world, .tri = job->tri, .query = job->query};
    start_job(runner, job);
    enum status status = take_plain(runner, "world_brute", job->query, job->tri->id, false, reason);
    if (!status)
        status = world_upload(runner->vk, &whole, runner->buffer, &runner->push, reason);
    runner->brute = job->world;
    return end_job(runner, status);
}

/* --- trace ------------------------------------------------------------------------------------ */

static uint64_t least_of(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Makes room for *at_once rays: `count`, or as many as limits allow. */
static enum status reserve(struct world_runner *runner, size_t count, uint32_t capacity,
                           uint32_t *at_once, struct reason *reason)
{
    const struct vk_limits *limits = vk_limits(runner->vk);
    const uint64_t hits = capacity ? capacity : 1, word = sizeof *runner->flag;
    uint64_t most = least_of(vk_quad_bytes(runner->vk) / RAY_BYTES,
                             (uint64_t)limits->groups * runner->workgroup);
    most = least_of(most, WORLD_BATCH_MOST);
    if (runner->lists)
        most = least_of(most, WORLD_LIST_MOST / hits ? WORLD_LIST_MOST / hits : 1);
    most = least_of(most, limits->buffer_bytes / (hits * HIT_BYTES));
    if (most == 0)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %u hits of a ray are over %s's buffers of %llu bytes", capacity,
                    limits->device, (unsigned long long)limits->buffer_bytes);
    uint32_t need = (uint32_t)least_of(count, most);
    *at_once = need;
    const size_t list = (size_t)need * hits;
    if (array_reserve(&runner->ray, &runner->ray_room, need, sizeof *runner->ray) ||
        array_reserve(&runner->hit, &runner->hit_room, list, sizeof *runner->hit) ||
        array_reserve(&runner->flag, &runner->flag_room, need, sizeof *runner->flag))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u rays", need);
    const uint64_t hit_bytes = list * (uint64_t)HIT_BYTES, count_bytes = need * word;
    const uint64_t bytes[] = {/* 0: as it is */
                              [ABI_BIND_RAYS] = need * (uint64_t)RAY_BYTES,
                              [ABI_BIND_HITS] = hit_bytes,
                              [ABI_BIND_FLAGS] = need * word,
                              [ABI_BIND_NODES] = runner->brute && !runner->lists ? hit_bytes : 0,
                              [ABI_BIND_ITEMS] = runner->brute && runner->lists ? count_bytes : 0,
                              [ABI_BIND_FOUND] = runner->lists ? count_bytes : 0};
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < ARRAY_COUNT(bytes) && !status; i++)
        status = vk_buffer_grow(runner->vk, bytes[i], &runner->buffer[i], reason);
    return status;
}

static void swap_buffers(struct vk_buffer **a, struct vk_buffer **b)
{
    struct vk_buffer *c = *a;
    *a = *b;
    *b = c;
}

/* Dispatches once; or, without trees, for one part of the placed triangles after the other. */
static enum status dispatch_parts(struct world_runner *runner, uint32_t groups,
                                  struct vk_time *time, struct reason *reason)
{
    struct world_push *push = &runner->push;
    enum status status = STATUS_OK;
    bool more = false;
    push->last = 0;
    time->device_clock = true;
    do {
        struct vk_time part = {0};
        if (runner->brute)
            more = world_part_next(runner->brute, push);
        if (push->first) { /* what the part before wrote is read */
            swap_buffers(&runner->buffer[ABI_BIND_FOUND], &runner->buffer[ABI_BIND_ITEMS]);
            if (!runner->lists)
                swap_buffers(&runner->buffer[ABI_BIND_HITS], &runner->buffer[ABI_BIND_NODES]);
        }
        status =
            vk_dispatch(runner->vk, runner->pipeline, runner->buffer, push, groups, &part, reason);
        time->ns += part.ns;
        time->device_clock = time->device_clock && part.device_clock;
    } while (!status && more);
    return status;
}

/* Copies `count` rays from number `first` on, and clears their flags. */
static enum status write_rays(struct world_runner *runner, const struct world_answers *answers,
                              size_t first, uint32_t count, struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        runner->ray[i] =
            (struct world_ray){.ray = answers->ray[first + i],
                               .mode = answers->mode ? answers->mode[first + i] : ray_mode_all()};
    memset(runner->flag, 0, count * sizeof *runner->flag);
    enum status status = vk_buffer_write(runner->vk, runner->buffer[ABI_BIND_RAYS], 0, runner->ray,
                                         (uint64_t)count * RAY_BYTES, reason);
    if (!status)
        status = vk_buffer_write(runner->vk, runner->buffer[ABI_BIND_FLAGS], 0, runner->flag,
                                 count * sizeof *runner->flag, reason);
    return status;
}

static enum status check_flags(struct world_runner *runner, size_t first, uint32_t count,
                               struct reason *reason)
{
    enum status status = vk_buffer_read(runner->vk, runner->buffer[ABI_BIND_FLAGS], 0, runner->flag,
                                        count * sizeof *runner->flag, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        if (runner->flag[i] == ABI_FLAG_DONE)
            continue;
        runner->trouble = runner->flag[i];
        status = fail(reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                      vk_limits(runner->vk)->device, first + i, dispatch_cause(runner->flag[i]));
    }
    return status;
}

static enum status read_hits(struct world_runner *runner, const struct world_answers *answers,
                             size_t first, uint32_t count, struct reason *reason)
{
    const size_t hits = (size_t)count * answers->capacity, at = first * answers->capacity;
    enum status status = STATUS_OK;
    if (answers->found)
        status = vk_buffer_read(runner->vk, runner->buffer[ABI_BIND_FOUND], 0,
                                answers->found + first, count * sizeof *answers->found, reason);
    if (!status && hits)
        status = vk_buffer_read(runner->vk, runner->buffer[ABI_BIND_HITS], 0, runner->hit,
                                hits * HIT_BYTES, reason);
    for (size_t i = 0; i < hits && !status; i++) {
        /* Of a list only what was found is written. */
        if (answers->found &&
            i % answers->capacity >= answers->found[first + i / answers->capacity])
            continue;
        answers->hit[at + i] = runner->hit[i].hit;
        answers->tag[at + i] = runner->hit[i].tag;
    }
    return status;
}

static enum status trace_batch(struct world_runner *runner, const struct world_answers *answers,
                               size_t first, uint32_t count, struct vk_time *time,
                               struct reason *reason)
{
    uint32_t groups = (count + runner->workgroup - 1) / runner->workgroup;
    runner->push.ray_count = count;
    runner->push.capacity = answers->capacity;
    enum status status = write_rays(runner, answers, first, count, reason);
    if (!status)
        status = dispatch_parts(runner, groups, time, reason);
    if (!status)
        status = check_flags(runner, first, count, reason);
    return status ? status : read_hits(runner, answers, first, count, reason);
}

enum status world_runner_trace(struct world_runner *runner, const struct ray *ray,
                               const struct ray_mode *mode, size_t ray_count, uint32_t capacity,
                               struct hit *hit, uint32_t *tag, uint32_t *hit_count,
                               struct trace_report *report, struct reason *reason)
{
    const struct world_answers answers = {ray, mode, hit, tag, hit_count, capacity};
    uint32_t at_once = 0;
    *report = (struct trace_report){.device_clock = true};
    if (!runner || !runner->pipeline)
        return fail(reason, STATUS_DEVICE, "vulkan: no world is prepared to be traced");
    if (runner->lists != (hit_count != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: prepared for another query");
    if (!ray_count)
        return STATUS_OK;
    runner->trouble = 0;
    enum status status = reserve(runner, ray_count, capacity, &at_once, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint32_t part = (uint32_t)least_of(ray_count - done, least_of(runner->batch, at_once));
        struct vk_time time = {0};
        status = trace_batch(runner, &answers, done, part, &time, reason);
        report->ns += time.ns;
        report->device_clock = report->device_clock && time.device_clock;
        if (part == runner->batch && time.ns < WORLD_QUICK_NS && runner->batch < WORLD_BATCH_MOST)
            runner->batch *= 2;
        else if (time.ns > WORLD_SLOW_NS && runner->batch > runner->workgroup)
            runner->batch /= 2;
        done += part;
    }
    report->flags = runner->trouble;
    if (!status && vk_messages(runner->vk, reason))
        status = STATUS_DEVICE;
    for (uint32_t i = 0; i < WORLD_BINDINGS; i++)
        report->memory_bytes += vk_buffer_bytes(runner->buffer[i]);
    return status;
}

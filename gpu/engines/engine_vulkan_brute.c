/* Engine `vulkan_brute`: shaders/trace_brute.comp tests every triangle for every ray on a Vulkan
 * device. Compared with engine `vulkan` it shows what the tree loses, compared with engine `brute`
 * what the device's arithmetic changes. Those two must agree in every bit if the device's operators
 * equal C's. */
#include "gpu/trace/batch.h"
#include "gpu/trace/dispatch.h"
#include "gpu/frame/framer.h"
#include "gpu/trace/gather.h"
#include "gpu/card/probe.h"
#include "gpu/trace/vulkan_options.h"
#include "gpu/trace/world_runner.h"
#include "ref/twin/twin.h"

#include <stdlib.h>

#define QUERIES 3u
#define TRIS    5u

/* Ray-triangle tests of one dispatch. The number starts small, doubles while dispatches are quick
 * and halves when one is slow, so that no driver's watchdog ends a long job. */
#define TESTS_FIRST (1u << 24)
#define TESTS_MOST  (1u << 30)
#define QUICK_NS    100000000u
#define SLOW_NS     1000000000u

struct brute {
    struct batch_engine base;
    struct vk_pipeline *pipeline[TRIS][QUERIES];
    struct vk_buffer *tri;
    uint32_t tri_count;
    uint64_t tests;
    struct arithmetic arithmetic;
    bool measured;
    struct framer *framer;       /* NULL until a frame is prepared */
    struct world_runner *worlds; /* NULL until a world is */
};

_Static_assert(ABI_TRI_BALDWIN_WEBBER < TRIS && ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct brute *b = self;
    if (!b)
        return;
    framer_free(b->framer);
    world_runner_free(b->worlds);
    for (uint32_t t = 0; t < TRIS && b->base.vk; t++)
        for (uint32_t q = 0; q < QUERIES; q++)
            vk_pipeline_free(b->base.vk, b->pipeline[t][q]);
    if (b->base.vk)
        vk_buffer_free(b->base.vk, b->tri);
    (void)vk_close(b->base.vk, NULL);
    free(b);
}

/* The number of rays whose tests with one part of the triangles are b->tests. */
static uint64_t most(const struct batch_engine *engine)
{
    const struct brute *b = (const struct brute *)engine;
    uint64_t rays = b->tests / (b->tri_count < DISPATCH_PART ? b->tri_count + 1 : DISPATCH_PART);
    return rays < 1 ? 1 : rays;
}

/* Tests one part of the triangles. Best hits are read from one buffer and written to the other;
 * lists grow in place and their lengths switch buffers. */
static enum status run_part(struct brute *b, struct batch *batch, const struct push *push, int turn,
                            size_t first, struct vk_time *time, struct reason *reason)
{
    struct vk_buffer *const buffer[BATCH_BINDINGS] = {
        [ABI_BIND_RAYS] = batch->rays,
        [ABI_BIND_HITS] = batch->hits[b->base.lists ? 0 : turn],
        [ABI_BIND_FLAGS] = batch->flags,
        [ABI_BIND_NODES] = b->base.lists ? batch->none : batch->hits[1 - turn],
        [ABI_BIND_ITEMS] = b->base.lists ? batch->found[1 - turn] : batch->none,
        [ABI_BIND_TRIS] = b->tri,
        [ABI_BIND_FOUND] = batch->found[turn],
    };
    return batch_run(batch, b->base.chosen, buffer, push, first, time, reason);
}

/* Tests all triangles for `count` rays, the first of which is ray `first`. */
static enum status answer(struct batch_engine *engine, struct batch *batch, const struct ray *ray,
                          size_t first, uint32_t count, const struct batch_answers *to,
                          struct trace_report *report, struct reason *reason)
{
    struct brute *b = (struct brute *)engine;
    int turn = 1;
    uint32_t done = 0;
    enum status status = batch_rays(batch, ray + first, count, reason);
    report->tris += (uint64_t)count * b->tri_count; /* for any-hit an upper bound */
    do { /* without triangles there is one empty part, which writes the misses */
        struct vk_time time = {0};
        struct push push = dispatch_brute_push(b->tri_count, done);
        uint32_t part = push.node_count - done;
        push.ray_count = count;
        push.capacity = batch->capacity;
        turn = 1 - turn;
        done += part;
        if (!status)
            status = run_part(b, batch, &push, turn, first, &time, reason);
        report->ns += time.ns;
        report->device_clock = report->device_clock && time.device_clock;
        if (part == DISPATCH_PART && time.ns < QUICK_NS && b->tests < TESTS_MOST)
            b->tests *= 2;
        else if (time.ns > SLOW_NS && b->tests > TESTS_FIRST)
            b->tests /= 2;
    } while (!status && done < b->tri_count);
    if (status)
        return status;
    return batch_read(batch, b->base.lists ? 0 : turn, turn, count,
                      to->hit + first * batch->capacity, to->found ? to->found + first : NULL,
                      reason);
}

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    struct brute *b = alloc_zeroed(1, sizeof *b);
    *self = NULL;
    if (!b)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    struct vk_options vk_options = vulkan_options(options);
    b->base.workgroup = options->workgroup ? options->workgroup : ABI_WORKGROUP;
    b->base.two = true;
    b->base.most = most;
    b->base.answer = answer;
    b->tests = TESTS_FIRST;
    enum status status = vk_open(&vk_options, &b->base.vk, reason);
    if (status)
        close(b);
    else
        *self = b;
    return status;
}

static enum status make_pipeline(struct brute *b, const struct job *job, struct reason *reason)
{
    struct vk_pipeline **pipeline = &b->pipeline[job->tri->id][job->query];
    const struct dispatch dispatch = dispatch_brute(job, b->base.workgroup);
    struct vk_shader make = dispatch_shader(&dispatch);
    enum status status = vk_compile(b->base.vk, &make, reason);
    if (!status && !*pipeline)
        status = vk_pipeline_make(b->base.vk, &make, pipeline, reason);
    b->base.chosen = *pipeline;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct brute *b = self;
    vk_buffer_free(b->base.vk, b->tri);
    b->tri = NULL;
    b->tri_count = job->scene->tri_count;
    b->base.lists = job->query == QUERY_ALL;
    enum status status = make_pipeline(b, job, reason);
    if (!status)
        status = gather_triangles(b->base.vk, job->scene, &b->tri, reason);
    b->base.bytes = vk_buffer_bytes(b->tri);
    if (status)
        b->base.chosen = NULL;
    return status;
}

static enum status frame_prepare(void *self, const struct frame_job *job, struct reason *reason)
{
    struct brute *b = self;
    if (!b->framer)
        b->framer = framer_make(b->base.vk, true);
    if (!b->framer)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    return framer_prepare(b->framer, job, reason);
}

static enum status frame(void *self, const struct view *view, struct frame *out,
                         struct trace_report *report, struct reason *reason)
{
    return framer_draw(((struct brute *)self)->framer, view, out, report, reason);
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct brute *b = self;
    if (!b->worlds)
        b->worlds = world_runner_make(b->base.vk, b->base.workgroup);
    if (!b->worlds)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    return world_runner_prepare_brute(b->worlds, job, reason);
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    return world_runner_trace(((struct brute *)self)->worlds, ray, mode, ray_count, 1, hit, tag,
                              NULL, report, reason);
}

static enum status trace_world_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    struct trace_report unused;
    return world_runner_trace(((struct brute *)self)->worlds, ray, mode, ray_count, capacity, hit,
                              tag, hit_count, &unused, reason);
}

static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine;
    struct brute *b = self;
    if (!b->measured)
        b->arithmetic = probe_measure(b->base.vk);
    b->measured = true;
    return model_of_tri(tri, b->arithmetic.rounding, false);
}

extern const struct engine engine_vulkan_brute;
static const struct world_tracer worlds = {
    .prepare_world = prepare_world,
    .trace_world = trace_world,
    .trace_world_all = trace_world_all,
};
static const struct frame_renderer renderer = {.prepare = frame_prepare, .draw = frame};

const struct engine engine_vulkan_brute = {
    .name = "vulkan_brute",
    .gpu = true,
    .summary = "compute shader on a Vulkan device, every triangle",
    .brute = true,
    .open = open,
    .prepare = prepare,
    .trace = batch_trace,
    .trace_all = batch_trace_all,
    .worlds = &worlds,
    .renderer = &renderer,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

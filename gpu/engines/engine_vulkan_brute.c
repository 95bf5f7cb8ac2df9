/* Engine `vulkan_brute`: shaders/trace_brute.comp, every triangle for every ray on a Vulkan
 * device. With engine `vulkan` it tells what the tree loses, with engine `brute` what the device's
 * arithmetic does: those two must agree in every bit where the device's operators are C's. */
#include "gpu/trace/batch.h"
#include "gpu/trace/dispatch.h"
#include "gpu/frame/framer.h"
#include "gpu/trace/gather.h"
#include "gpu/card/probe.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/twin/twin.h"

#include <stdlib.h>

#define QUERIES 3u
#define TRIS    5u

/* Ray-triangle tests of one dispatch: begun small, doubled while a dispatch is quick, halved when
 * it is slow, so that no driver's watchdog ends a long job. */
#define TESTS_FIRST (1u << 24)
#define TESTS_MOST  (1u << 30)
#define QUICK_NS    100000000u
#define SLOW_NS     1000000000u

struct brute {
    struct vk *vk;
    uint32_t workgroup;
    struct vk_pipeline *pipeline[TRIS][QUERIES];
    struct vk_pipeline *chosen; /* of the job; NULL: none prepared */
    struct vk_buffer *tri;
    uint32_t tri_count;
    bool lists; /* prepared for QUERY_ALL */
    uint64_t tests;
    struct arithmetic arithmetic;
    bool measured;
    struct framer *framer; /* NULL until a frame is prepared */
};

/* Where the answers of a call go. */
struct brute_answers {
    struct hit *hit;
    uint32_t *found; /* QUERY_ALL, else NULL */
    uint32_t capacity;
};

_Static_assert(ABI_TRI_BALDWIN_WEBBER < TRIS && ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct brute *b = self;
    if (!b)
        return;
    framer_free(b->framer);
    for (uint32_t t = 0; t < TRIS && b->vk; t++)
        for (uint32_t q = 0; q < QUERIES; q++)
            vk_pipeline_free(b->vk, b->pipeline[t][q]);
    if (b->vk)
        vk_buffer_free(b->vk, b->tri);
    (void)vk_close(b->vk, NULL);
    free(b);
}

static enum status open(const struct engine_options *options, void **self, struct reason *reason)
{
    struct brute *b = alloc_zeroed(1, sizeof *b);
    *self = NULL;
    if (!b)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    struct vk_options vk_options = vulkan_options(options);
    b->workgroup = options->workgroup ? options->workgroup : ABI_WORKGROUP;
    b->tests = TESTS_FIRST;
    enum status status = vk_open(&vk_options, &b->vk, reason);
    if (status)
        close(b);
    else
        *self = b;
    return status;
}

static enum status make_pipeline(struct brute *b, const struct job *job, struct reason *reason)
{
    struct vk_pipeline **pipeline = &b->pipeline[job->tri->id][job->query];
    const struct dispatch dispatch = dispatch_brute(job, b->workgroup);
    const struct vk_shader make = dispatch_shader(&dispatch);
    enum status status = *pipeline ? STATUS_OK : vk_pipeline_make(b->vk, &make, pipeline, reason);
    b->chosen = *pipeline;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct brute *b = self;
    vk_buffer_free(b->vk, b->tri);
    b->tri = NULL;
    b->tri_count = job->scene->tri_count;
    b->lists = job->query == QUERY_ALL;
    enum status status = make_pipeline(b, job, reason);
    if (!status)
        status = gather_triangles(b->vk, job->scene, &b->tri, reason);
    if (status)
        b->chosen = NULL;
    return status;
}

/* One part of the triangles: best hits are read from one buffer and written to the other, lists
 * grow in place and their lengths change places. */
static enum status run_part(struct brute *b, struct batch *batch, const struct push *push, int turn,
                            size_t first, struct vk_time *time, struct reason *reason)
{
    struct vk_buffer *const buffer[BATCH_BINDINGS] = {
        [ABI_BIND_RAYS] = batch->rays,
        [ABI_BIND_HITS] = batch->hits[b->lists ? 0 : turn],
        [ABI_BIND_FLAGS] = batch->flags,
        [ABI_BIND_NODES] = b->lists ? batch->none : batch->hits[1 - turn],
        [ABI_BIND_ITEMS] = b->lists ? batch->found[1 - turn] : batch->none,
        [ABI_BIND_TRIS] = b->tri,
        [ABI_BIND_FOUND] = batch->found[turn],
    };
    return batch_run(batch, b->chosen, buffer, push, first, time, reason);
}

/* All triangles for `count` rays, which begin at ray `first`. */
static enum status trace_batch(struct brute *b, struct batch *batch, const struct ray *ray,
                               size_t first, uint32_t count, const struct brute_answers *to,
                               struct trace_report *report, struct reason *reason)
{
    int turn = 1;
    uint32_t done = 0;
    enum status status = batch_rays(batch, ray + first, count, reason);
    do { /* without a triangle there is one empty part: it writes the misses */
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
    return batch_read(batch, b->lists ? 0 : turn, turn, count, to->hit + first * batch->capacity,
                      to->found ? to->found + first : NULL, reason);
}

static enum status trace_rays(struct brute *b, const struct ray *ray, size_t ray_count,
                              const struct brute_answers *to, struct trace_report *report,
                              struct reason *reason)
{
    *report = (struct trace_report){.device_clock = true};
    if (!b->chosen || b->lists != (to->found != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: not prepared for this query");
    if (!ray_count)
        return STATUS_OK;
    struct batch batch;
    enum status status =
        batch_make(b->vk, b->workgroup, ray_count, b->lists, to->capacity, true, &batch, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint64_t part =
            b->tests / (b->tri_count < DISPATCH_PART ? b->tri_count + 1 : DISPATCH_PART);
        part = part < 1 ? 1 : part < batch.most ? part : batch.most;
        part = part < ray_count - done ? part : ray_count - done;
        status = trace_batch(b, &batch, ray, done, (uint32_t)part, to, report, reason);
        done += part;
    }
    report->tris = (uint64_t)ray_count * b->tri_count; /* an upper bound for any-hit */
    report->memory_bytes = vk_buffer_bytes(b->tri) + batch_bytes(&batch);
    batch_free(&batch);
    if (!status && vk_messages(b->vk, reason))
        status = STATUS_DEVICE;
    return status;
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    const struct brute_answers to = {hit, NULL, 1};
    return trace_rays(self, ray, ray_count, &to, report, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    const struct brute_answers to = {hit, hit_count, capacity};
    struct trace_report unused;
    return trace_rays(self, ray, ray_count, &to, &unused, reason);
}

static enum status frame_prepare(void *self, const struct frame_job *job, struct reason *reason)
{
    struct brute *b = self;
    if (!b->framer)
        b->framer = framer_make(b->vk, true);
    if (!b->framer)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    return framer_prepare(b->framer, job, reason);
}

static enum status frame(void *self, const struct view *view, struct frame *out,
                         struct trace_report *report, struct reason *reason)
{
    return framer_draw(((struct brute *)self)->framer, view, out, report, reason);
}

static struct model model(void *self, const struct tri_test *tri)
{
    struct brute *b = self;
    if (!b->measured)
        b->arithmetic = probe_measure(b->vk);
    b->measured = true;
    return model_of_tri(tri, b->arithmetic.rounding, false);
}

extern const struct engine engine_vulkan_brute;
static const struct frame_renderer renderer = {.prepare = frame_prepare, .draw = frame};

const struct engine engine_vulkan_brute = {
    .name = "vulkan_brute",
    .gpu = true,
    .summary = "compute shader on a Vulkan device, every triangle",
    .brute = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .renderer = &renderer,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

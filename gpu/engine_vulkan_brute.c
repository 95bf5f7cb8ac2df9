/* Engine `vulkan_brute`: shaders/trace_brute.comp, every triangle for every ray on a Vulkan
 * device. With engine `vulkan` it tells what the tree loses, with engine `brute` what the device's
 * arithmetic does: those two must agree in every bit where the device's operators are C's. */
#include "gpu/gather.h"
#include "gpu/probe.h"
#include "gpu/vulkan_options.h"
#include "ref/twin.h"

#include <stdlib.h>
#include <string.h>

#define BINDINGS (ABI_BIND_FOUND + 1u)
#define QUERIES  3u
#define TRIS     3u

/* Triangles of one dispatch: under lavapipe 22's loop cap of 65,535. */
#define PART 16384u

/* Ray-triangle tests of one dispatch: begun small, doubled while a dispatch is quick, halved when
 * it is slow, so that no driver's watchdog ends a long job. */
#define TESTS_FIRST (1u << 24)
#define TESTS_MOST  (1u << 30)
#define QUICK_NS    100000000u
#define SLOW_NS     1000000000u

/* Rays of a batch; hits that a batch of QUERY_ALL may list. */
#define RAYS_MOST (1u << 18)
#define LIST_MOST (1u << 22)

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
    /* Of one call of trace: */
    struct vk_buffer *rays, *flags, *none;
    struct vk_buffer *hits[2], *found[2]; /* of this part and of the one before */
    uint32_t *flag;
};

_Static_assert(ABI_TRI_WOOP < TRIS && ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct brute *b = self;
    if (!b)
        return;
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
    const struct shader *shader = shader_find("trace_brute");
    const uint32_t constant[] = {b->workgroup, ABI_BOX_ROBUST, job->tri->id, job->query, 16};
    struct vk_shader make = {
        .name = shader->name,
        .word = shader->word,
        .word_count = shader->word_count,
        .binding_count = BINDINGS,
        .push_bytes = sizeof(struct push),
        .constant = constant,
        .constant_count = ARRAY_COUNT(constant),
    };
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

static uint64_t least_of(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Most rays of a batch, by the device's buffers and groups. */
static uint64_t rays_at_once(const struct brute *b, uint64_t hit_bytes)
{
    const struct vk_limits *limits = vk_limits(b->vk);
    uint64_t most = least_of(RAYS_MOST, (uint64_t)limits->groups * b->workgroup);
    uint64_t lists = LIST_MOST * sizeof(struct hit) / hit_bytes;
    if (b->lists)
        most = least_of(most, lists ? lists : 1);
    most = least_of(most, limits->buffer_bytes / hit_bytes);
    return least_of(most, limits->buffer_bytes / sizeof(struct ray));
}

static void free_batch(struct brute *b)
{
    vk_buffer_free(b->vk, b->rays);
    vk_buffer_free(b->vk, b->flags);
    vk_buffer_free(b->vk, b->none);
    for (int i = 0; i < 2; i++) {
        vk_buffer_free(b->vk, b->hits[i]);
        vk_buffer_free(b->vk, b->found[i]);
        b->hits[i] = b->found[i] = NULL;
    }
    b->rays = b->flags = b->none = NULL;
    free(b->flag);
    b->flag = NULL;
}

static enum status make_batch(struct brute *b, uint64_t rays, uint64_t hit_bytes,
                              struct reason *reason)
{
    const uint64_t word = sizeof *b->flag;
    b->flag = alloc_zeroed(rays, word);
    if (!b->flag)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the flags of %llu rays",
                    (unsigned long long)rays);
    enum status status = vk_buffer_make(b->vk, rays * sizeof(struct ray), &b->rays, reason);
    if (!status)
        status = vk_buffer_make(b->vk, rays * word, &b->flags, reason);
    if (!status)
        status = vk_buffer_make(b->vk, 0, &b->none, reason);
    for (int i = 0; i < 2 && !status; i++) {
        /* A list grows in place; a best hit is read from one buffer and written to the other. */
        status = vk_buffer_make(b->vk, b->lists && i ? 0 : rays * hit_bytes, &b->hits[i], reason);
        if (!status)
            status = vk_buffer_make(b->vk, b->lists ? rays * word : 0, &b->found[i], reason);
    }
    return status;
}

static enum status check_flags(const struct brute *b, size_t first, uint32_t count,
                               struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (b->flag[i] != ABI_FLAG_DONE)
            return fail(reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                        vk_limits(b->vk)->device, first + i,
                        b->flag[i] & ABI_FLAG_LOOP ? "the driver ended its loop early"
                                                   : "its invocation did not run to the end");
    return STATUS_OK;
}

/* One part of the triangles; `turn` tells the two buffers of each kind apart. */
static enum status dispatch_part(struct brute *b, struct push *push, uint32_t turn, size_t first,
                                 struct vk_time *time, struct reason *reason)
{
    struct vk_buffer *buffer[BINDINGS] = {
        [ABI_BIND_RAYS] = b->rays,
        [ABI_BIND_HITS] = b->hits[b->lists ? 0 : turn],
        [ABI_BIND_FLAGS] = b->flags,
        [ABI_BIND_NODES] = b->lists ? b->none : b->hits[1 - turn],
        [ABI_BIND_ITEMS] = b->lists ? b->found[1 - turn] : b->none,
        [ABI_BIND_TRIS] = b->tri,
        [ABI_BIND_FOUND] = b->found[turn],
    };
    const uint64_t flag_bytes = push->ray_count * sizeof *b->flag;
    memset(b->flag, 0, flag_bytes); /* so that a ray never traced has no DONE */
    enum status status = vk_buffer_write(b->vk, b->flags, 0, b->flag, flag_bytes, reason);
    uint32_t groups = (push->ray_count + b->workgroup - 1) / b->workgroup;
    if (!status)
        status = vk_dispatch(b->vk, b->chosen, buffer, push, groups, time, reason);
    if (!status)
        status = vk_buffer_read(b->vk, b->flags, 0, b->flag, flag_bytes, reason);
    return status ? status : check_flags(b, first, push->ray_count, reason);
}

/* All triangles for `count` rays, which begin at ray `first`. */
static enum status trace_batch(struct brute *b, const struct ray *ray, size_t first, uint32_t count,
                               uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                               struct trace_report *report, struct reason *reason)
{
    struct push push = {.ray_count = count, .tri_count = b->tri_count, .capacity = capacity};
    uint32_t turn = 1, done = 0;
    enum status status = vk_buffer_write(b->vk, b->rays, 0, ray, count * sizeof *ray, reason);
    do { /* without a triangle there is one empty part: it writes the misses */
        struct vk_time time = {0};
        uint32_t part = b->tri_count - done < PART ? b->tri_count - done : PART;
        turn = 1 - turn;
        push.root = done;
        push.node_count = done + part;
        done += part;
        if (!status)
            status = dispatch_part(b, &push, turn, first, &time, reason);
        report->ns += time.ns;
        report->device_clock = report->device_clock && time.device_clock;
        if (part == PART && time.ns < QUICK_NS && b->tests < TESTS_MOST)
            b->tests *= 2;
        else if (time.ns > SLOW_NS && b->tests > TESTS_FIRST)
            b->tests /= 2;
    } while (!status && done < b->tri_count);
    const uint64_t hits = (uint64_t)count * capacity;
    if (!status && hit_count)
        status =
            vk_buffer_read(b->vk, b->found[turn], 0, hit_count, count * sizeof *hit_count, reason);
    if (!status && hits)
        status =
            vk_buffer_read(b->vk, b->hits[b->lists ? 0 : turn], 0, hit, hits * sizeof *hit, reason);
    return status;
}

static enum status trace_rays(struct brute *b, const struct ray *ray, size_t ray_count,
                              uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                              struct trace_report *report, struct reason *reason)
{
    *report = (struct trace_report){.device_clock = true};
    if (!b->chosen || b->lists != (hit_count != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: not prepared for this query");
    if (!ray_count)
        return STATUS_OK;
    const uint64_t hit_bytes = (uint64_t)(capacity ? capacity : 1) * sizeof *hit;
    const uint64_t most = least_of(rays_at_once(b, hit_bytes), ray_count);
    if (most == 0)
        return fail(reason, STATUS_LIMIT, "vulkan: %u hits of a ray are over the device's buffers",
                    (unsigned)capacity);
    enum status status = make_batch(b, most, hit_bytes, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint64_t part = b->tests / (b->tri_count < PART ? b->tri_count + 1 : PART);
        part = least_of(least_of(part ? part : 1, most), ray_count - done);
        status = trace_batch(b, ray + done, done, (uint32_t)part, capacity, hit + done * capacity,
                             hit_count ? hit_count + done : NULL, report, reason);
        done += part;
    }
    report->tris = (uint64_t)ray_count * b->tri_count; /* an upper bound for any-hit */
    report->memory_bytes = vk_buffer_bytes(b->tri) + vk_buffer_bytes(b->rays) +
                           vk_buffer_bytes(b->flags) + vk_buffer_bytes(b->hits[0]) +
                           vk_buffer_bytes(b->hits[1]);
    free_batch(b);
    if (!status && vk_messages(b->vk, reason))
        status = STATUS_DEVICE;
    return status;
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    return trace_rays(self, ray, ray_count, 1, hit, NULL, report, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    struct trace_report unused;
    return trace_rays(self, ray, ray_count, capacity, hit, hit_count, &unused, reason);
}

static struct model model(void *self, const struct tri_test *tri)
{
    struct brute *b = self;
    if (!b->measured)
        b->arithmetic = probe_measure(b->vk);
    b->measured = true;
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = b->arithmetic.rounding,
                          .watertight = tri->watertight,
                          .open = tri->open};
}

extern const struct engine engine_vulkan_brute;
const struct engine engine_vulkan_brute = {
    .name = "vulkan_brute",
    .summary = "compute shader on a Vulkan device, every triangle",
    .brute = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

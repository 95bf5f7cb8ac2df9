#include "ref/engines/cpu_worlds.h"

#include "ref/engines/cpu_rays.h"
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/packed_world.h"

#include <stdlib.h>

/* What both engines do for one ray. */
typedef enum status world_ray_fn(const struct cpu_rays *rays, const struct ray *ray,
                                 struct ray_mode mode, struct hit *hit, uint32_t *tag,
                                 struct trace_counts *counts);
typedef enum status world_ray_all_fn(const struct cpu_rays *rays, const struct ray *ray,
                                     struct ray_mode mode, uint32_t capacity, struct hit *hit,
                                     uint32_t *tag, uint32_t *count);

static struct ray_mode mode_of(const struct ray_mode *mode, size_t ray)
{
    return mode ? mode[ray] : ray_mode_all();
}

static enum status unfinished_rays(uint64_t unfinished, size_t ray_count, long long last,
                                   struct reason *reason)
{
    if (!unfinished)
        return STATUS_OK;
    return fail(reason, STATUS_DEVICE,
                "%llu of %zu rays not finished: stack or nodes of a level exhausted, last ray %lld",
                (unsigned long long)unfinished, ray_count, last);
}

/* Bytes that the traversal reads: packed trees, vertices, indices. */
static uint64_t world_bytes(const struct cpu_rays *rays)
{
    const struct world_job *job = &rays->world;
    uint64_t bytes = job->packed ? packed_world_bytes(job->packed)
                                 : job->world->instance_count * sizeof *rays->record;
    for (uint32_t i = 0; i < job->world->mesh_count; i++) {
        const struct scene *scene = job->world->mesh[i].scene;
        bytes += 12 * ((uint64_t)scene->vertex_count + scene->tri_count);
    }
    return bytes;
}

static enum status trace_each(const struct cpu_rays *rays, world_ray_fn *answer,
                              const struct ray *ray, const struct ray_mode *mode, size_t ray_count,
                              struct hit *hit, uint32_t *tag, struct trace_report *report,
                              struct reason *reason)
{
    uint64_t boxes = 0, tris = 0, unfinished = 0;
    long long worst = 0;
    uint64_t start = time_ns();
#pragma omp parallel for schedule(dynamic, 64) num_threads(rays->threads) if (ray_count > 64)    \
    reduction(+ : boxes, tris, unfinished) reduction(max : worst)
    for (long long i = 0; i < (long long)ray_count; i++) {
        struct trace_counts counts = {0, 0};
        if (answer(rays, &ray[i], mode_of(mode, (size_t)i), &hit[i], &tag[i], &counts)) {
            unfinished++;
            worst = i > worst ? i : worst;
        }
        boxes += counts.boxes;
        tris += counts.tris;
    }
    *report = (struct trace_report){
        .ns = time_ns() - start, .boxes = boxes, .tris = tris, .memory_bytes = world_bytes(rays)};
    return unfinished_rays(unfinished, ray_count, worst, reason);
}

static enum status trace_all_of_each(const struct cpu_rays *rays, world_ray_all_fn *answer,
                                     const struct ray *ray, const struct ray_mode *mode,
                                     size_t ray_count, uint32_t capacity, struct hit *hit,
                                     uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    uint64_t unfinished = 0;
    long long worst = 0;
#pragma omp parallel for schedule(dynamic, 64) num_threads(rays->threads) if (ray_count > 64)    \
    reduction(+ : unfinished) reduction(max : worst)
    for (long long i = 0; i < (long long)ray_count; i++) {
        size_t first = (size_t)i * capacity;
        if (answer(rays, &ray[i], mode_of(mode, (size_t)i), capacity, hit + first, tag + first,
                   &hit_count[i])) {
            unfinished++;
            worst = i > worst ? i : worst;
        }
    }
    return unfinished_rays(unfinished, ray_count, worst, reason);
}

/* --- on trees --------------------------------------------------------------------------------- */

static enum status packed_prepare(void *self, const struct world_job *job, struct reason *reason)
{
    enum status status = STATUS_OK;
    ((struct cpu_rays *)self)->world = *job;
    for (uint32_t i = 0; i < job->packed->mesh_count && !status; i++)
        status =
            tri_store_check(job->packed->bottom[i].store, job->tri->id, job->tri->name, reason);
    return status;
}

static enum status packed_ray(const struct cpu_rays *rays, const struct ray *ray,
                              struct ray_mode mode, struct hit *hit, uint32_t *tag,
                              struct trace_counts *counts)
{
    return trace_world_ray(&rays->world, ray, mode, hit, tag, counts);
}

static enum status packed_ray_all(const struct cpu_rays *rays, const struct ray *ray,
                                  struct ray_mode mode, uint32_t capacity, struct hit *hit,
                                  uint32_t *tag, uint32_t *count)
{
    return trace_world_ray_all(&rays->world, ray, mode, capacity, hit, tag, count, NULL);
}

static enum status packed_trace(void *self, const struct ray *ray, const struct ray_mode *mode,
                                size_t ray_count, struct hit *hit, uint32_t *tag,
                                struct trace_report *report, struct reason *reason)
{
    return trace_each(self, packed_ray, ray, mode, ray_count, hit, tag, report, reason);
}

static enum status packed_trace_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                    size_t ray_count, uint32_t capacity, struct hit *hit,
                                    uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    return trace_all_of_each(self, packed_ray_all, ray, mode, ray_count, capacity, hit, tag,
                             hit_count, reason);
}

const struct world_tracer cpu_worlds_packed = {
    .prepare_world = packed_prepare,
    .trace_world = packed_trace,
    .trace_world_all = packed_trace_all,
};

/* --- without ---------------------------------------------------------------------------------- */

static enum status brute_prepare(void *self, const struct world_job *job, struct reason *reason)
{
    struct cpu_rays *rays = self;
    free(rays->record);
    rays->world = *job;
    return world_records_make(job->world, &rays->record, reason);
}

static enum status brute_ray(const struct cpu_rays *rays, const struct ray *ray,
                             struct ray_mode mode, struct hit *hit, uint32_t *tag,
                             struct trace_counts *counts)
{
    const struct world_job *job = &rays->world;
    trace_world_brute(job->world, rays->record, job->tri, job->query, ray, mode, hit, tag);
    counts->tris += world_tri_count(job->world); /* an upper bound */
    return STATUS_OK;
}

static enum status brute_ray_all(const struct cpu_rays *rays, const struct ray *ray,
                                 struct ray_mode mode, uint32_t capacity, struct hit *hit,
                                 uint32_t *tag, uint32_t *count)
{
    const struct world_job *job = &rays->world;
    *count =
        trace_world_brute_all(job->world, rays->record, job->tri, ray, mode, capacity, hit, tag);
    return STATUS_OK;
}

static enum status brute_trace(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    return trace_each(self, brute_ray, ray, mode, ray_count, hit, tag, report, reason);
}

static enum status brute_trace_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    return trace_all_of_each(self, brute_ray_all, ray, mode, ray_count, capacity, hit, tag,
                             hit_count, reason);
}

const struct world_tracer cpu_worlds_brute = {
    .prepare_world = brute_prepare,
    .trace_world = brute_trace,
    .trace_world_all = brute_trace_all,
};

#include "bench/traffic/traffic_paths.h"

#include "bench/measure/bounce_rays.h"
#include "ref/base/memory.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"

#include <stdlib.h>

uint64_t traffic_paths_bytes(size_t count, uint32_t depth)
{
    return (uint64_t)count * depth * (sizeof(struct ray) + sizeof(struct hit) + sizeof(uint32_t));
}

static enum status wave_make(size_t count, struct traffic_wave *out, struct reason *reason)
{
    out->count = count;
    out->ray = alloc_zeroed(count, sizeof *out->ray);
    out->hit = alloc_zeroed(count, sizeof *out->hit);
    out->path = alloc_zeroed(count, sizeof *out->path);
    if (!out->ray || !out->hit || !out->path)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    return STATUS_OK;
}

static enum status wave_trace(struct traffic_wave *wave, const struct job *job,
                              struct reason *reason)
{
    bool limit = false;
#pragma omp parallel for schedule(dynamic, 256) reduction(|| : limit)
    for (long long i = 0; i < (long long)wave->count; i++)
        limit = trace_ray(job, &wave->ray[i], &wave->hit[i], NULL) != STATUS_OK || limit;
    return limit ? fail(reason, STATUS_LIMIT, "a ray was not finished") : STATUS_OK;
}

static size_t hits_of(const struct traffic_wave *wave)
{
    size_t hits = 0;
    for (size_t i = 0; i < wave->count; i++)
        hits += wave->hit[i].prim != ABI_NO_PRIM;
    return hits;
}

/* Makes the rays that leave the hits of a wave. */
static enum status bounce(const struct job *job, uint64_t seed, const struct traffic_wave *from,
                          struct traffic_wave *to, struct reason *reason)
{
    struct world world;
    struct box box = scene_bounds(job->scene);
    size_t hits = 0;
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = (double)box.hi[k] - (double)box.lo[k] > size ? (double)box.hi[k] - (double)box.lo[k]
                                                            : size;
    struct ray *ray = alloc_zeroed(from->count, sizeof *ray);
    if (!ray)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", from->count);
    enum status status = world_of_scene(job->scene, &world, reason);
    if (!status)
        status =
            bounce_rays_make(&world, size, seed, from->ray, from->hit, from->count, ray, reason);
    world_free(&world);
    for (size_t i = 0; i < from->count && !status; i++) {
        if (from->hit[i].prim == ABI_NO_PRIM)
            continue;
        to->ray[hits] = ray[hits];
        to->path[hits++] = from->path[i];
    }
    free(ray);
    return status;
}

static enum status make_all(const struct job *job, uint64_t seed, size_t count, uint32_t depth,
                            struct traffic_paths *out, struct reason *reason)
{
    struct traffic_wave *first = &out->wave[0];
    enum status status = wave_make(count, first, reason);
    if (!status)
        status = ray_set_make(ray_set_find("primary"), job->scene, seed, count, first->ray, reason);
    for (size_t i = 0; i < count && !status; i++)
        first->path[i] = (uint32_t)i;
    if (!status)
        status = wave_trace(first, job, reason);
    out->depth = 1;
    if (!status && hits_of(first) == 0)
        return fail(reason, STATUS_INPUT, "no camera ray hits the scene");
    while (!status && out->depth < depth) {
        struct traffic_wave *from = &out->wave[out->depth - 1], *to = &out->wave[out->depth];
        size_t hits = hits_of(from);
        if (hits == 0)
            break;
        status = wave_make(hits, to, reason);
        if (!status)
            status = bounce(job, seed + out->depth, from, to, reason);
        if (!status)
            status = wave_trace(to, job, reason);
        out->depth++;
    }
    return status;
}

enum status traffic_paths_make(const struct job *job, uint64_t seed, size_t count, uint32_t depth,
                               struct traffic_paths *out, struct reason *reason)
{
    *out = (struct traffic_paths){.depth = 0};
    if (!memory_fits(traffic_paths_bytes(count, depth)))
        return fail(reason, STATUS_MEMORY, "%zu paths of %u rays need up to %llu MiB of memory",
                    count, depth, (unsigned long long)(traffic_paths_bytes(count, depth) >> 20));
    enum status status = make_all(job, seed, count, depth, out, reason);
    if (status)
        traffic_paths_free(out);
    return status;
}

enum status traffic_paths_trace(struct traffic_paths *paths, const struct job *job,
                                struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < paths->depth && !status; k++)
        status = wave_trace(&paths->wave[k], job, reason);
    return status;
}

void traffic_paths_free(struct traffic_paths *paths)
{
    for (uint32_t k = 0; k < TRAFFIC_DEPTH_MOST; k++) {
        free(paths->wave[k].ray);
        free(paths->wave[k].hit);
        free(paths->wave[k].path);
    }
    *paths = (struct traffic_paths){.depth = 0};
}

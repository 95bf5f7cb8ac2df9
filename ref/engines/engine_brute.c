/* Tests every triangle for every ray, without a tree: any difference between it and another engine
 * comes from the tree. */
#include "ref/engines/cpu_rays.h"
#include "ref/engines/cpu_worlds.h"
#include "ref/trace/trace.h"

#include <stdio.h>

static enum status brute_ray(const struct job *job, const struct ray *ray, struct hit *hit,
                             struct trace_counts *counts)
{
    trace_brute(job->scene, job->tri, job->query, ray, hit);
    counts->tris += job->scene->tri_count; /* for any-hit an upper bound */
    return STATUS_OK;
}

static enum status brute_ray_all(const struct job *job, const struct ray *ray, uint32_t capacity,
                                 struct hit *hit, uint32_t *count)
{
    *count = trace_brute_all(job->scene, job->tri, ray, capacity, hit);
    return STATUS_OK;
}

static enum status brute_open(const struct engine *engine, const struct engine_options *options,
                              void **self, struct reason *reason)
{
    (void)engine;
    return cpu_rays_open(options, brute_ray, brute_ray_all, self, reason);
}

static void brute_describe(const struct engine *engine, const struct engine_options *options,
                           char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, every triangle for every ray",
             cpu_rays_threads(options));
}

const struct engine engine_brute = {
    .name = "brute",
    .summary = "C, every triangle: the reference for what a tree loses",
    .reference = true,
    .brute = true,
    .open = brute_open,
    .prepare = cpu_rays_prepare,
    .trace = cpu_rays_trace,
    .trace_all = cpu_rays_trace_all,
    .worlds = &cpu_worlds_brute,
    .model = cpu_rays_model,
    .close = cpu_rays_close,
    .describe = brute_describe,
};

/* A dual-split tree, made of the job's binary tree, on all cores. */
#include "ref/dual/dual.h"
#include "ref/engine.h"
#include "ref/engines/cpu_rays.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>

struct dual {
    struct dual_tree tree;
    struct job job;
    unsigned threads;
};

static enum status dual_open(const struct engine *engine, const struct engine_options *options,
                             void **self, struct reason *reason)
{
    (void)engine;
    struct dual *dual = alloc_zeroed(1, sizeof *dual);
    *self = dual;
    if (!dual)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    dual->threads = cpu_rays_threads(options);
    return STATUS_OK;
}

static void dual_close(void *self)
{
    struct dual *dual = self;
    if (dual)
        dual_free(&dual->tree);
    free(dual);
}

static enum status dual_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct dual *dual = self;
    const struct packed *packed = job->packed;
    dual_free(&dual->tree);
    dual->job = *job;
    if (packed->layout->faithful)
        return fail(reason, STATUS_UNSUPPORTED, "dual_split has no layout that loses hits, as %s",
                    packed->layout->name);
    if (tri_store_check(packed->store, job->tri->id, job->tri->name, reason))
        return STATUS_UNSUPPORTED;
    return dual_make(packed, DUAL_BY_COST, &dual->tree, reason);
}

static struct trace_report report_of(const struct dual *dual)
{
    const struct packed *packed = dual->job.packed;
    struct trace_report report = {.node_bytes = dual_node_bytes(&dual->tree),
                                  .item_bytes = packed_item_bytes(packed)};
    report.memory_bytes = report.node_bytes + report.item_bytes;
    if (tri_store_reads_scene(packed->store))
        report.memory_bytes +=
            12 * ((uint64_t)dual->job.scene->vertex_count + dual->job.scene->tri_count);
    return report;
}

static enum status dual_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                              struct trace_report *report, struct reason *reason)
{
    (void)reason;
    const struct dual *dual = self;
    uint64_t planes = 0, tris = 0, start = time_ns();
#pragma omp parallel for schedule(dynamic, 64) num_threads(dual->threads) if (ray_count > 64)      \
    reduction(+ : planes, tris)
    for (long long i = 0; i < (long long)ray_count; i++) {
        struct trace_counts counts = {0, 0};
        dual_ray(&dual->tree, &dual->job, &ray[i], &hit[i], &counts);
        planes += counts.boxes;
        tris += counts.tris;
    }
    *report = report_of(dual);
    report->ns = time_ns() - start;
    report->boxes = planes;
    report->tris = tris;
    return STATUS_OK;
}

static enum status dual_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                  uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                  struct reason *reason)
{
    (void)reason;
    const struct dual *dual = self;
#pragma omp parallel for schedule(dynamic, 64) num_threads(dual->threads) if (ray_count > 64)
    for (long long i = 0; i < (long long)ray_count; i++)
        dual_ray_all(&dual->tree, &dual->job, &ray[i], capacity, hit + (size_t)i * capacity,
                     &hit_count[i], NULL);
    return STATUS_OK;
}

static void dual_describe(const struct engine *engine, const struct engine_options *options,
                          char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, dual-split trees of binary layouts",
             cpu_rays_threads(options));
}

extern const struct engine engine_dual_split;
const struct engine engine_dual_split = {
    .name = "dual_split",
    .summary = "C, a dual-split tree of the job's tree: two planes a node",
    .needs_packed = true,
    .binary = true,
    .own_tree = true,
    .open = dual_open,
    .prepare = dual_prepare,
    .trace = dual_trace,
    .trace_all = dual_trace_all,
    .model = cpu_rays_model,
    .close = dual_close,
    .describe = dual_describe,
};

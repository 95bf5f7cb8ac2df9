/* A k-d tree of the scene's own, with the triangle test of its time, on all cores. */
#include "ref/engine.h"
#include "ref/engines/cpu_rays.h"
#include "ref/kd/kd.h"
#include "ref/trace/all_hits.h"
#include "ref/twin/model.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

struct kd {
    struct kd_tree tree;
    enum query query;
    unsigned threads;
};

static enum status kd_open(const struct engine *engine, const struct engine_options *options,
                           void **self, struct reason *reason)
{
    (void)engine;
    struct kd *kd = alloc_zeroed(1, sizeof *kd);
    *self = kd;
    if (!kd)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    kd->threads = cpu_rays_threads(options);
    return STATUS_OK;
}

static void kd_close(void *self)
{
    struct kd *kd = self;
    if (kd)
        kd_free(&kd->tree);
    free(kd);
}

static enum status kd_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct kd *kd = self;
    kd_free(&kd->tree);
    kd->query = job->query;
    return kd_make(job->scene, &kd->tree, reason);
}

static enum status kd_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                            struct trace_report *report, struct reason *reason)
{
    (void)reason;
    const struct kd *kd = self;
    uint64_t planes = 0, tris = 0, start = time_ns();
#pragma omp parallel for schedule(dynamic, 64) num_threads(kd->threads) if (ray_count > 64)        \
    reduction(+ : planes, tris)
    for (long long i = 0; i < (long long)ray_count; i++) {
        struct kd_counts counts = {0};
        hit[i] = kd->query == QUERY_ANY ? kd_any(&kd->tree, &ray[i], &counts)
                                        : kd_closest(&kd->tree, &ray[i], &counts);
        planes += counts.planes;
        tris += counts.tris;
    }
    *report = (struct trace_report){.ns = time_ns() - start,
                                    .boxes = planes,
                                    .tris = tris,
                                    .node_bytes = kd_node_bytes(&kd->tree),
                                    .item_bytes = kd_item_bytes(&kd->tree)};
    report->memory_bytes = report->node_bytes + report->item_bytes;
    return STATUS_OK;
}

/* All hits of one ray, each triangle once: a triangle of two leaves is found twice, with the same
 * numbers, so that both are neighbours once they are sorted. */
static enum status list_ray(const struct kd_tree *tree, const struct ray *ray, uint32_t capacity,
                            struct kd_list *list, struct hit *hit, uint32_t *hit_count)
{
    struct kd_counts counts = {0};
    uint32_t found = 0;
    *hit_count = 0;
    if (kd_all(tree, ray, list, &counts))
        return STATUS_MEMORY;
    all_hits_sort(list->hit, list->count);
    for (size_t i = 0; i < list->count; i++) {
        if (i > 0 && list->hit[i].prim == list->hit[i - 1].prim)
            continue;
        if (found < capacity)
            hit[found] = list->hit[i];
        found++;
    }
    *hit_count = found;
    return STATUS_OK;
}

static enum status kd_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                struct reason *reason)
{
    const struct kd *kd = self;
    atomic_bool lost = false;
#pragma omp parallel num_threads(kd->threads) if (ray_count > 64)
    {
        struct kd_list list = {0};
#pragma omp for schedule(dynamic, 64)
        for (long long i = 0; i < (long long)ray_count; i++)
            if (list_ray(&kd->tree, &ray[i], capacity, &list, hit + (size_t)i * capacity,
                         &hit_count[i]))
                lost = true;
        free(list.hit);
    }
    return lost ? fail(reason, STATUS_MEMORY, "no memory for the hits of a ray") : STATUS_OK;
}

static struct model kd_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self;
    (void)tri;
    return (struct model){.formula = TWIN_TRI_ACCEL, .rounding = ROUNDING_IEEE};
}

static void kd_describe(const struct engine *engine, const struct engine_options *options,
                        char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, k-d tree by surface areas, triangle test tri_accel",
             cpu_rays_threads(options));
}

extern const struct engine engine_kd;
const struct engine engine_kd = {
    .name = "kd",
    .summary =
        "C, a k-d tree of its own: surface area heuristic, clipped triangles; test tri_accel",
    .own_tri = true,
    .own_tree = true,
    .open = kd_open,
    .prepare = kd_prepare,
    .trace = kd_trace,
    .trace_all = kd_trace_all,
    .model = kd_model,
    .close = kd_close,
    .describe = kd_describe,
};

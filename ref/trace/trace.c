#include "ref/trace/trace_walk.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

static enum status walk_robust(struct walk *w, uint32_t tri_id)
{
    if (tri_id == ABI_TRI_WOOP)
        return walk_tree(w, WALK_SCENE, ABI_BOX_ROBUST, ABI_TRI_WOOP);
    if (tri_id == ABI_TRI_MT) /* the default, without a choice among all of them per triangle */
        return walk_tree(w, WALK_SCENE, ABI_BOX_ROBUST, ABI_TRI_MT);
    return walk_tree(w, WALK_SCENE, ABI_BOX_ROBUST, tri_id);
}

static enum status walk_watertight(struct walk *w, uint32_t tri_id)
{
    if (tri_id == ABI_TRI_WOOP)
        return walk_tree(w, WALK_SCENE, ABI_BOX_WATERTIGHT, ABI_TRI_WOOP);
    return walk_tree(w, WALK_SCENE, ABI_BOX_WATERTIGHT, tri_id);
}

static enum status walk_with(struct walk *w, const struct job *job)
{
    if (job->box->id == ABI_BOX_ROBUST)
        return walk_robust(w, job->tri->id);
    if (job->box->id == ABI_BOX_WATERTIGHT)
        return walk_watertight(w, job->tri->id);
    return walk_tree(w, WALK_SCENE, job->box->id, job->tri->id);
}

static void walk_start(struct walk *w, const struct job *job, const struct wide *decoded,
                       const struct ray *ray)
{
    walk_set_tree(w, job->packed, job->scene);
    walk_set_ray(w, ray);
    w->parent = job->parent;
    w->trail = 0;
    w->decoded = decoded;
    w->query = job->query;
    w->counts = (struct trace_counts){0};
    w->capacity = w->found = 0;
}

static void walk_count(const struct walk *w, struct trace_counts *counts)
{
    if (counts) {
        counts->boxes += w->counts.boxes;
        counts->tris += w->counts.tris;
    }
}

enum status trace_ray(const struct job *job, const struct ray *ray, struct hit *out,
                      struct trace_counts *counts)
{
    struct walk w;
    walk_start(&w, job, NULL, ray);
    enum status status = walk_with(&w, job);
    *out = status ? hit_none() : w.best;
    walk_count(&w, counts);
    return status;
}

/* 16 bits, or as many as they hold. */
static uint32_t at_most(uint64_t count)
{
    return count >> 16 ? 0xFFFF : (uint32_t)count;
}

enum status trace_rays(const struct job *job, const struct ray *ray, size_t count, struct hit *out,
                       uint32_t *flag, uint32_t *work)
{
    const struct packed *packed = job->packed;
    struct wide *decoded = NULL;
    enum status status = STATUS_OK;
    /* Without memory, or if it does not pay, each ray decodes what it visits. */
    if (packed->ref_count <= count)
        decoded = malloc(packed->ref_count * sizeof *decoded);
    for (uint32_t i = 0; i < packed->ref_count && decoded; i++)
        packed->layout->load(packed, i, &decoded[i]);
    for (size_t i = 0; i < count; i++) {
        struct walk w;
        walk_start(&w, job, decoded, &ray[i]);
        bool finished = walk_with(&w, job) == STATUS_OK;
        out[i] = finished ? w.best : hit_none();
        flag[i] = finished ? ABI_FLAG_DONE : ABI_FLAG_EXHAUSTED;
        if (work)
            work[i] = at_most(w.counts.boxes) << 16 | at_most(w.counts.tris);
        status = finished ? status : STATUS_LIMIT;
    }
    free(decoded);
    return status;
}

enum status trace_ray_all(const struct job *job, const struct ray *ray, uint32_t capacity,
                          struct hit *out, uint32_t *count, struct trace_counts *counts)
{
    struct walk w;
    walk_start(&w, job, NULL, ray);
    w.query = QUERY_ALL;
    w.list = out;
    w.capacity = capacity;
    enum status status = walk_with(&w, job);
    *count = status ? 0 : w.found;
    walk_count(&w, counts);
    return status;
}

void trace_brute(const struct scene *scene, const struct tri_test *tri, enum query query,
                 const struct ray *ray, struct hit *out)
{
    struct tri_ray r = tri_ray_make(ray);
    *out = hit_none();
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        struct hit hit;
        scene_tri(scene, prim, v);
        if (!tri_test_run(tri->id, &r, v, &hit))
            continue;
        if (out->prim != ABI_NO_PRIM && !(hit.t < out->t))
            continue;
        hit.prim = prim;
        *out = hit;
        if (query == QUERY_ANY)
            return;
    }
}

uint32_t trace_brute_all(const struct scene *scene, const struct tri_test *tri,
                         const struct ray *ray, uint32_t capacity, struct hit *out)
{
    struct tri_ray r = tri_ray_make(ray);
    uint32_t found = 0;
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        struct hit hit;
        scene_tri(scene, prim, v);
        if (!tri_test_run(tri->id, &r, v, &hit))
            continue;
        hit.prim = prim;
        if (found < capacity)
            out[found] = hit;
        found++;
    }
    return found;
}

#include "tests/hard/made.h"

#include "ref/engines/cpu_rays.h"
#include "ref/explain/slabs.h"
#include "ref/layouts/common.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

/* --- layouts ---------------------------------------------------------------------------------- */

static enum status pack_nearest(const struct layout *self, const struct bvh *bvh,
                                const struct scene *scene, struct packed *out,
                                struct reason *reason)
{
    enum status status = layout_find("rf16")->pack(self, bvh, scene, out, reason);
    if (status)
        return status;
    uint32_t *before = layout_leaves_before(bvh);
    if (!before) {
        packed_free(out);
        return fail(reason, STATUS_MEMORY, "no memory to number %u nodes", bvh->node_count);
    }
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        struct box box = bvh->node[i].bounds;
        layout_pack_bounds(&box, half_nearest, half_nearest,
                           out->word + 4 * (size_t)(i + before[i]));
    }
    free(before);
    return STATUS_OK;
}

static void load_rf16(const struct packed *packed, uint32_t ref, struct wide *out)
{
    layout_find("rf16")->load(packed, ref, out);
}

static struct box box_rf16(const struct packed *packed, uint32_t ref)
{
    return layout_find("rf16")->box(packed, ref);
}

static uint32_t item_rf16(const struct packed *packed, uint32_t slot)
{
    return layout_find("rf16")->item(packed, slot);
}

const struct layout layout_rf16_nearest = {
    .name = "rf16_nearest",
    .summary = "rf16 with bounds rounded to the nearest half",
    .node_bytes = 16,
    .width = 2,
    .order = VISIT_NEAR,
    .pack = pack_nearest,
    .load = load_rf16,
    .box = box_rf16,
    .item = item_rf16,
};

static enum status pack_seed(const struct layout *self, const struct bvh *bvh,
                             const struct scene *scene, struct packed *out, struct reason *reason)
{
    return layout_find("rtrs_rf")->pack(self, bvh, scene, out, reason);
}

static void load_seed(const struct packed *packed, uint32_t ref, struct wide *out)
{
    layout_find("rtrs_rf")->load(packed, ref, out);
}

static struct box box_seed(const struct packed *packed, uint32_t ref)
{
    return layout_find("rtrs_rf")->box(packed, ref);
}

/* rtrs_rf takes item k for triangle k - 1 and item 0 for none; an empty slot is 0 as well, so that
 * triangle 0 stays lost. */
static uint32_t item_unshifted(const struct packed *packed, uint32_t slot)
{
    uint32_t prim = layout_find("rtrs_rf")->item(packed, slot);
    return prim < packed->tri_count - 1 ? prim + 1 : ABI_NO_PRIM;
}

const struct layout layout_rtrs_rf_unshifted = {
    .name = "rtrs_rf_unshifted",
    .summary = "rtrs_rf with item k naming triangle k",
    .node_bytes = 16,
    .width = 2,
    .order = VISIT_FST,
    .faithful = true,
    .pack = pack_seed,
    .load = load_seed,
    .box = box_seed,
    .item = item_unshifted,
};

/* --- engines ---------------------------------------------------------------------------------- */

/* One traversal by one of the two engines. */
struct made_walk {
    const struct job *job;
    struct tri_ray tri;
    struct slab_ray slab;
    struct slab_rule rule;
    bool last_wins;
    struct hit *best;
    float t; /* of the best, or tmax */
    struct trace_counts *counts;
};

static void walk_leaf(struct made_walk *w, const struct wide *leaf)
{
    const struct packed *packed = w->job->packed;
    float before = w->t;
    for (uint32_t s = 0; s < leaf->item_count; s++) {
        float v[3][3];
        struct hit hit;
        uint32_t prim = packed_item(packed, leaf, s);
        if (prim == ABI_NO_PRIM)
            continue;
        scene_tri(w->job->scene, prim, v);
        w->counts->tris++;
        if (!tri_test_run(w->job->tri->id, &w->tri, v, &hit) ||
            !(hit.t < (w->last_wins ? before : w->t)))
            continue;
        *w->best = hit;
        w->best->prim = prim;
        w->t = hit.t;
    }
}

/* Children in the order of their entries. As deep as the tree, at most ABI_STACK_MAX. */
static void walk_node(struct made_walk *w, uint32_t ref)
{
    struct wide node;
    float entry[2] = {0, 0};
    bool hit[2] = {false, false};
    w->job->packed->layout->load(w->job->packed, ref, &node);
    if (node.child_count == 0) {
        walk_leaf(w, &node);
        return;
    }
    for (uint32_t c = 0; c < 2 && c < node.child_count; c++) {
        w->counts->boxes++;
        hit[c] = slab_by_rule(&w->rule, &w->slab, &node.box[c], w->t, &entry[c]);
    }
    uint32_t first = hit[1] && (!hit[0] || entry[1] < entry[0]);
    if (hit[first])
        walk_node(w, node.child[first]);
    if (hit[1 - first] && entry[1 - first] <= w->t)
        walk_node(w, node.child[1 - first]);
}

static void walk_root(struct made_walk *w)
{
    const struct packed *packed = w->job->packed;
    if (packed->node_count == 0)
        return;
    struct box box = packed->layout->box(packed, packed->root);
    float entry;
    slab_rule_place(&w->rule, &w->slab, &box);
    w->counts->boxes++;
    if (slab_by_rule(&w->rule, &w->slab, &box, w->t, &entry))
        walk_node(w, packed->root);
}

static struct made_walk walk_make(const struct job *job, const struct ray *ray, struct hit *hit,
                                  struct trace_counts *counts)
{
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    return (struct made_walk){.job = job,
                              .tri = tri_ray_make(ray),
                              .slab = slab_ray_make(ray),
                              .rule = slab_rule_of(job->box->id),
                              .best = hit,
                              .t = ray->tmax,
                              .counts = counts};
}

static enum status ray_last_wins(const struct job *job, const struct ray *ray, struct hit *hit,
                                 struct trace_counts *counts)
{
    struct made_walk w = walk_make(job, ray, hit, counts);
    w.last_wins = true;
    walk_root(&w);
    return STATUS_OK;
}

static enum status ray_padded_4u(const struct job *job, const struct ray *ray, struct hit *hit,
                                 struct trace_counts *counts)
{
    struct made_walk w = walk_make(job, ray, hit, counts);
    w.rule = slab_rule_of(ABI_BOX_ROBUST);
    w.rule.plain = false;
    w.rule.far = 1.00000024f;
    walk_root(&w);
    return STATUS_OK;
}

static enum status no_list(const struct job *job, const struct ray *ray, uint32_t capacity,
                           struct hit *hit, uint32_t *count)
{
    (void)job, (void)ray, (void)capacity, (void)hit;
    *count = 0;
    return STATUS_UNSUPPORTED;
}

static enum status open_last_wins(const struct engine *engine, const struct engine_options *options,
                                  void **self, struct reason *reason)
{
    (void)engine;
    return cpu_rays_open(options, ray_last_wins, no_list, self, reason);
}

static enum status open_padded_4u(const struct engine *engine, const struct engine_options *options,
                                  void **self, struct reason *reason)
{
    (void)engine;
    return cpu_rays_open(options, ray_padded_4u, no_list, self, reason);
}

/* The traversal differs from cpu's: where triangles tie, another may win. */
static struct model model_cpu(const struct engine *engine, void *self, const struct tri_test *tri)
{
    struct model model = cpu_rays_model(engine, self, tri);
    model.watertight = false;
    return model;
}

const struct engine engine_last_wins = {
    .name = "last_wins",
    .summary = "cpu, the last accepted triangle of a leaf wins",
    .needs_packed = true,
    .open = open_last_wins,
    .prepare = cpu_rays_prepare,
    .trace = cpu_rays_trace,
    .model = model_cpu,
    .close = cpu_rays_close,
};

const struct engine engine_padded_4u = {
    .name = "padded_4u",
    .summary = "cpu, far planes of boxes times 1.00000024",
    .needs_packed = true,
    .open = open_padded_4u,
    .prepare = cpu_rays_prepare,
    .trace = cpu_rays_trace,
    .model = model_cpu,
    .close = cpu_rays_close,
};

/* The order of work of ref/trace/trace.h once more, in another form: a tree is walked by functions
 * that call themselves, without a stack of nodes. Include after cmocka.h. */
#ifndef TESTS_WALK_BY_CALL_H
#define TESTS_WALK_BY_CALL_H

#include "ref/primitives/test_run.h"
#include "ref/store.h"
#include "ref/trace/trace.h"
#include "ref/world/candidate.h"

#include <string.h>

#define CALLED_ROOM 256 /* of a list */

struct called {
    const struct job *job;
    bool again; /* without a stack: what waits is tested once more */
    struct slab_ray slab;
    struct tri_ray tri;
    float tbest;
    bool ended; /* a hit of QUERY_ANY */
    struct hit best, list[CALLED_ROOM];
    uint32_t found;
    struct trace_counts counts;
    /* In worlds: the instance that a mesh is entered for, and tags of hits. */
    const struct instance_at *at;
    uint32_t tag, tags[CALLED_ROOM];
    /* Of the top: goes through the instances of a leaf; NULL: a leaf has triangles. */
    void (*enter)(struct called *top, const struct wide *leaf);
    float wider; /* how much wider its boxes are */
};

static inline bool called_tri(struct called *w, const struct wide *leaf, uint32_t slot,
                              uint32_t prim, struct hit *out)
{
    const struct packed *packed = w->job->packed;
    const struct tri_store *store = packed->store;
    float v[3][3];
    if (store->test)
        return store->test(packed, leaf->item_first, slot, w->job->tri->id, &w->tri, out);
    if (!store->tri)
        scene_tri(w->job->scene, prim, v);
    else if (!store->tri(packed, leaf->item_first, slot, v))
        return false;
    return tri_test_run(w->job->tri->id, &w->tri, v, out);
}

static inline void called_leaf(struct called *w, const struct wide *leaf)
{
    if (w->enter) {
        w->enter(w, leaf);
        return;
    }
    for (uint32_t slot = 0; slot < leaf->item_count && !w->ended; slot++) {
        struct hit hit;
        uint32_t tag = 0, prim = packed_item(w->job->packed, leaf, slot);
        if (prim >= w->job->scene->tri_count) /* what a layout as published lost */
            continue;
        w->counts.tris++;
        if (!called_tri(w, leaf, slot, prim, &hit))
            continue;
        hit.prim = prim;
        bool nearer = w->best.prim == ABI_NO_PRIM || hit.t < w->best.t;
        if (!nearer || (w->at && !candidate_counts(w->at, w->tri.d, &hit, &tag)))
            continue;
        if (w->job->query == QUERY_ALL) {
            assert_true(w->found < CALLED_ROOM);
            w->tags[w->found] = tag;
            w->list[w->found++] = hit;
            continue;
        }
        w->best = hit;
        w->tbest = hit.t;
        w->tag = tag;
        w->ended = w->job->query == QUERY_ANY;
    }
}

static inline bool called_box(struct called *w, const struct box *box, float *entry)
{
    w->counts.boxes++;
    return box_test_run(w->job->box->id, &w->slab, box, w->tbest, entry);
}

/* As walk_misses: what else a node stores of its child. */
static inline bool called_misses(struct called *w, uint32_t ref, uint32_t child)
{
    const struct packed *packed = w->job->packed;
    struct oblique_ray ray = {.by = w->slab.by, .least = w->slab.tmin * SLAB_NEAR - w->slab.behind};
    memcpy(ray.org, w->slab.o, sizeof ray.org);
    memcpy(ray.dir, w->slab.d, sizeof ray.dir);
    w->counts.boxes += packed->layout->misses != NULL;
    return packed->layout->misses && packed->layout->misses(packed, ref, child, &ray, w->tbest);
}

/* A node whose box was entered at `entry`, unless there is something nearer by now. */
static inline void called_node(struct called *w, uint32_t ref);

static inline void called_later(struct called *w, uint32_t ref, const struct box *box, float entry)
{
    float now;
    if (w->ended || (w->again && !called_box(w, box, &now)))
        return;
    if (w->again || w->job->box->id == ABI_BOX_RTRS || entry <= w->tbest)
        called_node(w, ref);
}

static inline void called_node(struct called *w, uint32_t ref)
{
    const struct packed *packed = w->job->packed;
    struct wide node;
    float entry[WIDE_MAX];
    uint32_t order[WIDE_MAX], hit = 0;
    packed->layout->load(packed, ref, &node);
    if (node.child_count == 0) {
        called_leaf(w, &node);
        return;
    }
    for (uint32_t i = 0; i < node.child_count; i++)
        if (called_box(w, &node.box[i], &entry[i]) && !called_misses(w, ref, node.child[i]))
            order[hit++] = i;
    const bool near = layout_is_wide(packed->layout) || packed->layout->order == VISIT_NEAR;
    for (uint32_t i = 0; i < hit; i++) /* those of equal distance stay in order */
        for (uint32_t k = i; near && k > 0 && entry[order[k]] < entry[order[k - 1]]; k--) {
            uint32_t other = order[k];
            order[k] = order[k - 1];
            order[k - 1] = other;
        }
    if (packed->layout->order == VISIT_SND && !near && hit == 2)
        order[0] = 1, order[1] = 0;
    for (uint32_t i = 0; i < hit; i++)
        if (i == 0 && !layout_is_wide(packed->layout))
            called_node(w, node.child[order[0]]);
        else
            called_later(w, node.child[order[i]], &node.box[order[i]], entry[order[i]]);
}

/* Walks a tree, with the hits that there are by now. */
static inline void called_tree(struct called *w, const struct job *job, const struct ray *ray)
{
    const struct packed *packed = job->packed;
    w->job = job;
    w->slab = slab_ray_make(ray);
    w->tri = tri_ray_make(ray);
    if (packed->node_count == 0)
        return;
    struct box root = packed->layout->box(packed, packed->root);
    float entry;
    slab_ray_widen(&w->slab, w->wider);
    slab_ray_place(&w->slab, &root);
    if (called_box(w, &root, &entry))
        called_node(w, packed->root);
}

/* Walks the whole tree of a job for one ray. */
static inline void walk_by_call(const struct job *job, const struct ray *ray, struct called *w)
{
    *w = (struct called){.again = job->parent, .best = hit_none(), .tbest = ray->tmax};
    called_tree(w, job, ray);
}

#endif

/* The reference traversal of one tree, and its steps: a triangle, a leaf, an inner node, the way
 * back. For ref/trace/trace.c and ref/trace/trace_world.c. */
#ifndef TRACE_WALK_H
#define TRACE_WALK_H

#include "ref/world/candidate.h"
#include "ref/trace/trace.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

/* What a walk goes through. It is a constant wherever it is passed. */
enum walk_level {
    WALK_SCENE,  /* the tree of a scene: every triangle that is hit counts */
    WALK_TOP,    /* the top of a world: items are instances */
    WALK_BOTTOM, /* the tree of a mesh, entered from the top */
};

#define WALK_INLINE static inline __attribute__((always_inline))

/* One traversal in progress. */
struct walk {
    const struct packed *packed;
    const struct tri_store *store; /* the tree's */
    bool stored;                   /* it has the triangles; else they are the scene's */
    bool listed;                   /* items are listed by their numbers, as `indexed` does */
    const struct scene *scene;
    const struct wide *decoded; /* all nodes, or NULL: each is decoded when it is visited */
    enum query query;
    struct slab_ray slab;
    struct tri_ray tri;
    struct hit best;
    float tbest;
    const uint32_t *parent; /* packed_links of a stackless walk, or NULL */
    uint64_t trail;         /* of it: bit i: i levels up the other child waits */
    uint32_t depth;         /* entries on the stack, or bits of the trail */
    uint32_t ref[ABI_STACK_WIDE];
    float entry[ABI_STACK_WIDE];
    struct trace_counts counts;
    struct hit *list; /* QUERY_ALL: the first `capacity` of the hits found */
    uint32_t capacity, found;
    /* WALK_TOP: goes through the instances of a leaf; returns as walk_leaf. */
    bool (*enter)(struct walk *top, const struct wide *leaf);
    /* WALK_BOTTOM: the instance that was entered, the tag of the best hit, those of the list. */
    const struct instance_at *at;
    uint32_t tag;
    uint32_t *tags;
};

/* Sets the tree of a walk. `scene` has its triangles. */
static inline void walk_set_tree(struct walk *w, const struct packed *packed,
                                 const struct scene *scene)
{
    w->packed = packed;
    w->store = packed->store;
    w->stored = !tri_store_reads_scene(packed->store);
    w->listed = !packed->layout->item && packed->store->id == ABI_STORE_INDEXED;
    w->scene = scene;
}

/* Starts a walk without a hit. */
static inline void walk_set_ray(struct walk *w, const struct ray *ray)
{
    w->slab = slab_ray_make(ray);
    w->tri = tri_ray_make(ray);
    w->best = hit_none();
    w->tbest = ray->tmax;
    w->depth = 0;
}

/* Tests triangle `prim`, which is item `slot` of the leaf, as the storage has it. */
static inline bool walk_test(const struct walk *w, uint32_t tri_id, const struct wide *leaf,
                             uint32_t slot, uint32_t prim, struct hit *out)
{
    const struct packed *packed = w->packed;
    float v[3][3];
    if (!w->stored)
        scene_tri(w->scene, prim, v);
    else if (w->store->test)
        return w->store->test(packed, leaf->item_first, slot, tri_id, &w->tri, out);
    else if (!w->store->tri(packed, leaf->item_first, slot, v))
        return false;
    return tri_test_run(tri_id, &w->tri, v, out);
}

/* Keeps `prim` if it is hit nearer than the best; at equal t the first found stays. QUERY_ALL lists
 * it, and the ray keeps its length. In a world it must count as well. */
WALK_INLINE bool walk_triangle(struct walk *w, enum walk_level level, uint32_t tri_id,
                               const struct wide *leaf, uint32_t slot, uint32_t prim)
{
    struct hit hit;
    uint32_t tag = 0;
    w->counts.tris++;
    if (!walk_test(w, tri_id, leaf, slot, prim, &hit) ||
        (w->best.prim != ABI_NO_PRIM && !(hit.t < w->best.t)))
        return false;
    hit.prim = prim;
    if (level == WALK_BOTTOM && !candidate_counts(w->at, w->tri.d, &hit, &tag))
        return false;
    if (w->query == QUERY_ALL) {
        if (w->found < w->capacity) {
            w->list[w->found] = hit;
            if (level == WALK_BOTTOM)
                w->tags[w->found] = tag;
        }
        w->found++;
        return true;
    }
    w->best = hit;
    w->tbest = hit.t;
    if (level == WALK_BOTTOM)
        w->tag = tag;
    return true;
}

/* As packed_item; the usual storage's without a call. */
static inline uint32_t walk_item(const struct walk *w, const struct wide *leaf, uint32_t slot)
{
    const struct packed *packed = w->packed;
    uint32_t at = leaf->item_first + slot;
    if (!w->listed)
        return packed_item(packed, leaf, slot);
    return at < packed->item_count ? packed->item[at] : ABI_NO_PRIM;
}

/* Returns true if the query is answered. */
WALK_INLINE bool walk_leaf(struct walk *w, enum walk_level level, uint32_t tri_id,
                           const struct wide *node)
{
    if (level == WALK_TOP)
        return w->enter(w, node);
    for (uint32_t i = 0; i < node->item_count; i++) {
        uint32_t prim = walk_item(w, node, i);
        if (prim < w->scene->tri_count && walk_triangle(w, level, tri_id, node, i, prim) &&
            w->query == QUERY_ANY)
            return true;
    }
    return false;
}

/* One level down in a stackless walk. Returns false if the trail is full. */
static inline bool walk_down(struct walk *w, bool other_waits)
{
    if (w->depth >= ABI_STACK_MAX)
        return false;
    w->trail = w->trail << 1 | other_waits;
    w->depth++;
    return true;
}

/* Up to the next child that waits and can still hold something nearer. Its box is tested again,
 * which has the result of an entry distance on a stack: it met the ray before, and only tbest is
 * new. */
static inline bool walk_up(struct walk *w, uint32_t box_id, uint32_t ref, uint32_t *next)
{
    while (w->depth > 0) {
        uint32_t parent = w->parent[ref];
        if (!(w->trail & 1)) {
            w->trail >>= 1;
            w->depth--;
            ref = parent;
            continue;
        }
        struct wide node;
        float entry;
        w->packed->layout->load(w->packed, parent, &node);
        uint32_t other = node.child[0] == ref ? 1 : 0;
        w->trail ^= 1;
        w->counts.boxes++;
        *next = node.child[other];
        if (box_test_run(box_id, &w->slab, &node.box[other], w->tbest, &entry))
            return true;
    }
    return false;
}

/* Chooses the next node of two children: *next, or *any = false if none is hit. Pushes the one that
 * waits. Returns false if the stack is full. */
static inline bool walk_inner(struct walk *w, uint32_t box_id, const struct wide *node,
                              uint32_t *next, bool *any)
{
    bool hit[2] = {false, false};
    float entry[2] = {0, 0};
    for (uint32_t i = 0; i < node->child_count; i++) {
        hit[i] = box_test_run(box_id, &w->slab, &node->box[i], w->tbest, &entry[i]);
        w->counts.boxes++;
    }
    *any = hit[0] || hit[1];
    if (!(hit[0] && hit[1])) {
        *next = node->child[hit[1] ? 1 : 0];
        return !w->parent || !*any || walk_down(w, false);
    }
    int first = 0;
    if (w->packed->layout->order == VISIT_NEAR)
        first = entry[1] < entry[0] ? 1 : 0;
    else if (w->packed->layout->order == VISIT_SND)
        first = 1;
    if (w->parent) {
        *next = node->child[first];
        return walk_down(w, true);
    }
    if (w->depth >= w->packed->stack_need || w->depth >= ABI_STACK_MAX)
        return false;
    w->ref[w->depth] = node->child[1 - first];
    w->entry[w->depth++] = entry[1 - first];
    *next = node->child[first];
    return true;
}

/* True if the node `ref` stores that the ray meets nothing below a child whose box it meets. The
 * allowance on the near side is that of slab_watertight. */
static inline bool walk_misses(struct walk *w, uint32_t ref, uint32_t child)
{
    const struct slab_ray *s = &w->slab;
    if (!w->packed->layout->misses)
        return false;
    const struct oblique_ray ray = {.org = {s->o[0], s->o[1], s->o[2]},
                                    .dir = {s->d[0], s->d[1], s->d[2]},
                                    .by = s->by,
                                    .least = s->tmin * SLAB_NEAR - s->behind};
    w->counts.boxes++;
    return w->packed->layout->misses(w->packed, ref, child, &ray, w->tbest);
}

/* Pushes the children of a wide node that are hit, the nearest last; of equal ones the first child
 * counts as nearer. Returns false if the stack is full. */
static inline bool walk_wide(struct walk *w, uint32_t box_id, uint32_t ref, const struct wide *node)
{
    uint32_t base = w->depth;
    for (uint32_t i = 0; i < node->child_count; i++) {
        float entry;
        w->counts.boxes++;
        if (!box_test_run(box_id, &w->slab, &node->box[i], w->tbest, &entry) ||
            walk_misses(w, ref, node->child[i]))
            continue;
        if (w->depth >= w->packed->stack_need || w->depth >= ABI_STACK_WIDE)
            return false;
        uint32_t at = w->depth++;
        for (; at > base && w->entry[at - 1] <= entry; at--) {
            w->entry[at] = w->entry[at - 1];
            w->ref[at] = w->ref[at - 1];
        }
        w->entry[at] = entry;
        w->ref[at] = node->child[i];
    }
    return true;
}

/* Pops the next node that can still hold something nearer. */
static inline bool walk_pop(struct walk *w, uint32_t box_id, uint32_t *next)
{
    while (w->depth > 0) {
        w->depth--;
        *next = w->ref[w->depth];
        if (box_id == ABI_BOX_RTRS || w->entry[w->depth] <= w->tbest)
            return true;
    }
    return false;
}

/* The whole walk. Inlined where the tests are known, so that each pair of them has its own loop:
 * fuzzing spends most of its time here. */
WALK_INLINE enum status walk_tree(struct walk *w, enum walk_level level, uint32_t box_id,
                                  uint32_t tri_id)
{
    const struct packed *packed = w->packed;
    float entry;
    if (packed->node_count == 0)
        return STATUS_OK;
    struct box root = packed->layout->box(packed, packed->root);
    slab_ray_place(&w->slab, &root);
    w->counts.boxes++;
    if (!box_test_run(box_id, &w->slab, &root, w->tbest, &entry))
        return STATUS_OK;
    uint32_t ref = packed->root;
    /* In a tree no node is visited twice: more visits than nodes is a cycle. */
    for (uint32_t visits = 0; visits < packed->ref_count; visits++) {
        struct wide loaded;
        const struct wide *node = w->decoded ? &w->decoded[ref] : &loaded;
        bool descend = false;
        uint32_t next = 0;
        if (!w->decoded)
            packed->layout->load(packed, ref, &loaded);
        if (node->child_count == 0) {
            if (walk_leaf(w, level, tri_id, node))
                return STATUS_OK;
        } else if (layout_is_wide(packed->layout) ? !walk_wide(w, box_id, ref, node)
                                                  : !walk_inner(w, box_id, node, &next, &descend)) {
            return STATUS_LIMIT;
        }
        if (!descend && !(w->parent ? walk_up(w, box_id, ref, &next) : walk_pop(w, box_id, &next)))
            return STATUS_OK;
        ref = next;
    }
    return STATUS_LIMIT;
}

#endif

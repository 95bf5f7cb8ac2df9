#include "ref/trace.h"

#include <stdlib.h>
#include <string.h>

/* One traversal in progress. */
struct walk {
    const struct packed *packed;
    const struct tri_store *store; /* the tree's */
    const struct scene *scene;
    const struct wide *decoded; /* all nodes, or NULL: each is decoded when it is visited */
    enum query query;
    struct slab_ray slab;
    struct tri_ray tri;
    struct hit best;
    float tbest;
    uint32_t depth; /* entries on the stack */
    uint32_t ref[ABI_STACK_WIDE];
    float entry[ABI_STACK_WIDE];
    struct trace_counts counts;
    struct hit *list; /* QUERY_ALL: the first `capacity` of the hits found */
    uint32_t capacity, found;
};

/* Tests triangle `prim`, which is item `slot` of the leaf, as the storage has it. */
static inline bool walk_test(const struct walk *w, uint32_t tri_id, const struct wide *leaf,
                             uint32_t slot, uint32_t prim, struct hit *out)
{
    const struct packed *packed = w->packed;
    float v[3][3];
    if (w->store->test)
        return w->store->test(packed, leaf->item_first, slot, tri_id, &w->tri, out);
    if (!w->store->tri)
        scene_tri(w->scene, prim, v);
    else if (!w->store->tri(packed, leaf->item_first, slot, v))
        return false;
    return tri_test_run(tri_id, &w->tri, v, out);
}

/* Keeps `prim` if it is hit nearer than the best; at equal t the first found stays. QUERY_ALL lists
 * it, and the ray keeps its length. */
static inline bool walk_triangle(struct walk *w, uint32_t tri_id, const struct wide *leaf,
                                 uint32_t slot, uint32_t prim)
{
    struct hit hit;
    w->counts.tris++;
    if (!walk_test(w, tri_id, leaf, slot, prim, &hit))
        return false;
    hit.prim = prim;
    if (w->query == QUERY_ALL) {
        if (w->found < w->capacity)
            w->list[w->found] = hit;
        w->found++;
#if MUTANT == MUTANT_CULLED_ALL
        w->tbest = hit.t < w->tbest ? hit.t : w->tbest;
#endif
        return true;
    }
#if MUTANT == MUTANT_FIRST_HIT_KEPT
    if (w->best.prim != ABI_NO_PRIM)
        return false;
#elif MUTANT == MUTANT_LATER_WINS
    if (w->best.prim != ABI_NO_PRIM && !(hit.t <= w->best.t))
        return false;
#else
    if (w->best.prim != ABI_NO_PRIM && !(hit.t < w->best.t))
        return false;
#endif
    w->best = hit;
    w->tbest = hit.t;
    return true;
}

/* Returns true if the query is answered. */
static inline bool walk_leaf(struct walk *w, uint32_t tri_id, const struct wide *node)
{
    for (uint32_t i = 0; i < node->item_count; i++) {
        uint32_t prim = packed_item(w->packed, node, i);
#if MUTANT == MUTANT_LAST_IS_EMPTY
        if (prim + 1 == w->scene->tri_count)
            continue;
#endif
        if (prim < w->scene->tri_count && walk_triangle(w, tri_id, node, i, prim) &&
            w->query == QUERY_ANY)
            return true;
#if MUTANT == MUTANT_ANY_FIRST_ITEM
        if (w->query == QUERY_ANY)
            return false;
#elif MUTANT == MUTANT_ANY_TOO_EARLY
        if (w->query == QUERY_ANY)
            return true;
#endif
    }
    return false;
}

/* Chooses the next node among two children: *next, or *any = false if none is hit. Pushes the one
 * that waits. Returns false if the stack is full. */
static inline bool walk_inner(struct walk *w, uint32_t box_id, const struct wide *node,
                              uint32_t *next, bool *any)
{
    bool hit[2] = {false, false};
    float entry[2] = {0, 0};
    for (uint32_t i = 0; i < node->child_count; i++) {
        hit[i] = box_test_run(box_id, &w->slab, &node->box[i], w->tbest, &entry[i]);
        w->counts.boxes++;
    }
#if MUTANT == MUTANT_EQUAL_ENTRY_LOST
    hit[1] = hit[1] && (!hit[0] || entry[0] != entry[1]);
#endif
    *any = hit[0] || hit[1];
    if (!(hit[0] && hit[1])) {
        *next = node->child[hit[1] ? 1 : 0];
        return true;
    }
    int first = 0;
    if (w->packed->layout->order == VISIT_NEAR)
        first = entry[1] < entry[0] ? 1 : 0;
    else if (w->packed->layout->order == VISIT_SND)
        first = 1;
    if (w->depth >= w->packed->stack_need || w->depth >= ABI_STACK_MAX)
        return false;
#if MUTANT == MUTANT_SWAPPED_CHILD
    w->ref[w->depth] = node->child[first];
#elif MUTANT == MUTANT_STACK_WRAPPED
    w->ref[w->depth % 4] = node->child[1 - first];
#else
    w->ref[w->depth] = node->child[1 - first];
#endif
    w->entry[w->depth++] = entry[1 - first];
    *next = node->child[first];
    return true;
}

/* Pushes the children of a wide node that are hit, the nearest last; of equal ones the first child
 * is taken for nearer. Returns false if the stack is full. */
static inline bool walk_wide(struct walk *w, uint32_t box_id, const struct wide *node)
{
    uint32_t base = w->depth;
    for (uint32_t i = 0; i < node->child_count; i++) {
        float entry;
        w->counts.boxes++;
        if (!box_test_run(box_id, &w->slab, &node->box[i], w->tbest, &entry))
            continue;
        if (w->depth >= w->packed->stack_need || w->depth >= ABI_STACK_WIDE)
            return false;
        uint32_t at = w->depth++;
        for (; at > base && w->entry[at - 1] <= entry; at--) {
            w->entry[at] = w->entry[at - 1];
            w->ref[at] = w->ref[at - 1];
        }
#if MUTANT == MUTANT_WIDE_UNSORTED
        at = w->depth - 1;
#endif
        w->entry[at] = entry;
        w->ref[at] = node->child[i];
    }
#if MUTANT == MUTANT_WIDE_ONE_LOST
    if (w->depth - base == 5)
        w->depth--;
#endif
    return true;
}

/* Pops the next node that can still hold something nearer. */
static inline bool walk_pop(struct walk *w, uint32_t box_id, uint32_t *next)
{
#if MUTANT == MUTANT_BOTTOM_UNREAD
    while (w->depth > 1) {
#else
    while (w->depth > 0) {
#endif
        w->depth--;
#if MUTANT == MUTANT_STACK_WRAPPED
        *next = w->ref[w->depth % 4];
#else
        *next = w->ref[w->depth];
#endif
#if MUTANT == MUTANT_POP_STRICT
        if (box_id == ABI_BOX_RTRS || w->entry[w->depth] < w->tbest)
#else
        if (box_id == ABI_BOX_RTRS || w->entry[w->depth] <= w->tbest)
#endif
            return true;
    }
    return false;
}

/* The whole walk. Inlined where the tests are known, so that each pair of them has a loop of its
 * own: fuzzing spends most of its time here. */
static inline __attribute__((always_inline)) enum status walk_tree(struct walk *w, uint32_t box_id,
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
            if (walk_leaf(w, tri_id, node))
                return STATUS_OK;
        } else if (layout_is_wide(packed->layout) ? !walk_wide(w, box_id, node)
                                                  : !walk_inner(w, box_id, node, &next, &descend)) {
            return STATUS_LIMIT;
        }
        if (!descend && !walk_pop(w, box_id, &next))
            return STATUS_OK;
        ref = next;
    }
    return STATUS_LIMIT;
}

static enum status walk_robust(struct walk *w, uint32_t tri_id)
{
    if (tri_id == ABI_TRI_WOOP)
        return walk_tree(w, ABI_BOX_ROBUST, ABI_TRI_WOOP);
    return walk_tree(w, ABI_BOX_ROBUST, tri_id);
}

static enum status walk_watertight(struct walk *w, uint32_t tri_id)
{
    if (tri_id == ABI_TRI_WOOP)
        return walk_tree(w, ABI_BOX_WATERTIGHT, ABI_TRI_WOOP);
    return walk_tree(w, ABI_BOX_WATERTIGHT, tri_id);
}

static enum status walk_with(struct walk *w, const struct box_test *box, const struct tri_test *tri)
{
    if (box->id == ABI_BOX_ROBUST)
        return walk_robust(w, tri->id);
    if (box->id == ABI_BOX_WATERTIGHT)
        return walk_watertight(w, tri->id);
    return walk_tree(w, box->id, tri->id);
}

static void walk_start(struct walk *w, const struct packed *packed, const struct wide *decoded,
                       const struct scene *scene, enum query query, const struct ray *ray)
{
#if MUTANT == MUTANT_TRACER_DIES || MUTANT == MUTANT_TRACER_HANGS
    for (volatile int again = 1; again && ray->tmax != ray->tmax;)
        if (MUTANT == MUTANT_TRACER_DIES)
            __builtin_trap();
#endif
    w->packed = packed;
    w->store = packed->store;
    w->decoded = decoded;
    w->scene = scene;
    w->query = query;
    w->slab = slab_ray_make(ray);
    w->tri = tri_ray_make(ray);
    w->best = (struct hit){.prim = ABI_NO_PRIM};
    w->tbest = ray->tmax;
    w->depth = 0;
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

enum status trace_ray(const struct packed *packed, const struct scene *scene,
                      const struct box_test *box, const struct tri_test *tri, enum query query,
                      const struct ray *ray, struct hit *out, struct trace_counts *counts)
{
    struct walk w;
    walk_start(&w, packed, NULL, scene, query, ray);
    enum status status = walk_with(&w, box, tri);
    *out = status ? (struct hit){.prim = ABI_NO_PRIM} : w.best;
    walk_count(&w, counts);
    return status;
}

static uint32_t at_most(uint64_t count)
{
    return count < 0xFFFF ? (uint32_t)count : 0xFFFF;
}

enum status trace_rays(const struct packed *packed, const struct scene *scene,
                       const struct box_test *box, const struct tri_test *tri, enum query query,
                       const struct ray *ray, size_t count, struct hit *out, uint32_t *flag,
                       uint32_t *work)
{
    struct wide *decoded = NULL;
    enum status status = STATUS_OK;
    /* Without memory, or if it does not pay, each ray decodes what it visits. */
    if (packed->node_count > 0 && packed->ref_count <= count)
        decoded = malloc(packed->ref_count * sizeof *decoded);
    for (uint32_t i = 0; i < packed->ref_count && decoded; i++)
        packed->layout->load(packed, i, &decoded[i]);
    for (size_t i = 0; i < count; i++) {
        struct walk w;
        walk_start(&w, packed, decoded, scene, query, &ray[i]);
        bool finished = walk_with(&w, box, tri) == STATUS_OK;
        out[i] = finished ? w.best : (struct hit){.prim = ABI_NO_PRIM};
        flag[i] = finished ? ABI_FLAG_DONE : ABI_FLAG_EXHAUSTED;
        if (work)
            work[i] = at_most(w.counts.boxes) << 16 | at_most(w.counts.tris);
        status = finished ? status : STATUS_LIMIT;
    }
    free(decoded);
    return status;
}

enum status trace_ray_all(const struct packed *packed, const struct scene *scene,
                          const struct box_test *box, const struct tri_test *tri,
                          const struct ray *ray, uint32_t capacity, struct hit *out,
                          uint32_t *count, struct trace_counts *counts)
{
    struct walk w;
    walk_start(&w, packed, NULL, scene, QUERY_ALL, ray);
    w.list = out;
    w.capacity = capacity;
    enum status status = walk_with(&w, box, tri);
    *count = status ? 0 : w.found;
    walk_count(&w, counts);
    return status;
}

void trace_brute(const struct scene *scene, const struct tri_test *tri, enum query query,
                 const struct ray *ray, struct hit *out)
{
    struct tri_ray r = tri_ray_make(ray);
    *out = (struct hit){.prim = ABI_NO_PRIM};
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

#include "ref/trace.h"

#include <string.h>

/* One traversal in progress. */
struct walk {
    const struct packed *packed;
    const struct scene *scene;
    uint32_t box_id, tri_id;
    enum query query;
    struct slab_ray slab;
    struct tri_ray tri;
    struct hit best;
    float tbest;
    uint32_t depth; /* entries on the stack */
    uint32_t ref[ABI_STACK_MAX];
    float entry[ABI_STACK_MAX];
    struct trace_counts counts;
    struct hit *list; /* QUERY_ALL: the first `capacity` of the hits found */
    uint32_t capacity, found;
};

/* Keeps `prim` if it is hit nearer than the best; at equal t the first found stays. QUERY_ALL lists
 * it, and the ray keeps its length. */
static bool walk_triangle(struct walk *w, uint32_t prim)
{
    float v[3][3];
    struct hit hit;
    scene_tri(w->scene, prim, v);
    w->counts.tris++;
    if (!tri_test_run(w->tri_id, &w->tri, v, &hit))
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
    if (w->best.prim != ABI_NO_PRIM && !(hit.t < w->best.t))
        return false;
    w->best = hit;
    w->tbest = hit.t;
    return true;
}

/* Returns true if the query is answered. */
static bool walk_leaf(struct walk *w, const struct wide *node)
{
    for (uint32_t i = 0; i < node->item_count; i++) {
        uint32_t prim = w->packed->layout->item(w->packed, node->item_first + i);
        if (prim < w->scene->tri_count && walk_triangle(w, prim) && w->query == QUERY_ANY)
            return true;
    }
    return false;
}

/* Chooses the next node among the children: *next, or *any = false if none is hit. Pushes the one
 * that waits. Only binary nodes are known here. Returns false if the stack is full. */
static bool walk_inner(struct walk *w, const struct wide *node, uint32_t *next, bool *any)
{
    bool hit[2] = {false, false};
    float entry[2] = {0, 0};
    for (uint32_t i = 0; i < node->child_count; i++) {
        hit[i] = box_test_run(w->box_id, &w->slab, &node->box[i], w->tbest, &entry[i]);
        w->counts.boxes++;
    }
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
#else
    w->ref[w->depth] = node->child[1 - first];
#endif
    w->entry[w->depth++] = entry[1 - first];
    *next = node->child[first];
    return true;
}

/* Pops the next node that can still hold something nearer. */
static bool walk_pop(struct walk *w, uint32_t *next)
{
    while (w->depth > 0) {
        w->depth--;
        *next = w->ref[w->depth];
        if (w->box_id == ABI_BOX_RTRS || w->entry[w->depth] <= w->tbest)
            return true;
    }
    return false;
}

static enum status walk_tree(struct walk *w)
{
    const struct packed *packed = w->packed;
    float entry;
    if (packed->node_count == 0)
        return STATUS_OK;
    struct box root = packed->layout->box(packed, packed->root);
    slab_ray_place(&w->slab, &root);
    w->counts.boxes++;
    if (!box_test_run(w->box_id, &w->slab, &root, w->tbest, &entry))
        return STATUS_OK;
    uint32_t ref = packed->root;
    /* In a tree no node is visited twice: more visits than nodes is a cycle. */
    for (uint32_t visits = 0; visits < packed->node_count; visits++) {
        struct wide node;
        bool descend = false;
        uint32_t next = 0;
        packed->layout->load(packed, ref, &node);
        if (node.child_count == 0) {
            if (walk_leaf(w, &node))
                return STATUS_OK;
        } else if (!walk_inner(w, &node, &next, &descend)) {
            return STATUS_LIMIT;
        }
        if (!descend && !walk_pop(w, &next))
            return STATUS_OK;
        ref = next;
    }
    return STATUS_LIMIT;
}

static void walk_start(struct walk *w, const struct packed *packed, const struct scene *scene,
                       const struct box_test *box, const struct tri_test *tri, enum query query,
                       const struct ray *ray)
{
    w->packed = packed;
    w->scene = scene;
    w->box_id = box->id;
    w->tri_id = tri->id;
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
    walk_start(&w, packed, scene, box, tri, query, ray);
    enum status status = walk_tree(&w);
    *out = status ? (struct hit){.prim = ABI_NO_PRIM} : w.best;
    walk_count(&w, counts);
    return status;
}

enum status trace_ray_all(const struct packed *packed, const struct scene *scene,
                          const struct box_test *box, const struct tri_test *tri,
                          const struct ray *ray, uint32_t capacity, struct hit *out,
                          uint32_t *count, struct trace_counts *counts)
{
    struct walk w;
    walk_start(&w, packed, scene, box, tri, QUERY_ALL, ray);
    w.list = out;
    w.capacity = capacity;
    enum status status = walk_tree(&w);
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

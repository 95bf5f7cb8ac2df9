/* Rays through a k-d tree: front to back, with a stack.
 *
 * A ray meets a node's voxel in a range [tn, tf] of t, which contains the exact one. Proof. A
 * plane's distance (s - o) / d is computed by a difference, a reciprocal and a product, each off by
 * u at most, so by 3.01 u of itself; with KD_PAD, 8 u, of it less (below) or more (above), and that
 * rounded, the exact one is between both. A node is entered where the range that it is left with
 * is not empty, so that every point of the exact ray that lies in a voxel (closed: with its planes)
 * is in the range that is computed for it. A plane that is parallel to the ray is decided by
 * comparison, and one that the ray lies in has the ray on both sides.
 *
 * A node that waits is left out if the best hit is nearer than the range of that node: all that
 * lies in its voxel is farther. So a hit ends the ray only where it lies in the voxel at hand or in
 * one before it, which holds by the same margin. What products lose below the normal range is far
 * below the least t that is judged (ref/judge/judge_lost.c). */
#include "ref/kd/kd.h"

#include "ref/primitives/slab.h"

#define KD_PAD 0x1p-21f /* 8 u */

enum kd_query { KD_CLOSEST, KD_ANY, KD_ALL, KD_WATCHED };

struct kd_waiting {
    uint32_t node;
    float tn, tf;
};

struct kd_walk {
    const struct kd_tree *tree;
    struct slab_ray ray;
    float tmax;
    struct hit best;
    struct kd_list *list;
    kd_read_fn *read; /* of KD_WATCHED, as `reader` */
    void *reader;
    struct kd_counts counts;
    uint32_t depth; /* of the stack */
    struct kd_waiting waiting[KD_DEPTH_MOST];
};

static inline float below(float t)
{
    return t - (t < 0.0f ? -t : t) * KD_PAD;
}

static inline float above(float t)
{
    return t + (t < 0.0f ? -t : t) * KD_PAD;
}

static inline float later(float a, float b)
{
    return a > b ? a : b;
}

static inline float sooner(float a, float b)
{
    return a < b ? a : b;
}

/* The range of the ray in the root's voxel; false if it is empty. */
static inline bool enter(const struct kd_walk *w, float *tn, float *tf)
{
    const struct slab_ray *r = &w->ray;
    const struct box *box = &w->tree->box;
    *tn = r->tmin;
    *tf = w->tmax;
    for (int k = 0; k < 3; k++) {
        if (r->parallel[k]) {
            if (!(r->o[k] >= box->lo[k] && r->o[k] <= box->hi[k]))
                return false;
            continue;
        }
        float first = r->d[k] < 0.0f ? box->hi[k] : box->lo[k];
        float last = r->d[k] < 0.0f ? box->lo[k] : box->hi[k];
        *tn = later(*tn, below((first - r->o[k]) * r->inv[k]));
        *tf = sooner(*tf, above((last - r->o[k]) * r->inv[k]));
    }
    return *tn <= *tf;
}

/* Goes to the children of an inner node that the ray meets: `at` becomes the nearer one, the other
 * waits. False if it meets neither. */
static inline bool descend(struct kd_walk *w, const struct kd_node *node, struct kd_waiting *at)
{
    const struct slab_ray *r = &w->ray;
    uint32_t k = node->what & 3u, left = node->what >> 2;
    uint32_t near = left + (r->d[k] < 0.0f), far = left + !(r->d[k] < 0.0f);
    struct kd_waiting one = {near, at->tn, at->tf}, two = {far, at->tn, at->tf};
    bool first, second;
    if (r->parallel[k]) {
        one.node = left;
        two.node = left + 1;
        first = r->o[k] <= node->at;
        second = r->o[k] >= node->at;
    } else {
        float t = (node->at - r->o[k]) * r->inv[k];
        one.tf = sooner(at->tf, above(t));
        two.tn = later(at->tn, below(t));
        first = one.tn <= one.tf;
        second = two.tn <= two.tf;
    }
    if (first && second)
        w->waiting[w->depth++] = two;
    *at = first ? one : two;
    return first || second;
}

/* Tests the triangles of a leaf; true if that ends the ray. */
static inline bool test_leaf(struct kd_walk *w, const struct kd_node *node, enum kd_query query)
{
    const struct kd_tree *tree = w->tree;
    uint32_t count = node->what >> 2;
    w->counts.leaves++;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *item = &tree->item[node->first + i];
        const struct tri_accel *tri = &tree->tri[*item];
        struct hit hit;
        w->counts.tris++;
        if (query == KD_WATCHED) {
            w->read(w->reader, KD_READ_ITEM, item - tree->item, sizeof *item);
            w->read(w->reader, KD_READ_TRI, tri - tree->tri, sizeof *tri);
        }
        if (!tri_accel_hit(tri, w->ray.o, w->ray.d, w->ray.tmin, w->tmax, &hit))
            continue;
        if (query == KD_ALL) {
            struct kd_list *list = w->list;
            if (array_reserve(&list->hit, &list->capacity, list->count + 1, sizeof *list->hit))
                return true;
            list->hit[list->count++] = hit;
        } else if (w->best.prim == ABI_NO_PRIM || hit.t < w->best.t) {
            w->best = hit;
        }
        if (query == KD_ANY)
            return true;
    }
    return false;
}

/* The next node that waits and may have something nearer; false if there is none. */
static inline bool resume(struct kd_walk *w, struct kd_waiting *at)
{
    while (w->depth > 0) {
        *at = w->waiting[--w->depth];
        if (w->best.prim == ABI_NO_PRIM || at->tn <= w->best.t)
            return true;
    }
    return false;
}

/* False if a list found no memory. */
static inline bool walk(struct kd_walk *w, const struct kd_tree *tree, const struct ray *ray,
                        enum kd_query query)
{
    struct kd_waiting at = {0, 0.0f, 0.0f};
    w->tree = tree;
    w->ray = slab_ray_make(ray);
    w->tmax = ray->tmax;
    w->best = (struct hit){.prim = ABI_NO_PRIM};
    w->counts = (struct kd_counts){0};
    w->depth = 0;
    bool more = tree->node_count > 0 && enter(w, &at.tn, &at.tf);
    while (more) {
        const struct kd_node *node = &tree->node[at.node];
        if (query == KD_WATCHED)
            w->read(w->reader, KD_READ_NODE, at.node, sizeof *node);
        if ((node->what & 3u) != KD_LEAF) {
            w->counts.planes++;
            more = descend(w, node, &at) || resume(w, &at);
        } else if (test_leaf(w, node, query)) {
            return query == KD_ANY;
        } else {
            more = resume(w, &at);
        }
    }
    return true;
}

static void count(const struct kd_walk *w, struct kd_counts *counts)
{
    counts->planes += w->counts.planes;
    counts->tris += w->counts.tris;
    counts->leaves += w->counts.leaves;
}

struct hit kd_closest(const struct kd_tree *tree, const struct ray *ray, struct kd_counts *counts)
{
    struct kd_walk w;
    (void)walk(&w, tree, ray, KD_CLOSEST);
    count(&w, counts);
    return w.best;
}

struct hit kd_any(const struct kd_tree *tree, const struct ray *ray, struct kd_counts *counts)
{
    struct kd_walk w;
    (void)walk(&w, tree, ray, KD_ANY);
    count(&w, counts);
    return w.best;
}

enum status kd_all(const struct kd_tree *tree, const struct ray *ray, struct kd_list *list,
                   struct kd_counts *counts)
{
    struct kd_walk w;
    w.list = list;
    list->count = 0;
    bool whole = walk(&w, tree, ray, KD_ALL);
    count(&w, counts);
    return whole ? STATUS_OK : STATUS_MEMORY;
}

struct hit kd_watched(const struct kd_tree *tree, const struct ray *ray, kd_read_fn *read,
                      void *reader)
{
    struct kd_walk w;
    w.read = read;
    w.reader = reader;
    (void)walk(&w, tree, ray, KD_WATCHED);
    return w.best;
}

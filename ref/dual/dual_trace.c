/* Rays through a dual-split tree: down with the range of t that the planes leave, the nearer child
 * by the split's axis first, the other with its range on a stack.
 *
 * A node is entered exactly where slab_watertight accepts its implied box, whose proof is that of
 * docs/numerics.md. The range is the largest of the near planes' distances and the least of the far
 * ones', of all planes above. Distances rise with the plane, or fall, rounding included, so that of
 * each side the innermost plane decides, which is the implied box's. Where a plane goes through the
 * origin and 1 / d is infinite the distance is NaN and decides nothing, there as here, and planes
 * farther out have an infinite one on the side that decides nothing either. An axis that is
 * parallel to the ray is decided by comparison: the ray is between both planes if it is within
 * each. The allowance is taken where the range is compared, not from plane to plane, so it does not
 * add up. */
#include "ref/dual/dual.h"

#include "ref/trace/trace_walk.h"

struct dual_range {
    float tn, tf;
};

struct dual_waiting {
    uint32_t word;
    struct dual_range range;
};

struct dual_walk {
    struct walk walk;   /* the ray, the triangles, the best hit */
    dual_read_fn *read; /* or NULL */
    void *reader;
    uint32_t depth;
    struct dual_waiting waiting[DUAL_DEPTH_MOST];
};

/* Cuts the range at the plane of a side; false if a parallel ray is outside of it. */
static inline bool cut(const struct slab_ray *r, uint32_t side, float at, struct dual_range *range)
{
    uint32_t upper = side >= 3, k = side - 3 * upper;
    if (r->parallel[k])
        return upper ? r->o[k] <= at : at <= r->o[k];
    float t = (at - r->o[k]) * r->inv[k];
    if (upper == (r->d[k] < 0.0f))
        range->tn = t > range->tn ? t : range->tn;
    else
        range->tf = t < range->tf ? t : range->tf;
    return true;
}

/* True if the ray may meet something in that range, as slab_watertight has it. */
static inline bool may_meet(const struct walk *w, const struct dual_range *range)
{
    float entry = range->tn * SLAB_NEAR - w->slab.behind;
    return entry <= range->tf && entry <= w->tbest;
}

static inline bool enter(struct dual_walk *d, const struct box *box, struct dual_range *range)
{
    struct walk *w = &d->walk;
    bool ok = true;
    *range = (struct dual_range){w->slab.tmin, w->tbest};
    w->counts.boxes += DUAL_SIDES;
    for (uint32_t k = 0; k < 3; k++) {
        ok = cut(&w->slab, k, box->lo[k], range) && ok;
        ok = cut(&w->slab, 3 + k, box->hi[k], range) && ok;
    }
    return ok && may_meet(w, range);
}

/* Goes on with the nearer child that is met, the other waits. False if none is. */
static inline bool split(struct dual_walk *d, const uint32_t *word, struct dual_waiting *at)
{
    struct walk *w = &d->walk;
    uint32_t axis = word[0] & 3u;
    struct dual_waiting lower = {at->word + DUAL_NODE_WORDS, at->range},
                        upper = {word[0] >> DUAL_SHIFT, at->range};
    bool below = cut(&w->slab, 3 + axis, float_from_bits(word[1]), &lower.range) &&
                 may_meet(w, &lower.range);
    bool above =
        cut(&w->slab, axis, float_from_bits(word[2]), &upper.range) && may_meet(w, &upper.range);
    bool down = w->slab.d[axis] < 0.0f;
    w->counts.boxes += 2;
    if (below && above)
        d->waiting[d->depth++] = down ? lower : upper;
    *at = above && (down || !below) ? upper : lower;
    return below || above;
}

static inline bool carve(struct dual_walk *d, const uint32_t *word, struct dual_waiting *at)
{
    struct walk *w = &d->walk;
    bool first = cut(&w->slab, word[0] >> 3 & 7u, float_from_bits(word[1]), &at->range);
    bool second = cut(&w->slab, word[0] >> 6 & 7u, float_from_bits(word[2]), &at->range);
    w->counts.boxes += 2;
    at->word += DUAL_NODE_WORDS;
    return first && second && may_meet(w, &at->range);
}

/* The next node that waits and may still have something nearer. */
static inline bool resume(struct dual_walk *d, struct dual_waiting *at)
{
    while (d->depth > 0) {
        *at = d->waiting[--d->depth];
        if (may_meet(&d->walk, &at->range))
            return true;
    }
    return false;
}

/* Inlined where the triangle test is known. */
WALK_INLINE void go(struct dual_walk *d, const struct dual_tree *tree, uint32_t tri_id)
{
    struct dual_waiting at = {0, {0, 0}};
    if (tree->word_count == 0)
        return;
    slab_ray_place(&d->walk.slab, &tree->box);
    bool more = enter(d, &tree->box, &at.range);
    while (more) {
        const uint32_t *word = tree->word + at.word;
        bool is_leaf = (word[0] & 7u) == DUAL_OTHER;
        if (d->read)
            d->read(d->reader, at.word, is_leaf ? DUAL_LEAF_WORDS : DUAL_NODE_WORDS);
        if (is_leaf) {
            const struct wide leaf = {.item_first = word[1],
                                      .item_count = word[0] >> DUAL_COUNT_SHIFT};
            if (walk_leaf(&d->walk, WALK_SCENE, tri_id, &leaf))
                return;
            more = resume(d, &at);
        } else {
            more = (word[0] & 3u) == DUAL_OTHER ? carve(d, word, &at) : split(d, word, &at);
            more = more || resume(d, &at);
        }
    }
}

static void trace(struct dual_walk *d, const struct dual_tree *tree, const struct job *job,
                  const struct ray *ray, struct trace_counts *counts)
{
    struct walk *w = &d->walk;
    walk_set_tree(w, job->packed, job->scene);
    walk_set_ray(w, ray);
    w->counts = (struct trace_counts){0};
    w->found = 0;
    d->depth = 0;
    if (job->tri->id == ABI_TRI_WOOP)
        go(d, tree, ABI_TRI_WOOP);
    else if (job->tri->id == ABI_TRI_MT)
        go(d, tree, ABI_TRI_MT);
    else
        go(d, tree, job->tri->id);
    if (counts) {
        counts->boxes += w->counts.boxes;
        counts->tris += w->counts.tris;
    }
}

void dual_ray(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
              struct hit *out, struct trace_counts *counts)
{
    struct dual_walk d;
    d.read = NULL;
    d.walk.query = job->query;
    d.walk.capacity = 0;
    trace(&d, tree, job, ray, counts);
    *out = d.walk.best;
}

void dual_ray_all(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
                  uint32_t capacity, struct hit *out, uint32_t *count, struct trace_counts *counts)
{
    struct dual_walk d;
    d.read = NULL;
    d.walk.query = QUERY_ALL;
    d.walk.list = out;
    d.walk.capacity = capacity;
    trace(&d, tree, job, ray, counts);
    *count = d.walk.found;
}

struct hit dual_watched(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
                        dual_read_fn *read, void *reader)
{
    struct dual_walk d;
    d.read = read;
    d.reader = reader;
    d.walk.query = QUERY_CLOSEST;
    d.walk.capacity = 0;
    trace(&d, tree, job, ray, NULL);
    return d.walk.best;
}

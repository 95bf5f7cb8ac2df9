/* Traces two rays in turns, one node or leaf of each at a time, so that one waits for memory while
 * the other is computed. The hits are those of walk(). Included by ref/fast/kernel/walk.h. */

/* The state of one ray. */
struct walker {
    struct walk_ray r;
    struct walk_best best;
    struct walk_place at;
    struct walk_stack stack;
    struct hit *hit; /* NULL: no ray */
};

/* The rays of a call that have not been started. */
struct walk_queue {
    const struct fast_tree *tree;
    const struct ray *ray;
    struct hit *hit;
    size_t next, count;
    bool any;
};

/* Starts the next ray that this kernel can trace; returns false if there is none. Other rays are
 * traced by fast_careful. */
INLINE bool take(struct walker *w, struct walk_queue *queue)
{
    w->hit = NULL;
    while (queue->next < queue->count) {
        size_t i = queue->next++;
        if (!prepare(&w->r, queue->tree, &queue->ray[i])) {
            fast_careful(queue->tree, &queue->ray[i], queue->any, &queue->hit[i]);
            continue;
        }
        w->best.block = NULL;
        w->best.lane = 0;
        w->at = (struct walk_place){0, 0};
        w->hit = &queue->hit[i];
        return true;
    }
    return false;
}

/* Prefetches the first cache lines that the next step reads. */
INLINE void ask(const struct fast_tree *tree, uint32_t ref)
{
    const char *const base[2] = {(const char *)node_at(tree, 0), (const char *)tree->block};
    const char *from = place_of(base, ref);
    for (int i = 0; i < PLACE_LINES; i++)
        __builtin_prefetch(from + 64 * i);
}

/* Visits one node or leaf; returns false when the ray is finished. */
INLINE bool step(struct walker *w, const struct fast_tree *tree, bool any)
{
    struct walk_place at = w->at;
    if (!(at.now & FAST_LEAF)) {
        if (descend(&w->r, tree, any, &w->stack, &at))
            goto go_on;
    } else if (visit_leaf(&w->r, tree, any, NULL, NULL, &w->best, &at)) {
        return false;
    }
    if (!pop(&w->r, any, &w->stack, &at))
        return false;
go_on:
    w->at = at;
    ask(tree, at.now);
    return true;
}

INLINE void walk_pairs(const struct fast_tree *tree, const struct ray *ray, size_t count, bool any,
                       struct hit *hit)
{
    struct walker pair[2];
    struct walk_queue queue = {tree, ray, hit, 0, count, any};
    bool both = take(&pair[0], &queue);
    both = take(&pair[1], &queue) && both;
    while (both)
#pragma GCC unroll 1 /* two copies of the code are slower */
        for (int i = 0; i < 2; i++)
            if (!step(&pair[i], tree, any)) {
                write_hit(tree, &pair[i].best, pair[i].hit);
                both = take(&pair[i], &queue) && both;
            }
    for (int i = 0; i < 2; i++)
        if (pair[i].hit) {
            while (step(&pair[i], tree, any)) {
            }
            write_hit(tree, &pair[i].best, pair[i].hit);
        }
}

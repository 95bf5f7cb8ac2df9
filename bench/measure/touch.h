/* What a ray makes a traversal read: lines of a simulated cache. */
#ifndef TOUCH_H
#define TOUCH_H

#include "bench/measure/cache_sim.h"
#include "ref/engine.h"
#include "ref/fast/fast.h"
#include "ref/store.h"

/* A packed tree whose reads are watched; owns `leaf` (see touch_free). Nodes, items and the scene's
 * arrays lie at addresses of their own, each on a page. */
struct touch {
    struct packed packed; /* what is traced: hooks in place of layout and storage */
    struct layout layout;
    struct tri_store store;
    const struct packed *real;
    const struct scene *scene;
    struct cache_sim *cache;
    bool gathered;  /* vertices are read as nine floats a triangle, in the scene's order (on the
                       GPU),  not by its indices */
    uint32_t *leaf; /* places where leaves begin, sorted: of storages that hold vertices */
    size_t leaf_count;
};

/* Watches `packed`; all is borrowed, and *out may not be moved. Errors: STATUS_MEMORY. */
enum status touch_make(const struct packed *packed, const struct scene *scene, bool gathered,
                       struct cache_sim *cache, struct touch *out, struct reason *reason) MUST_USE;

/* Traces a ray as trace_ray does and reads into the cache: the record of every node that is visited
 * (of a leaf that has none its parent's, as it is decoded from there), the item of every triangle
 * that is tested with its index and vertices; where the storage holds vertices, the whole of the
 * leaf. Errors: as trace_ray. */
enum status touch_ray(struct touch *touch, const struct job *job, const struct ray *ray,
                      struct hit *hit) MUST_USE;

void touch_free(struct touch *touch);

/* The same of engine fast's tree, by fast_watched. */
void touch_fast(const struct fast_tree *tree, const struct ray *ray, bool any,
                struct cache_sim *cache, struct hit *hit);

#endif

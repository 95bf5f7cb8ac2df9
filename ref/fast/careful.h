/* The scalar traversal, of rays that kernels do not trace; inside ref/fast. */
#ifndef CAREFUL_H
#define CAREFUL_H

#include "ref/fast/fast.h"
#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"
#include "ref/world/candidate.h"

/* The traversal of a tree by one ray. The caller zeroes it and sets list, tags, capacity, read,
 * reader and in, where they are needed. */
struct careful {
    const struct fast_tree *tree;
    struct slab_ray slab;
    struct tri_ray tri;
    enum query query;
    struct hit best;
    uint32_t tag; /* of it */
    float tbest;
    struct hit *list; /* QUERY_ALL */
    uint32_t *tags;   /* of them; may be NULL */
    uint32_t capacity, found;
    fast_read_fn *read; /* called for all that is read; or NULL */
    void *reader;
    const struct instance_at *in; /* decides which hits count; NULL: all do */
    /* Visits a leaf; returns true if the traversal is finished. */
    bool (*leaf)(struct careful *way, uint32_t ref);
};

/* Sets what a traversal begins with: leaves of triangles, no hit. */
void careful_start(struct careful *way, const struct ray *ray, enum query query);

/* Traverses a tree, from the best hit or the list that there is. */
void careful_walk(struct careful *way, const struct fast_tree *tree, const struct ray *ray);

#endif

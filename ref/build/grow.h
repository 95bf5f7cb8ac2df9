/* Common part of the fast builders. Ranges are split until they are leaves, the large ones by all
 * threads together, the others by one thread each, and the pieces are put together in pre-order.
 * The pieces depend only on the ranges, so the tree does not depend on the number of threads. */
#ifndef GROW_H
#define GROW_H

#include "ref/build/lanes.h"
#include "ref/build/refs.h"
#include "ref/tree/bvh.h"

/* Depth limit of every tree, for any input: a range of n at depth d satisfies d + ceil(log2(n)) <=
 * this. It holds at first because n <= 2^31, and later because a split that would violate it is
 * replaced by halving. */
#define GROW_DEPTH_MOST 60u

/* Items first .. first + count - 1 of the builder's order. */
struct grow_range {
    uint32_t first, count;
    uint32_t depth;          /* root: 0 */
    struct lane_box centres; /* for the builder's own use */
};

struct grow_rule {
    /* Receives the references (see refs_make), root->count of them, which remain until the end, and
     * allocates what the builder needs. Sets root->centres, which has the bounds of the centres, if
     * it stores something else there. Errors: STATUS_MEMORY; end() is called nevertheless. */
    enum status (*start)(void *user, struct ref *ref, uint32_t threads, struct grow_range *root);
    void (*end)(void *user); /* frees what start() allocated; may be NULL */
    /* Orders the items of a range so that the first child's come first. Returns their number, at
     * least 1 and less than all, or 0 for a leaf. Sets `centres` of both children. threads: more
     * than 1 only for ranges beyond GROW_ALONE; the result must not depend on it. */
    uint32_t (*split)(void *user, const struct grow_range *range, struct grow_range child[2],
                      uint32_t threads);
    /* The same in two halves, whatever they cost. */
    uint32_t (*halve)(void *user, const struct grow_range *range, struct grow_range child[2]);
    /* Writes the triangles of the items to prim, and returns the items' bounds. */
    struct lane_box (*leaf)(void *user, const struct grow_range *range, uint32_t *prim);
};

/* Builds the tree of a scene; implements builder->build. The rule limits leaf sizes. Errors: as
 * build_check; STATUS_LIMIT as presplit_make; STATUS_MEMORY; then *out is zero. */
enum status grow_build(const struct grow_rule *rule, void *user, const struct scene *scene,
                       const struct build_options *options, struct bvh *out,
                       struct reason *reason) MUST_USE;

/* The checks that all builders perform first. Errors: STATUS_INPUT leaf is 0; STATUS_LIMIT more
 * than 2^31 triangles. */
enum status build_check(const struct scene *scene, const struct build_options *options,
                        struct reason *reason) MUST_USE;

/* ceil(log2(n)); 0 for 0 and 1. */
uint32_t log2_ceil(uint32_t n);

#endif

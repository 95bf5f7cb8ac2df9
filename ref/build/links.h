/* Trees as nodes with the indices of their children, in any order, for bottom-up builders, and
 * their conversion to the canonical form. */
#ifndef LINKS_H
#define LINKS_H

#include "ref/build/lanes.h"
#include "ref/tree/bvh.h"

#define LINKS_NONE UINT32_MAX

struct links {
    uint32_t (*child)[2]; /* per node; LINKS_NONE twice: a leaf */
    uint32_t *leaves;     /* leaves below each node; 1 for a leaf */
    uint32_t root;
    /* Writes a leaf's triangles to prim, and their number to *items; returns its box. */
    struct lane_box (*leaf)(const void *user, uint32_t node, uint32_t *prim, uint32_t *items);
    const void *user;
    uint32_t items, tris; /* total of all leaves, and triangles of the scene */
};

/* Writes the tree in pre-order, with boxes computed from those of the leaves. Where it is too deep
 * (GROW_DEPTH_MOST) the leaves below a node are halved instead, in their order. Errors:
 * STATUS_MEMORY; then *out is zero. */
enum status links_write(const struct links *links, struct bvh *out) MUST_USE;

/* Merges nodes to leaves of up to `leaf` items where that does not raise tree_sah; the tree remains
 * in pre-order. Errors: STATUS_MEMORY; the tree is unchanged. */
enum status tree_collapse(struct bvh *bvh, uint32_t leaf) MUST_USE;

/* Sets *out to what tree_sah times half the root's area would be after tree_collapse(bvh, leaf). 0
 * for an empty tree. Errors: STATUS_MEMORY. */
enum status tree_collapsed_cost(const struct bvh *bvh, uint32_t leaf, double *out) MUST_USE;

/* Like bvh_free, for a tree that a builder discards: its arrays come from room_make. */
void tree_drop(struct bvh *bvh);

#endif

/* Trees as nodes with the indices of their children, in any order, for builders from below, and
 * their conversion to the canonical form. */
#ifndef LINKS_H
#define LINKS_H

#include "ref/build/lanes.h"
#include "ref/tree/bvh.h"

#define LINKS_NONE UINT32_MAX

struct links {
    uint32_t (*child)[2]; /* of each node; LINKS_NONE twice: a leaf */
    uint32_t *leaves;     /* below each node; 1 of a leaf */
    uint32_t root;
    /* Writes a leaf's triangles to prim, and their number; returns its box. */
    struct lane_box (*leaf)(const void *user, uint32_t node, uint32_t *prim, uint32_t *items);
    const void *user;
    uint32_t items, tris; /* of all leaves together, and of the scene */
};

/* Writes the tree in pre-order, boxes made anew from those of the leaves. Where it is too deep
 * (GROW_DEPTH_MOST) the leaves below a node are halved instead, in their order. Errors:
 * STATUS_MEMORY; *out is zero then. */
enum status links_write(const struct links *links, struct bvh *out) MUST_USE;

/* Makes leaves of up to `leaf` items where that lowers tree_sah, or leaves it the same; the tree
 * stays in pre-order. Errors: STATUS_MEMORY; the tree is as it was. */
enum status tree_collapse(struct bvh *bvh, uint32_t leaf) MUST_USE;

/* bvh_free of a tree that a builder gives up: its arrays are room_make's. */
void tree_drop(struct bvh *bvh);

#endif

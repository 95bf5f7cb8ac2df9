/* Collapses a binary tree to a wide one: decides which of its nodes remain, and which become
 * leaves. Shared by all layouts of more than two children. */
#ifndef WIDE_TREE_H
#define WIDE_TREE_H

#include "ref/tree/bvh.h"

#define WIDE_TREE_MOST 16u /* children of a node */

/* Limits and costs of the wide tree. Its cost is the sum of the surface areas of its parts,
 * relative to the root's, times node_cost or leaf_cost. */
struct wide_rule {
    uint32_t width;     /* most children of a node, 2 to WIDE_TREE_MOST */
    uint32_t leaf_most; /* most items of a leaf, at least 1 */
    float node_cost;
    /* Returns the cost of a leaf of these triangles, INFINITY if they do not fit in one; a single
     * triangle always fits. May be NULL: the cost is `count`. */
    float (*leaf_cost)(void *self, const uint32_t *prim, uint32_t count);
    void *self;
};

/* A child. count == 0: node `first`, which comes after its parent. Else a leaf with the items
 * prim[first .. first + count - 1]. */
struct wide_child {
    struct box bounds;
    uint32_t first;
    uint32_t count;
};

/* A node: the children child[first .. first + count - 1]; count >= 1, and 1 only if the root has
 * one leaf. Those children that are nodes have consecutive numbers, in the order of the children.
 */
struct wide_node {
    uint32_t first;
    uint32_t count;
};

/* Owns its arrays (see wide_tree_free). Node 0 is the root; an empty tree has no nodes. Leaves are
 * ranges of the binary tree's items, in its order. */
struct wide_tree {
    struct wide_node *node;
    struct wide_child *child;
    struct box bounds; /* of the root */
    uint32_t node_count;
    uint32_t child_count;
    uint32_t stack_need; /* most entries that a traversal can need if it pushes all children that it
                            hits but one */
};

/* Collapses `bvh`, whose form has been checked, to the cheapest wide tree whose boxes are all boxes
 * of `bvh` (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs", section 3.1: the best cost of each subtree as 1, 2 .. width roots, from
 * the leaves up). Differs from the paper in two points. Leaves of several items are first divided,
 * by halving their range, with the boxes of their triangles within the leaf's, so that leaves
 * depend on the rule and not on the builder. And 2^-20 of the root's area is added to every area,
 * so that trees without area are shallow, too. The result is the same on every machine. Errors:
 * STATUS_MEMORY; STATUS_LIMIT more than 2^30 items. On error *out is zero. */
enum status wide_tree_make(const struct bvh *bvh, const struct scene *scene,
                           const struct wide_rule *rule, struct wide_tree *out,
                           struct reason *reason) MUST_USE;

void wide_tree_free(struct wide_tree *tree);

#endif

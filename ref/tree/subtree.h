/* Parts of a tree as trees of their own. */
#ifndef SUBTREE_H
#define SUBTREE_H

#include "ref/tree/bvh.h"

/* The items below a node: prim[first .. end - 1]; and its nodes: its own number to last. */
struct subtree_range {
    uint32_t first, end, last;
};

/* `node` is below bvh->node_count. */
struct subtree_range subtree_range(const struct bvh *bvh, uint32_t node);

/* Copies the nodes below `node`, itself included, and their items as a tree. Its items keep their
 * numbers and tri_count is that of the scene, so it does not pass bvh_check_form if others are left
 * out. `bvh` is not split. Errors: STATUS_MEMORY, *out is then zero. */
enum status subtree_make(const struct bvh *bvh, uint32_t node, struct bvh *out) MUST_USE;

#endif

/* Improves trees by making small parts of them anew. */
#ifndef TREELETS_H
#define TREELETS_H

#include "ref/tree/bvh.h"

/* Restructures a well-formed tree with one item in each leaf (Karras and Aila 2013, Fast parallel
 * construction of high-quality bounding volume hierarchies): from below, each node's treelet, the
 * node and the largest nodes below it, 7 leaves at most, becomes the cheapest of all trees of these
 * leaves, if that is cheaper than what is there. The cost is that of the tree after
 * tree_collapse(bvh, leaf), and never rises: see tree_climb, which has the rounds. Ours: nodes
 * above fewer than 7 leaves have treelets, too, and all nodes have in all rounds. Errors:
 * STATUS_MEMORY; the tree is valid. */
enum status tree_treelets(struct bvh *bvh, uint32_t leaf, uint32_t rounds,
                          uint32_t threads) MUST_USE;

#endif

/* Improves trees by moving subtrees. */
#ifndef REINSERT_H
#define REINSERT_H

#include "ref/tree/bvh.h"

/* Moves subtrees of a well-formed tree to where they cost less (Bittner, Hapala and Havran 2013,
 * Fast insertion-based optimization of bounding volume hierarchies; the search of Meister and
 * Bittner 2018, Parallel reinsertion for bounding volume hierarchy optimization), in `passes`
 * passes over the tree or until its cost no longer falls. Ours: all threads search places, but
 * moves are made one by one, the greatest gain first, each only if it still lowers the cost. So the
 * cost never rises, and the tree does not depend on the number of threads (0: all). Leaves are
 * unchanged; inner boxes become those of their children. The tree remains in pre-order, at most 60
 * deep. Errors: STATUS_MEMORY; the tree is unchanged. */
enum status tree_reinsert(struct bvh *bvh, uint32_t passes, uint32_t threads) MUST_USE;

#endif

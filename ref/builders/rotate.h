/* Improves trees by exchanging children with grandchildren. */
#ifndef ROTATE_H
#define ROTATE_H

#include "ref/tree/bvh.h"

/* Rotates the nodes of a well-formed tree (Kensler 2008, Tree rotations for improving bounding
 * volume hierarchies): each node, from below, exchanges one child with a child of the other, in
 * whichever of the four ways lowers the sum of areas most, if any does; in `passes` passes over the
 * tree or until its cost no longer falls. Leaves are unchanged; inner boxes become those of their
 * children. The cost never rises, and the tree does not depend on the number of threads: see
 * tree_climb. Errors: STATUS_MEMORY; the tree is valid. */
enum status tree_rotate(struct bvh *bvh, uint32_t passes, uint32_t threads) MUST_USE;

#endif

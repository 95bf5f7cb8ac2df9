/* Changes of a tree from below: each node in turn, after all nodes that are below it. */
#ifndef CLIMB_H
#define CLIMB_H

#include "ref/builders/spots.h"

struct climb_rule {
    /* Is given each node, leaves included, after the nodes below it, and may give the inner nodes
     * of its subtree other children. Reads and writes nothing else of the tree: subtrees are
     * climbed by different threads. */
    void (*at)(void *user, struct spots *spots, uint32_t node);
    void *user;
    uint32_t leaf; /* the cost is that of the tree with leaves of up to so many items */
};

/* Climbs a well-formed tree in `rounds` rounds or until its cost no longer falls. A round that
 * makes it dearer, because of what GROW_DEPTH_MOST asks for, is dropped: the cost never rises. The
 * tree remains in pre-order, at most 60 deep, with the same leaves, and does not depend on
 * `threads`. Errors: STATUS_MEMORY; the tree is that of the last whole round. */
enum status tree_climb(struct bvh *bvh, const struct climb_rule *rule, uint32_t rounds,
                       uint32_t threads) MUST_USE;

#endif

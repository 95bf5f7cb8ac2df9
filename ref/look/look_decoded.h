/* The canonical tree that a packed one was made from, as far as its bytes contain it. */
#ifndef LOOK_DECODED_H
#define LOOK_DECODED_H

#include "ref/layout.h"

/* Decodes a packed tree, nodes in pre-order, boxes as they are stored; bvh_check_form holds of it.
 * For files that hold nothing else. Errors: STATUS_INPUT it is no tree of the scene: references out
 * of range or to one node twice, an empty leaf, a triangle in several leaves or in none (RTRS's
 * layouts read other triangles than they were given); STATUS_MEMORY. On error *out is zero. */
enum status decoded_tree(const struct packed *packed, const struct scene *scene, struct bvh *out,
                         struct reason *reason) MUST_USE;

#endif

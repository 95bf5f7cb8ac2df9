/* Converts a packed tree of any width to the binary tree that fast_make takes. */
#ifndef FAST_DECODED_H
#define FAST_DECODED_H

#include "ref/layout.h"

/* Decodes `packed`, which packed_check must have accepted, to a binary tree. A node of more than
 * two children becomes a tree of their halves. The boxes are the decoded ones. Empty slots and
 * leaves without triangles are left out. Errors: STATUS_UNSUPPORTED deeper than 4096 levels, no
 * triangle at all, or more items than packed_prims_most; STATUS_MEMORY. On error *out is zero. */
enum status fast_decode(const struct packed *packed, const struct scene *scene, struct bvh *out,
                        struct reason *reason) MUST_USE;

#endif

/* A packed tree of any width as the binary tree that the fast one is made of. */
#ifndef FAST_DECODED_H
#define FAST_DECODED_H

#include "ref/layout.h"

/* Makes a binary tree of what `packed`, which packed_check calls safe, decodes to: a node of more
 * children becomes a tree of halves of them, boxes as they decode; slots and leaves without
 * triangles are left out. Errors: STATUS_UNSUPPORTED deeper than 4096 levels, no triangle at all,
 * more items than it could name; STATUS_MEMORY. On error *out is zero. */
enum status fast_decode(const struct packed *packed, const struct scene *scene, struct bvh *out,
                        struct reason *reason) MUST_USE;

#endif

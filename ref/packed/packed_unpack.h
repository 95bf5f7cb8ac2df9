/* A packed tree as the tree that it may have been packed from. */
#ifndef PACKED_UNPACK_H
#define PACKED_UNPACK_H

#include "ref/layout.h"

/* Entries of `prim` that a tree decoded from `packed` can have at most: a split one's items are as
 * many as its bytes can name. */
static inline uint32_t packed_prims_most(const struct packed *packed)
{
    uint64_t named = 2 * (uint64_t)packed->word_count + packed->item_count;
    if (!packed->split || named < packed->tri_count)
        return packed->tri_count;
    return named < UINT32_MAX ? (uint32_t)named : UINT32_MAX;
}

/* Makes the canonical tree of a packed one that packed_check calls safe (no bad references, cycles
 * or items): nodes in the order of its records, boxes as they decode, items in their slots' order.
 * Packing it again gives the same words wherever rounding outward keeps what is rounded already.
 * Errors: STATUS_INPUT with the rule: a node of more children than two, records that are not in
 * pre-order (a node one, a leaf one or two), a triangle in no leaf or (unless packed->split) in
 * several, a leaf without items; STATUS_MEMORY. On error *out is zero. */
enum status packed_unpack(const struct packed *packed, const struct scene *scene, struct bvh *out,
                          struct reason *reason) MUST_USE;

#endif

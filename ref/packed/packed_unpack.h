/* Converts a packed tree to the tree from which it may have been packed. */
#ifndef PACKED_UNPACK_H
#define PACKED_UNPACK_H

#include "ref/layout.h"

/* Returns the most entries of `prim` in a tree decoded from `packed`: a split tree has at most as
 * many items as its bytes can name. */
static inline uint32_t packed_prims_most(const struct packed *packed)
{
    uint64_t named = 2 * (uint64_t)packed->word_count + packed->item_count;
    if (!packed->split || named < packed->tri_count)
        return packed->tri_count;
    return named < UINT32_MAX ? (uint32_t)named : UINT32_MAX;
}

/* Makes the canonical tree of a packed tree that is safe according to packed_check (no bad
 * references, cycles or items): nodes in the order of its records, boxes as decoded, items in the
 * order of their slots. Packing it again gives the same words wherever rounding outward does not
 * change values that are rounded already. Errors: STATUS_INPUT with the rule: a node of more than
 * two children, records that are not in pre-order (a node one record, a leaf one or two), a
 * triangle in no leaf or (unless packed->split) in several, a leaf without items; STATUS_MEMORY. On
 * error *out is zero. */
enum status packed_unpack(const struct packed *packed, const struct scene *scene, struct bvh *out,
                          struct reason *reason) MUST_USE;

#endif

/* Shared by several layouts: checks, allocation, numbering of 16-byte records, bounds in halves. */
#ifndef LAYOUT_COMMON_H
#define LAYOUT_COMMON_H

#include "ref/base/half.h"
#include "ref/layout.h"

/* Checks that the vertices of all triangles and the boxes of all nodes are finite.
 * Errors: STATUS_LIMIT with the layout and the first triangle or node. */
enum status layout_check_finite(const char *layout, const struct bvh *bvh,
                                const struct scene *scene, struct reason *reason) MUST_USE;

/* Allocates `record_count` records of `record_words` words each and `item_count` items (0: none, or
 * store_put appends them), and sets the counts in *out; each reference is a record; keeps
 * out->store. Errors: STATUS_LIMIT over 2^32 - 1 words; STATUS_MEMORY. On error *out owns
 * nothing. */
enum status layout_alloc(const char *layout, uint64_t record_count, uint32_t record_words,
                         uint32_t item_count, struct packed *out, struct reason *reason) MUST_USE;

/* Returns the number of leaves before each node, node_count + 1 values: in layouts whose leaves are
 * two records, node i is record i + before[i]. Caller frees; NULL if out of memory. */
uint32_t *layout_leaves_before(const struct bvh *bvh);

/* A box as three words of two halves, the lower bound in the low half. */
void layout_pack_bounds(const struct box *box, struct half (*down)(float), struct half (*up)(float),
                        uint32_t word[3]);
struct box layout_unpack_bounds(const uint32_t word[3]);

/* Adds the child `ref` to a node; an out-of-range reference is dropped. */
void layout_add_child(const struct packed *packed, uint32_t ref, struct wide *out);

static inline uint32_t low_half(uint32_t word)
{
    return word & 0xFFFFu;
}

static inline uint32_t high_half(uint32_t word)
{
    return word >> 16;
}

#endif

/* Triangles in the order of a space-filling curve. */
#ifndef MORTON_H
#define MORTON_H

#include "ref/build/refs.h"

/* Moves bit i to bit 3 i, of 21 bits. */
static inline uint64_t morton_spread(uint32_t x)
{
    uint64_t v = x & 0x1FFFFFu;
    v = (v | v << 32) & 0x001F00000000FFFFu;
    v = (v | v << 16) & 0x001F0000FF0000FFu;
    v = (v | v << 8) & 0x100F00F00F00F00Fu;
    v = (v | v << 4) & 0x10C30C30C30C30C3u;
    return (v | v << 2) & 0x1249249249249249u;
}

/* Returns the references' positions along the Z curve, ascending: the code of the centre, and below
 * it, in `index_bits` bits, the reference's index, so that no two keys are equal. Uses as many bits
 * of each axis as fit beside the index, at most 21: 63 in all for 2 references, 42 for a million,
 * 33 for 2^31. Free with room_free. Errors: STATUS_MEMORY. */
enum status morton_order(const struct ref *ref, uint32_t count, const struct lane_box *centres,
                         uint32_t threads, uint64_t **out, uint32_t *index_bits) MUST_USE;

#endif

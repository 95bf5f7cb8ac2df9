/* Bits of floats that are hard to round. */
#ifndef TESTS_DRAWN_BITS_H
#define TESTS_DRAWN_BITS_H

#include "ref/base/base.h"
#include "ref/base/rng.h"

/* Fractions of all zeros and ones, with one bit, and any. */
static inline uint32_t draw_fraction(struct rng *rng)
{
    switch (rng_below(rng, 5)) {
    case 0:
        return 0;
    case 1:
        return 0x7FFFFFu;
    case 2:
        return 1u << rng_below(rng, 23);
    case 3:
        return 0x7FFFFFu ^ 1u << rng_below(rng, 23);
    default:
        return rng_below(rng, 1u << 23);
    }
}

/* A number of the same order as the bits, and back. */
static inline int64_t order_of_bits(uint32_t bits)
{
    return bits >> 31 ? -(int64_t)(bits & 0x7FFFFFFFu) : (int64_t)bits;
}

static inline uint32_t bits_of_order(int64_t order)
{
    return order < 0 ? 0x80000000u | (uint32_t)-order : (uint32_t)order;
}

#endif

/* Numbers and directions that find what random ones do not: zeros of both signs, equal and long
 * components, neighbours. */
#ifndef ADVERSE_H
#define ADVERSE_H

#include "ref/base/base.h"
#include "ref/base/rng.h"

#include <math.h>
#include <string.h>

static inline float adverse_sign(struct rng *rng)
{
    return rng_below(rng, 2) ? 1.0f : -1.0f;
}

/* Each component is 0, -0, 1, 1 / longest, longest or any in [1, 2), of either sign. Many
 * directions have two components of one size. `longest` is a power of two. */
static inline void adverse_direction(struct rng *rng, float longest, float d[3])
{
    const float size[] = {0, 0, 1, 1 / longest, longest};
    for (int k = 0; k < 3; k++) {
        uint32_t kind = rng_below(rng, 2 * ARRAY_COUNT(size));
        float sign = adverse_sign(rng);
        d[k] = sign * (kind < ARRAY_COUNT(size) ? size[kind] : rng_range(rng, 1, 2));
    }
    uint32_t from = rng_below(rng, 3), to = rng_below(rng, 3);
    float sign = adverse_sign(rng);
    d[to] = sign * d[from];
}

static inline float adverse_largest(const float d[3])
{
    return fmaxf(fabsf(d[0]), fmaxf(fabsf(d[1]), fabsf(d[2])));
}

/* x or one of its two neighbours. Those of 0 are taken to be 2^-100 and -2^-100, so that no product
 * is subnormal. */
static inline float adverse_beside(struct rng *rng, float x)
{
    static const float to[] = {-INFINITY, INFINITY};
    uint32_t kind = rng_below(rng, 3);
    if (kind == 2)
        return x;
    return x == 0 ? copysignf(0x1p-100f, to[kind]) : nextafterf(x, to[kind]);
}

/* A whole number in [-most, most]; zeros have both signs. */
static inline float adverse_whole(struct rng *rng, uint32_t most)
{
    float sign = adverse_sign(rng);
    return sign * (float)rng_below(rng, most + 1);
}

/* Times 2^e. */
static inline void adverse_scale(float v[3], int e)
{
    for (int k = 0; k < 3; k++)
        v[k] = ldexpf(v[k], e);
}

/* The same bits, or both undefined. */
static inline bool adverse_same(uint32_t a, uint32_t b)
{
    return a == b || (isnan(float_from_bits(a)) && isnan(float_from_bits(b)));
}

#endif

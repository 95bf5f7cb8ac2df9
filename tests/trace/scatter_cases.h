/* Scatters for tests. */
#ifndef SCATTER_CASES_H
#define SCATTER_CASES_H

#include "ref/base/rng.h"
#include "ref/twin/scatter.h"

#include <math.h>

/* Numbers near each other or near 1 in size. */
static inline float drawn(struct rng *rng)
{
    float x = 1.0f + (float)(rng_u64(rng) >> 41) * 0x1p-23f;
    int kind = (int)(rng_u64(rng) % 4);
    x = kind == 0 ? x : kind == 1 ? ldexpf(x, (int)(rng_u64(rng) % 40) - 20) : floorf(x * 8.0f);
    return rng_u64(rng) % 2 ? -x : x;
}

static inline struct scatter drawn_list(struct rng *rng)
{
    struct scatter s = scatter_of(drawn(rng));
    for (uint64_t more = rng_u64(rng) % 12; more > 0; more--) {
        struct scatter other = scatter_of(drawn(rng));
        s = scatter_either(&s, &other);
    }
    return s;
}

/* A list without its numbers: bounds and grid alone. */
static inline struct scatter range_of(const struct scatter *list)
{
    struct scatter out = *list;
    out.count = 0;
    return out;
}

#endif

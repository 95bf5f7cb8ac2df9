/* Seeded random numbers: the same sequence on every machine and compiler. */
#ifndef RNG_H
#define RNG_H

#include <math.h>
#include <stdint.h>

struct rng {
    uint64_t state;
};

/* Starts the sequence of `seed`; different streams of one seed are independent. */
static inline struct rng rng_make(uint64_t seed, uint64_t stream)
{
    return (struct rng){seed * 0x9E3779B97F4A7C15u + stream * 0xD1B54A32D192ED03u};
}

/* 64 random bits. SplitMix64 (Steele, Lea, Flood 2014). */
static inline uint64_t rng_u64(struct rng *rng)
{
    uint64_t z = (rng->state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* Uniform integer in [0, bound), bound >= 1. Multiply-shift; the bias is below 2^-32. */
static inline uint32_t rng_below(struct rng *rng, uint32_t bound)
{
    return (uint32_t)(((rng_u64(rng) >> 32) * bound) >> 32);
}

/* Uniform in [0, 1), a multiple of 2^-24. */
static inline float rng_float(struct rng *rng)
{
    return (float)(rng_u64(rng) >> 40) * 0x1p-24f;
}

/* Uniform in [lo, hi), up to rounding. */
static inline float rng_range(struct rng *rng, float lo, float hi)
{
    return lo + (hi - lo) * rng_float(rng);
}

/* Uniform in [lo, hi) times 2^e, e uniform among `count` whole numbers from `least`. The two are
 * drawn in separate statements, as two draws always must be: a compiler may evaluate the arguments
 * of a call in any order. */
static inline float rng_scaled(struct rng *rng, float lo, float hi, int least, uint32_t count)
{
    int exponent = least + (int)rng_below(rng, count);
    return ldexpf(rng_range(rng, lo, hi), exponent);
}

#endif

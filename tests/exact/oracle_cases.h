/* Kinds of ray-triangle pairs that decide whether arithmetic is exact. For tests of the oracle. */
#ifndef TESTS_ORACLE_CASES_H
#define TESTS_ORACLE_CASES_H

#include "ref/abi.h"
#include "ref/base/base.h"
#include "ref/base/rng.h"

/* A kind makes one triangle and a ray that has to do with it. Triangles of a batch share `seed`, so
 * that a kind can make ties across them. */
struct oracle_case {
    const char *name;
    void (*make)(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3]);
};

#define ORACLE_CASES 15
extern const struct oracle_case oracle_cases[ORACLE_CASES];

/* Any finite float32, all bit patterns alike. */
float random_bits(struct rng *rng);

#endif

/* Scatters: all numbers that an operation of a formula may come to under a rounding
 * (ref/twin/model.h). Twins (ref/twin/twin.h) bound how far a value is from the exact one, which is
 * no bound of a quotient whose divisor may be 0; a scatter keeps what is still known: that 0 times
 * anything is 0, that x - x is 0, that each number is a float32 and a multiple of a power of two,
 * and, while they are few, the numbers themselves. Slow, and needed for rare answers only. */
#ifndef SCATTER_H
#define SCATTER_H

#include "ref/twin/model.h"

#include <stdbool.h>

#define SCATTER_MOST 96 /* numbers that are listed */

/* Every number lies in [lo, hi] and is a multiple of 2^grid. */
struct scatter {
    double lo, hi;              /* infinite if nothing is known */
    int grid;                   /* of 0 alone: SCATTER_ZERO */
    int count;                  /* of `value`, ascending; 0: not listed */
    double value[SCATTER_MOST]; /* float32 numbers, or products of two that wait for a sum */
};
#define SCATTER_ZERO 1000

/* The arithmetic of an engine. */
struct liberty {
    struct rounding rounding;
    bool fuses; /* a product that is added may be left unrounded */
};

struct scatter scatter_of(float x);
struct scatter scatter_add(const struct liberty *k, const struct scatter *a,
                           const struct scatter *b);
struct scatter scatter_sub(const struct liberty *k, const struct scatter *a,
                           const struct scatter *b);
/* A product that is added to something: it may be left unrounded if k->fuses. */
struct scatter scatter_mul(const struct liberty *k, const struct scatter *a,
                           const struct scatter *b);
struct scatter scatter_div(const struct liberty *k, const struct scatter *a,
                           const struct scatter *b);

/* One or the other. */
struct scatter scatter_either(const struct scatter *a, const struct scatter *b);

/* Without rounding. */
struct scatter scatter_negate(const struct scatter *a);
struct scatter scatter_single(double x); /* a float32 number */

bool scatter_is_zero(const struct scatter *a); /* surely */
bool scatter_has_zero(const struct scatter *a);

/* The least size of those that are not 0; INFINITY if all are. */
double scatter_least(const struct scatter *a);

#endif

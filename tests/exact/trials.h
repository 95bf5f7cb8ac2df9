/* Pairs of a ray and a triangle that are hard on rounding, with the exact truth, and the question
 * whether a twin's claims hold for one legal evaluation. Include after cmocka.h. */
#ifndef TESTS_TRIALS_H
#define TESTS_TRIALS_H

#include "tests/exact/exact_gmp.h"
#include "tests/exact/legal.h"

/* A number as a sum of two doubles. */
struct sum {
    double head, tail;
};

struct sum trial_sum(const mpq_t x);

struct truth {
    bool point; /* the line meets the plane in one point: t and weight are set */
    struct sum t, weight[3];
    int side[3];            /* signs of the weights */
    int from_tmin, to_tmax; /* signs of t - tmin and t - tmax */
};

struct trials_trial {
    struct ray ray;
    float v[3][3];
    struct truth truth;
    const struct twin_place *place; /* of the triangle; NULL: it is one of a scene */
};

/* How near an evaluation came to its bounds: error over bound, 0 where the bound is infinite. */
struct nearness {
    double t, u, v;
};

#define TRIAL_KINDS 19
const char *trial_kind(int kind);

/* Draws pair `index` of a kind. `pair` is scratch. */
void trial_make(int kind, uint64_t index, struct gmp_pair *pair, struct trials_trial *out);

/* Fills in the truth of a ray and triangle made elsewhere. */
void trial_truth(struct gmp_pair *pair, struct trials_trial *trial);

/* Whether everything that `twin` says holds of the exact truth and of `evaluation`. Returns NULL,
 * or what does not hold. `near` is set in either case. */
const char *trial_broken(const struct trials_trial *trial, enum twin_formula formula,
                         const struct twin *twin, const struct evaluation *evaluation,
                         struct nearness *near);

/* Looks for the worst evaluation: starts from the choices in `legal` and keeps each change of one
 * operation that brings t or u nearer to its bound. Returns what broke, or NULL. */
const char *trial_worsen(const struct trials_trial *trial, enum twin_formula formula,
                         const struct twin *twin, struct legal *legal, struct nearness *near);

#endif

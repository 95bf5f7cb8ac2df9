/* Placed triangles: transforms of every kind that is hard on rounding, pairs of
 * tests/exact/trials.h seen through them, and the exact truth from rationals. */
#ifndef TESTS_PLACED_H
#define TESTS_PLACED_H

#include "tests/exact/trials.h"

#define PLACED_KINDS 13
const char *placed_kind(int kind);

struct exact_placed {
    struct trials_trial trial; /* its ray is one of the world, its vertices are the mesh's */
    struct instance instance;
    struct twin_place place;
    int side;     /* exact sign of d . ((v1 - v0) x (v2 - v0)) in the space of the mesh */
    mpq_t org[3]; /* the exact ray there */
    mpq_t dir[3];
    mpq_t inverse[9]; /* of M, exactly */
};

void placed_init(struct exact_placed *placed);
void placed_clear(struct exact_placed *placed);

/* Draws a transform of a kind: finite, its determinant not 0. */
void placed_transform(int kind, struct rng *rng, struct instance *out);

/* Draws pair `index` of a pair kind of trials.h behind a transform of a kind: the ray in the world
 * is the pair's, placed and rounded, so that it is that very ray where the transform is exact.
 * `pair` is scratch. False if a number of the inverse, or of the ray, is beyond float32. */
bool placed_make(int kind, int pair_kind, uint64_t index, struct gmp_pair *pair,
                 struct exact_placed *out);

/* Fills in place and truth from instance, ray and v; false as above. */
bool placed_truth(struct exact_placed *placed);

#endif

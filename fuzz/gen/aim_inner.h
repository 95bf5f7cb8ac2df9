/* What the files of fuzz/gen/aim*.c share. */
#ifndef FUZZ_AIM_INNER_H
#define FUZZ_AIM_INNER_H

#include "fuzz/gen/aim.h"

/* How a ray comes to its target. */
enum approach {
    APPROACH_ANY,     /* from a random point in or about the scene */
    APPROACH_OUTSIDE, /* from around it */
    APPROACH_LATTICE, /* from a point of a lattice: on one, target - origin is exact */
    APPROACH_AXIS,    /* parallel to an axis */
    APPROACH_PLANE,   /* parallel to a coordinate plane */
    APPROACH_NEARLY,  /* nearly parallel to one */
    APPROACH_FEATURE, /* from a vertex or a corner of a box */
    APPROACH_NEAR,    /* from close by */
    APPROACHES
};

/* A target, and the axis that matters there. */
struct target {
    float at[3];
    int axis;
};

/* Makes the ray to a target and returns its t there, 1 unless the direction had to be scaled. */
float aim_approach(const struct aim *aim, struct rng *rng, const struct target *target,
                   enum approach approach, struct ray *out);

/* A direction in the cube of side 2 whose largest component is not below 2^-5. */
void aim_direction(struct rng *rng, float dir[3]);

/* Sets the ray with the full range; scales by a power of two what is out of contract, and makes
 * components that are negligible zeros of the same sign. Returns the factor s: t of the ray is s
 * times t of the direction given. */
float aim_set(const float org[3], const float dir[3], struct ray *out);

/* x, or the end of [-most, most] that it lies beyond. */
static inline float aim_clamped(float x, float most)
{
    return x < -most ? -most : x > most ? most : x;
}

/* Keeps an origin in contract, whatever the scene. */
void aim_clamp_origin(float org[3]);

/* A ray that may be out of contract. */
void aim_degenerate(const struct aim *aim, struct rng *rng, struct ray *out);

#endif

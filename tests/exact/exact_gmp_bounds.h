/* A-priori bounds on what a triangle test may compute, in rationals: closed forms over the exact
 * values, never the twins of ref/twin/twin.c, never a float that anyone computed.
 *
 * Every quantity that decides is a sum of products. A factor that was computed with error E lies
 * within |x| + E, and a product of such factors that goes through n more roundings of relative size
 * k u is at most prod(|x| + E) (1 + k u)^n in size; so its error is at most that less prod |x|.
 * (Higham 2002, section 3.1, with the factors' own errors kept apart.) What subnormals may lose is
 * added once, coarsely. */
#ifndef EXACT_GMP_BOUNDS_H
#define EXACT_GMP_BOUNDS_H

#include "ref/abi.h"
#include "ref/twin/model.h"

#include <gmp.h>

/* An exact value and how far a computed one may be off. */
struct known {
    mpq_t v, e;
};

/* What the formula decides by, of one pair. */
struct gmp_bounds {
    bool none;            /* no bound: overflow, or a divisor near 0 or out of its range */
    struct known edge[3]; /* opposite vertex i; inside they have one sign */
    struct known det;
    mpq_t band;       /* an edge may have the other sign by this much and still be accepted */
    bool det_alone;   /* det's sign takes no part in the decision */
    double threshold; /* |det| at or below it is rejected */
    bool divided;     /* t, u, v are set: det's sign is certain */
    struct known t, u, v;
};

void gmp_bounds_init(struct gmp_bounds *bounds);
void gmp_bounds_clear(struct gmp_bounds *bounds);

/* Bounds one finite ray and triangle; model->formula is not TWIN_UNKNOWN. */
void gmp_bounds_of(const struct model *model, const struct ray *ray, float v[3][3],
                   struct gmp_bounds *out);

/* Whether the formula must accept the triangle in the ray's range; whether it may. */
bool gmp_bounds_certain(const struct gmp_bounds *bounds, const struct ray *ray);
bool gmp_bounds_possible(const struct gmp_bounds *bounds, const struct ray *ray);

/* Whether a computed value may be `value`. */
bool gmp_bounds_allow(const struct known *known, float value);

#endif

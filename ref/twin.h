/* Twins: the triangle tests once more, each value carried with a proven bound on its rounding
 * error. They tell which signs an engine could not help getting right, and how far its t may be
 * off. Running error analysis: Wilkinson 1963; Higham 2002, section 3.3. */
#ifndef TWIN_H
#define TWIN_H

#include "ref/primitives/primitives.h"

#include <stdbool.h>

/* Whose formula is bounded. The first three are ref/primitives/tri.h; the last two are Embree's
 * default and robust triangle tests, from their published descriptions. */
enum twin_formula {
    TWIN_MT,
    TWIN_MT_RTRS,
    TWIN_WOOP,
    TWIN_EMBREE,
    TWIN_EMBREE_ROBUST,
};

/* Error of one operation, in units of u = 2^-24. */
struct rounding {
    double add, mul, div;
};

/* IEEE round to nearest: C, lavapipe. */
#define ROUNDING_IEEE ((struct rounding){1.0, 1.0, 1.0})
/* Embree: reciprocals by estimate and one Newton step, up to 5.5 u; a fused multiply-add is never
 * worse than the two operations it replaces. */
#define ROUNDING_EMBREE ((struct rounding){1.0, 1.0, 5.5})

struct twin {
    bool possible; /* the exact triangle may be hit, as far as this formula can tell */
    bool certain;  /* the exact ray hits the triangle inside [tmin, tmax]: all signs are proven */
    float t;       /* as the formula computes it */
    double t_err;  /* |t - exact t| is at most this; infinite if the determinant's sign is open */
};

/* The formula that triangle test `id` (ABI_TRI_*) computes. */
enum twin_formula twin_of_tri(uint32_t id);

/* Evaluates one triangle. The ray is in contract (ray_in_contract). */
struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3]);

#endif

/* Twins: the triangle tests once more, each value carried with a proven bound on its rounding
 * error. They tell which signs an engine could not help getting right, and how far its t may be
 * off. Running error analysis: Wilkinson 1963; Higham 2002, section 3.3. */
#ifndef TWIN_H
#define TWIN_H

#include "ref/model.h"
#include "ref/primitives/primitives.h"

#include <stdbool.h>

struct twin {
    bool possible; /* the exact triangle may be hit in range, as far as this formula can tell */
    bool certain;  /* the exact ray hits the triangle inside [tmin, tmax]: all signs are proven */
    bool beyond;   /* t is certainly outside the range */
    int edge[3];   /* proven sign of the edge function opposite vertex i; 0: open. The sign is the
                      formula's own: compare it with det */
    int det;       /* proven sign of the determinant; 0: open, or not surely over a threshold */
    float t, u, v; /* as the formula computes them; u weighs vertex 1, v vertex 2 */
    double t_err;  /* |t - exact t| is at most this; infinite if the determinant's sign is open */
    double u_err, v_err;
};

/* The formula that triangle test `id` (ABI_TRI_*) computes. */
enum twin_formula twin_of_tri(uint32_t id);

/* Evaluates one triangle. The ray is in contract (ray_in_contract). */
struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3]);

#endif

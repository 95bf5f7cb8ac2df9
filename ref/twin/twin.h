/* Twins: the triangle tests with a proven bound on the rounding error of each value. They tell
 * which signs are right in every engine of that formula, and how far its t may be off. Running
 * error analysis: Wilkinson 1963; Higham 2002, section 3.3.
 *
 * A rounding (ref/twin/model.h) allows many evaluations of one formula: either neighbour, an
 * inexact division, flushed or fused operations. Everything here holds for each of them and is
 * measured from the exact value, so that an engine is judged by its answer alone, whatever bits its
 * twin would have computed. Derivation: docs/numerics.md. */
#ifndef TWIN_H
#define TWIN_H

#include "ref/twin/model.h"
#include "ref/primitives/primitives.h"
#include "ref/scene/scene.h"

#include <stdbool.h>

struct twin {
    bool possible; /* some evaluation accepts the triangle; if not, an answer that names it is
                      wrong */
    bool certain;  /* every evaluation accepts it, and the exact ray hits its inside in range */
    bool beyond;   /* t is certainly outside [tmin, tmax] */
    int edge[3];   /* proven sign of the edge function opposite vertex i, exact and of every
                      evaluation; 0: open. The sign is the formula's own: compare it with det */
    int det;       /* proven sign of the determinant; 0: open, or not surely over a threshold */
    float t, u, v; /* one evaluation, that of C: with another rounding the engine's may differ, and
                      they may be infinite or NaN. u weighs vertex 1, v vertex 2 */
    double t_err;  /* |engine's t - exact t| is at most this; infinite if the determinant's sign is
                      open or a value may overflow; never NaN */
    double u_err, v_err;           /* likewise */
    double t_near, u_near, v_near; /* the exact values: u and v to 2^-28 of a finite bound */
    double t_off; /* |t_near - exact t| is at most this where t_err is finite, which is at least 4
                     times as large; the engine's t is also within t_err of t_near */
};

/* The formula that triangle test `id` (ABI_TRI_*) computes. */
enum twin_formula twin_of_tri(uint32_t id);

/* The model of a triangle test whose operations round so; `bits`: C's bits may be demanded. */
struct model model_of_tri(const struct tri_test *tri, struct rounding rounding, bool bits);

/* The axis of the ray that is axis k of the formula: woop turns them. */
void twin_axes(enum twin_formula formula, const struct ray *ray, int axis[3]);

/* Evaluates one triangle. The ray is in contract (ray_in_contract); every k of `rounding` is at
 * least 1. */
struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3]);

/* A ray and a triangle of a scene. */
struct twin_pair {
    const struct ray *ray;
    uint32_t prim;
};

/* Evaluates many, the same twins as twin_eval of each but t, u and v, which may be NaN: by vectors
 * of the widest kind that runs here, several times as fast. */
void twin_eval_many(enum twin_formula formula, struct rounding rounding, const struct scene *scene,
                    const struct twin_pair *pair, size_t count, struct twin *out);

/* The same by a kind of vectors, for tests. */
struct twin_kernel;
void twin_eval_by(const struct twin_kernel *kernel, enum twin_formula formula,
                  struct rounding rounding, const struct scene *scene, const struct twin_pair *pair,
                  size_t count, struct twin *out);

#endif

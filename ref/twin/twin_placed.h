/* Twins of placed triangles: the same formulas on a ray that an engine of ours took into the
 * space of the mesh (ref/world/object_ray.h), so that its numbers carry errors of their own. The
 * exact ray there is M^-1 (o - T), M^-1 d of real numbers; t is the same as in the world. What is
 * proven is proven for the exact ray and for every evaluation, as in ref/twin/twin.h. Derivation:
 * docs/numerics.md, "Twins of placed triangles". */
#ifndef TWIN_PLACED_H
#define TWIN_PLACED_H

#include "ref/twin/twin.h"
#include "ref/world/world.h"

/* A transform as the twins need it. */
struct twin_place {
    bool identity;  /* rays are taken as they are */
    float w[9];     /* the inverse of M, row by row, each number rounded to the nearest float32 */
    double near[9]; /* the exact inverse, to 2^-52 of itself */
    double off[9];  /* |w - exact| is at most this; 0: equal */
    float t[3];
    double kappa; /* largest row sum of |M| |M^-1|: 1 or more, to 2^-40 of itself */
};

/* The transform of an instance that world_finish passed. Errors: STATUS_LIMIT a number of the
 * inverse rounds to infinity: row and column. */
enum status twin_place_of(const struct instance *instance, struct twin_place *out,
                          struct reason *reason) MUST_USE;

/* A ray of the world in the space of a mesh. */
struct twin_ray {
    const struct twin_place *place;
    struct ray world;
    struct ray ray;                  /* in the space of the mesh, as C computes it */
    double org_near[3], dir_near[3]; /* the exact one, to 2^-28 of its bound */
    double org_off[3], dir_off[3];   /* of every evaluation from the exact one, at most; may be
                                        infinite */
    bool in_contract;                /* ray_in_contract of every evaluation */
};

/* Takes a ray along. `place` is borrowed. fuses: a product that is added may be left unrounded;
 * with IEEE's rounding and without it C's evaluation is the only one. The ray is finite (tmax may
 * be infinite). */
void twin_ray_of(const struct twin_place *place, struct rounding rounding, bool fuses,
                 const struct ray *ray, struct twin_ray *out);

/* The twin of a triangle of the mesh; that of twin_eval, bit for bit, where the place is the
 * identity. twin->t, u and v are C's. The ray is finite, the formula one of ref/primitives/. */
struct twin twin_eval_placed(enum twin_formula formula, struct rounding rounding,
                             const struct twin_ray *ray, float v[3][3]);

/* A ray and a triangle of the mesh that it was taken to. */
struct twin_placed_pair {
    const struct twin_ray *ray;
    const struct scene *scene;
    uint32_t prim;
};

/* Evaluates many: the same twins as twin_eval_placed of each, but t, u and v, which may be NaN. */
void twin_eval_placed_many(enum twin_formula formula, struct rounding rounding,
                           const struct twin_placed_pair *pair, size_t count, struct twin *out);

/* The axes of the ray that may be axes 0, 1, 2 of the formula, C's first: at most one order for
 * each axis that may be the longest of the direction. Returns how many. */
int twin_placed_axes(enum twin_formula formula, const struct twin_ray *ray, int axis[3][3]);

/* Sign of d . ((v1 - v0) x (v2 - v0)) in the space of the mesh, by which engines tell front from
 * back, if it is that of the exact value and of every evaluation; else 0. */
int twin_placed_side(struct rounding rounding, const struct twin_ray *ray, float v[3][3]);

#endif

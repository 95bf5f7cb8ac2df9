/* One ray and one triangle in integers: __int128 where the exponents allow it, else wide. */
#ifndef ORACLE_EXACT_H
#define ORACLE_EXACT_H

#include "ref/abi.h"
#include "ref/integers/fraction.h"
#include "ref/world/world.h"

/* Signs and quotients of w0, w1, w2, D and T. */
struct exact {
    int edge[3];       /* signs of w0, w1, w2 */
    int det;           /* sign of D */
    bool in_plane;     /* D == 0 == T and the direction is not 0: see exact_in_plane */
    bool wide;         /* __int128 did not suffice */
    double edge_share; /* the smallest w_i / D, to about 2^-50; -INFINITY if D is 0; this and
                          t are not set for a miss if `hits` */
    struct fraction t; /* T / D, if D is not 0 */
};

/* The direction is 0: the ray hits nothing. */
static inline bool ray_is_still(const struct ray *ray)
{
    return ray->dir[0] == 0 && ray->dir[1] == 0 && ray->dir[2] == 0;
}

/* Below, `at` is the instance that has placed the triangle, or NULL: its vertices are v. */

/* Decides a finite ray and triangle, whatever the range of t. `hits`: of a miss only the signs are
 * needed. */
void exact_pair(const struct ray *ray, float v[3][3], const struct instance *at, bool hits,
                struct exact *out);

/* The weights of vertices 1 and 2, w1 / D and w2 / D. D is not 0. */
void exact_weights(const struct ray *ray, float v[3][3], const struct instance *at,
                   struct fraction out[2]);

/* For a ray in the plane of a triangle that has an area: where the line overlaps the triangle.
 * Returns false if it passes beside it; else *in <= *out, equal if it only touches a vertex. */
bool exact_in_plane(const struct ray *ray, float v[3][3], const struct instance *at,
                    struct fraction *in, struct fraction *out);

/* Whether the vertices are collinear. An instance does not change that: its M is invertible. */
bool exact_no_area(float v[3][3]);

#endif

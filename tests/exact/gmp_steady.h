/* What stays true of a ray and a placed triangle however its vertices are moved by up to `reach`:
 * proofs against an engine whose formula is not known, by rationals.
 *
 * A moved vertex takes each edge, a set of mixtures of two vertices, no farther than itself. So a
 * line whose distance to the lines of all edges is more than `reach` hits what it hit and misses
 * what it missed. Seen along d the triangle has the heights |D| / |d x e|, which shrink by at most
 * 2 reach; while they are positive the same side is seen. A hit of a moved triangle is no farther
 * than `reach` from a point of the triangle, so n . (o + t' d - v0) is at most |n| reach, and t'
 * within |n| reach / |D| of t. */
#ifndef GMP_STEADY_H
#define GMP_STEADY_H

#include "tests/exact/gmp_world.h"

/* A triangle's lengths, exactly, as squares. */
struct gmp_steady {
    mpq_t det, normal;           /* D squared; |n| squared */
    mpq_t along[3], distance[3]; /* |d x e| squared of each edge; ((v - o) . (d x e)) squared */
    mpq_t reach;                 /* squared */
};

void gmp_steady_init(struct gmp_steady *steady);
void gmp_steady_clear(struct gmp_steady *steady);

/* Loads a placed triangle. Its reach is what a tracer of float32 may be off by: 32 u times the
 * largest distance of a vertex from the origin, and 64 kappa u (|o| + |T| + |o + t d|) for the way
 * into an instance that is not at the identity; u = 2^-24, kappa as in
 * tests/exact/gmp_object_ray.h. `pair` is the triangle's. */
void gmp_steady_load(const struct world *world, const struct ray *ray, uint32_t prim,
                     const struct gmp_pair *pair, struct gmp_steady *out);

bool gmp_steady_hit(const struct gmp_steady *steady);  /* hit stays hit, missed stays missed */
bool gmp_steady_side(const struct gmp_steady *steady); /* so does the side that is seen */

/* Whether t of a moved triangle is below x (-1) or above it (1); 0: it can be x, which may be
 * infinite. */
int gmp_steady_t(const struct gmp_steady *steady, const mpq_t t, double x);

/* Whether the point that u and v name of the triangle lies farther from the line of the ray than
 * `reach`, and half as much for the roundings of u and v: a moved triangle's own such point is no
 * farther from it than `reach`, and on the line if that is where it is hit. u, v in [0, 1]. */
bool gmp_steady_beside(const struct world *world, const struct ray *ray, uint32_t prim,
                       const struct gmp_steady *steady, float u, float v);

/* By how much a weight can change, or infinity. */
double gmp_steady_weight(const struct gmp_steady *steady);

#endif

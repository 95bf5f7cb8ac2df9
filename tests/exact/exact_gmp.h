/* The same question as the oracle's, answered by another road: GMP rationals, the system
 *   o + t d = v0 + u (v1 - v0) + v (v2 - v0)
 * solved by Gaussian elimination, straight from the definition. Shares no code and no formula with
 * ref/oracle/; only the names of the classes. For tests and for deciding a verdict again. */
#ifndef EXACT_GMP_H
#define EXACT_GMP_H

#include "ref/oracle/oracle.h"

#include <gmp.h>

struct gmp_pair {
    enum oracle_class class;
    enum oracle_range range; /* meaningless for MISS and ZERO_AREA */
    mpq_t t, t_out;          /* hit: t; in plane: the overlap [t, t_out], not cut by the range */
    bool point;              /* line and plane meet in one point: t, weight and side are set */
    mpq_t weight[3];         /* barycentric weights of that point, even outside */
    int side[3];             /* their signs */
};

void exact_gmp_init(struct gmp_pair *pair);
void exact_gmp_clear(struct gmp_pair *pair);

/* Decides one finite ray and triangle; tmax may be infinite. `pair` has been initialised. */
void exact_gmp_pair(const struct ray *ray, float v[3][3], struct gmp_pair *pair);

/* The same of a triangle whose vertices are any rationals. */
void exact_gmp_pair_at(const struct ray *ray, mpq_t v[3][3], struct gmp_pair *pair);

/* True if two edge products are of surely opposite sign, by more than any float32 formula errs
 * (2^-16 of the product of the vectors' lengths; some 2^-19 is possible): it spares the rationals
 * what is far off.
 *   a      the vertices, relative to the ray's origin
 *   slack  by how much each of their coordinates may be off */
bool exact_gmp_far_off(const struct ray *ray, long double a[3][3], long double slack);

/* Sign of a - x; x may be infinite. */
int exact_gmp_compare(const mpq_t a, double x);

/* Whether a pair is a hit in range, ends counted as `ends` says. */
bool exact_gmp_hits(const struct gmp_pair *pair, enum oracle_ends ends);

/* The exact nearest set over all triangles of a scene. */
struct gmp_nearest {
    uint32_t prim;  /* smallest index at the smallest t, ABI_NO_PRIM: none */
    uint32_t count; /* size of the set */
    bool in_plane;  /* some triangle has the ray in its plane, in range, from no later than t on */
    bool in_plane_close; /* or from 2^-38 later on */
    mpq_t t, next;       /* t of the set and of the next hit; next is -1 without one (has_next) */
    bool has_next;
};

void exact_gmp_nearest(const struct scene *scene, const struct ray *ray, enum oracle_ends ends,
                       struct gmp_nearest *out); /* made by exact_gmp_nearest_init */
/* Adds a hit in range to the set. */
void exact_gmp_take(struct gmp_nearest *out, uint32_t prim, const mpq_t t);
void exact_gmp_nearest_init(struct gmp_nearest *nearest);
void exact_gmp_nearest_clear(struct gmp_nearest *nearest);

#endif

/* The double filter of one pair: w, D and T with proven bounds on their rounding errors.
 *
 * w0 = d . (B x (v2 - v1)) and its like; D = d . N and T = A . N with N = (v1 - v0) x (v2 - v0):
 * the same numbers as in oracle.h, but of small terms where the triangle is small.
 * Each difference of two float32 has one rounding, each term of a sum at most 8 in all, each a
 * factor 1 + e with |e| <= 2^-53; so |computed - exact| <= gamma_8 * perm, where perm is the same
 * expression with every term taken positive (Higham 2002, lemma 3.1). perm is computed too, no less
 * than (1 - 2^-53)^8 of its exact value; 9 * 2^-53 covers that. Nothing of degree 3 or 4 in float32
 * overflows or underflows in double: it lies in 2^-596 .. 2^520 or is 0. Only true without fma,
 * without FTZ and DAZ and with rounding to nearest. */
#ifndef ORACLE_FILTER_H
#define ORACLE_FILTER_H

#include "ref/abi.h"

#include <stdbool.h>

/* The same of a component of N: 4 roundings a term. */
#define FILTER_FLAT (6 * 0x1p-53)

struct filter {
    double a[3][3], d[3]; /* vertices relative to the origin, and the direction */
    double e[3][3];       /* edges: v[c + 2] - v[c + 1], opposite vertex c */
    double w[3], w_err[3];
    double det, det_err;
    double t, t_err; /* T, not divided */
};

/* Fills in a, d, e, w and w_err, then det and t, for a pair of finite numbers. */
void filter_edges(const struct ray *ray, float v[3][3], struct filter *out);
void filter_plane(struct filter *out);

/* Whether the vertices certainly are not collinear. */
bool filter_has_area(float v[3][3]);

/* -1, 1, or 0 if value may have either sign. */
static inline int filter_sign(double value, double err)
{
    return value > err ? 1 : value < -err ? -1 : 0;
}

#endif

/* One ray and one triangle in __int128, where the exponents lie close enough together. For the
 * oracle's own files.
 *
 * Vertices and origin share one grid, the direction has its own: with P the coordinates' unit and Q
 * the direction's, w and D come in units of P^2 Q, T in units of P^3, so that t = T / D * P / Q. */
#ifndef ORACLE_SMALL_H
#define ORACLE_SMALL_H

#include "ref/abi.h"
#include "ref/integers/fraction.h"

/* Vertices relative to the origin, and the direction, in their units; how many bits they take. */
struct small {
    int64_t a[3][3], d[3];
    int place_bits, way_bits;
    int scale; /* t is T / D * 2^scale */
};

/* Returns false if the exponents lie too far apart for that. */
bool small_make(const struct ray *ray, float v[3][3], struct small *out);

struct small_products {
    __int128 w[3], det, t;
};

/* Returns false if they do not fit. */
bool small_multiply(const struct small *small, struct small_products *out);

static inline int sign_of(__int128 x)
{
    return (x > 0) - (x < 0);
}

/* Widens the overlap [*in, *out] by a point, which is the first one if there is not *any. */
void overlap_add(const struct fraction *t, bool *any, struct fraction *in, struct fraction *out);

/* Where the line overlaps a triangle that has an area and in whose plane it lies. Returns false if
 * the numbers do not fit; else *any says whether there is an overlap, from *in to *out. */
bool small_in_plane(const struct small *small, bool *any, struct fraction *in,
                    struct fraction *out);

#endif

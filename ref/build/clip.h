/* Parts of triangles, as spatial splits make them. */
#ifndef CLIP_H
#define CLIP_H

#include "ref/scene/scene.h"

#include <stdint.h>

/* A triangle or a part of it: all of the triangle that lies in the cell of space it was cut out for
 * lies in the box, too. */
struct part {
    struct box box;
    uint32_t prim;
};

/* Cuts `box` down to bounds of what triangle `v` has between `lo` and `hi` of axis `axis`; empty
 * (lo > hi) if that is nothing. Never less than the exact bounds of the triangle in both.
 *
 * Proof. The corners of the triangle between two planes are its vertices there, and the points
 * where its edges p q cross the planes. Such a point's coordinate is p + (q - p) t with t = (s -
 * p_k) / (q_k - p_k); of floats, in double, with e = 2^-53: t has an error of 3.01 e of itself and
 * is at most 1, the product of 5.02 e |q - p|, and the sum adds e of itself, together less than 6.1
 * e (|p|
 * + |q|). That is CLIP_ERROR's 8 e, which is added before the point is rounded to floats outward.
 * No operation overflows, and none underflows: differences of floats are 0 or at least 2^-149. */
void clip_between(float v[3][3], int axis, float lo, float hi, struct box *box);

/* Cuts `box` down to bounds of what triangle `v` has in it, along all axes. Not the tightest: an
 * axis after the other, twice. */
void clip_inside(float v[3][3], struct box *box);

static inline bool clip_is_empty(const struct box *box)
{
    return !(box->lo[0] <= box->hi[0] && box->lo[1] <= box->hi[1] && box->lo[2] <= box->hi[2]);
}

#endif

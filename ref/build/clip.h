/* Parts of triangles, made by spatial splits. */
#ifndef CLIP_H
#define CLIP_H

#include "ref/scene/scene.h"

#include <stdint.h>

/* A triangle or a part of it. The box contains everything of the triangle that lies in the cell of
 * space for which the part was cut. */
struct part {
    struct box box;
    uint32_t prim;
};

/* Cuts `box` down to bounds of the part of triangle `v` between `lo` and `hi` of axis `axis`; empty
 * (lo > hi) if there is none. Never less than the exact bounds of the triangle in both.
 *
 * Proof. The corners of the triangle between two planes are its vertices there, and the points
 * where its edges p q cross the planes. The coordinate of such a point is p + (q - p) t with t = (s
 * - p_k) / (q_k - p_k). For floats, computed in double, with e = 2^-53: t has a relative error of
 * 3.01 e and is at most 1, the product has an error of 5.02 e |q - p|, and the sum adds a relative
 * error of e, together less than 6.1 e (|p| + |q|). CLIP_ERROR's 8 e covers this; it is added
 * before the point is rounded to floats outward. No operation overflows, and none underflows:
 * differences of floats are 0 or at least 2^-149. */
void clip_between(float v[3][3], int axis, float lo, float hi, struct box *box);

/* Cuts `box` down to bounds of the part of triangle `v` in it, along all axes. The bounds are not
 * the tightest: axes are cut one after the other, twice. */
void clip_inside(float v[3][3], struct box *box);

/* Cuts a part of triangle `v` in two at a plane inside its box; returns one bit for each piece that
 * is not empty. */
int part_cut(float v[3][3], const struct part *part, int axis, float at, struct part piece[2]);

static inline bool clip_is_empty(const struct box *box)
{
    return !(box->lo[0] <= box->hi[0] && box->lo[1] <= box->hi[1] && box->lo[2] <= box->hi[2]);
}

#endif

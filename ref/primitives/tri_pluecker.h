/* Ray against triangle in Pluecker coordinates: on which side of each edge the ray passes. */
#ifndef TRI_PLUECKER_H
#define TRI_PLUECKER_H

#include "ref/primitives/tri.h"

static inline void tri_cross(const float a[3], const float b[3], float out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline float tri_dot(const float a[3], const float b[3])
{
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* The edge from P to Q, both relative to the origin, is passed on the side given by the sign of ((P
 * + Q) x (Q - P)) . d: twice the signed volume of P, Q and d, as in Embree's robust test
 * (kernels/geometry/triangle_intersector_pluecker.h; the idea: Teller 1992, Amanatides and Choi
 * 1997). We differ from Embree in three points. Q - P is computed from the vertices as stored,
 * exact for neighbours, not from the vertices relative to the origin, so the error is of size |Q -
 * P| |P|, not
 * P|^2. A ray is accepted if no side has the other sign, without a band. The determinant must have
 * the sign of the sides.
 *
 * Closed: a side of zero counts as inside. Miss: a determinant or a sum of sides that is zero (rays
 * in the plane, triangles without area), NaN anywhere. t is not range-tested.
 *
 * Guarantee for shared edges: for the triangle on the other side of the edge, Q - P is negated and
 * P + Q is the same, so the side is the same number with the other sign, whatever is rounded to
 * nearest. Two triangles never both reject a ray at the edge between them. But the sides of the
 * edges around one vertex are rounded separately, and need not fit any position of the vertex: all
 * triangles of a fan can reject a ray that passes the vertex within rounding. So this test is not
 * watertight (docs/traversal.md has how often it leaks). */
static inline bool tri_pluecker(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float a[3][3], e[3][3], w[3], n[3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            a[c][k] = v[c][k] - r->o[k];
    for (int c = 0; c < 3; c++) { /* edge c is opposite vertex c */
        int p = c == 2 ? 0 : c + 1, q = c == 0 ? 2 : c - 1;
        float sum[3], side[3];
        for (int k = 0; k < 3; k++) {
            sum[k] = a[p][k] + a[q][k];
            e[c][k] = v[q][k] - v[p][k];
        }
        tri_cross(sum, e[c], side);
        w[c] = tri_dot(r->d, side);
    }
    tri_cross(e[1], e[2], n);
    float det = tri_dot(r->d, n), all = (w[0] + w[1]) + w[2];
    bool back = det < 0.0f && w[0] <= 0.0f && w[1] <= 0.0f && w[2] <= 0.0f && all < 0.0f;
    bool front = det > 0.0f && w[0] >= 0.0f && w[1] >= 0.0f && w[2] >= 0.0f && all > 0.0f;
    if (!(front || back))
        return false;
    out->t = tri_dot(a[0], n) / det;
    out->u = w[1] / all;
    out->v = w[2] / all;
    return true;
}

#endif

/* Ray against triangle in the triangle's own coordinates. */
#ifndef TRI_BALDWIN_WEBBER_H
#define TRI_BALDWIN_WEBBER_H

#include "ref/primitives/tri_pluecker.h"

/* Baldwin and Weber 2016, "Fast Ray-Triangle Intersections by Coordinate Transformation" (JCGT
 * 5:3), section 3: the affine map that takes the vertices to (0,0,0), (1,0,0), (0,1,0) and one
 * coordinate axis to (0,0,1). That axis, c, is the one along which the normal is largest (the first
 * of equal ones); a and b are the next two in x y z x y. The column of c in the matrix is
 * (0, 0, 1), and the rows of u, v and height are
 *
 *   m[0] p[a] + m[1] p[b] + m[2],  m[3] p[a] + m[4] p[b] + m[5],  p[c] + m[6] p[a] + m[7] p[b] +
 * m[8]
 *
 * Returns c. Triangle storage keeps these bits, so the order of operations is part of the format;
 * written separately in shaders/tri.glsl. We differ from the paper in its last column: m[2], m[5]
 * and m[8] are computed from the rounded coefficients so that they take vertex 0 to zero; separate
 * quotients would err by |v|^2 / |n|. A triangle without area, or with NaN, gets rows that contain
 * no point: u = -1 everywhere. */
static inline int baldwin_webber_transform(float v[3][3], float m[9])
{
    float e1[3], e2[3], n[3], size[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
    }
    tri_cross(e1, e2, n);
    for (int k = 0; k < 3; k++)
        size[k] = n[k] < 0.0f ? -n[k] : n[k];
    int c = size[1] > size[0] ? 1 : 0;
    c = size[2] > size[c] ? 2 : c;
    if (!(n[c] < 0.0f || n[c] > 0.0f)) {
        for (int i = 0; i < 9; i++)
            m[i] = i == 2 ? -1.0f : 0.0f;
        return 0;
    }
    int a = c == 2 ? 0 : c + 1, b = a == 2 ? 0 : a + 1;
    m[0] = e2[b] / n[c];
    m[1] = -e2[a] / n[c];
    m[2] = -(m[0] * v[0][a] + m[1] * v[0][b]);
    m[3] = -e1[b] / n[c];
    m[4] = e1[a] / n[c];
    m[5] = -(m[3] * v[0][a] + m[4] * v[0][b]);
    m[6] = n[a] / n[c];
    m[7] = n[b] / n[c];
    m[8] = -((v[0][c] + m[6] * v[0][a]) + m[7] * v[0][b]);
    return c;
}

/* The test with a precomputed transform: the ray's height over the plane at the origin and per unit
 * of t, then u and v of the point. Closed in u, v and 1 - u - v. A ray parallel to the plane is a
 * miss, and so is NaN anywhere. t is not range-tested. The last column is as large as the
 * coordinates, so the error grows with the triangle's distance from the world's origin. */
static inline bool baldwin_webber_hit(const struct tri_ray *r, const float m[9], int c,
                                      struct hit *out)
{
    int a = c == 2 ? 0 : c + 1, b = a == 2 ? 0 : a + 1;
    float height = ((r->o[c] + m[6] * r->o[a]) + m[7] * r->o[b]) + m[8];
    float climb = (r->d[c] + m[6] * r->d[a]) + m[7] * r->d[b];
    float t = -height / climb;
    float pa = r->o[a] + t * r->d[a], pb = r->o[b] + t * r->d[b];
    float u = (m[0] * pa + m[1] * pb) + m[2];
    float w = (m[3] * pa + m[4] * pb) + m[5];
    if (!(climb < 0.0f || climb > 0.0f))
        return false;
    if (!(u >= 0.0f && w >= 0.0f && u + w <= 1.0f))
        return false;
    out->t = t;
    out->u = u;
    out->v = w;
    return true;
}

static inline bool tri_baldwin_webber(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float m[9];
    int c = baldwin_webber_transform(v, m);
    return baldwin_webber_hit(r, m, c, out);
}

#endif

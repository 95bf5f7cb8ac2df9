/* Ray against triangle by a plane and two lines that are made once. */
#ifndef ACCEL_H
#define ACCEL_H

#include "ref/primitives/tri_baldwin_webber.h"

/* Wald 2004, "Realtime Ray Tracing and Interactive Global Illumination", section 7.1: a triangle is
 * projected along the axis k of the largest component of its normal; u and v are the next two in
 * x y z x y. The plane is n_d = p[k] + n_u p[u] + n_v p[v], and the weights of vertex 1 and vertex
 * 2 are b_nu p[u] + b_nv p[v] + b_d and c_nu p[u] + c_nv p[v] + c_d. The numbers are those of
 * baldwin_webber_transform, which also made the constants of rounded coefficients. A triangle
 * without area gets a weight of -1 everywhere. */
struct tri_accel {
    float n_u, n_v, n_d;
    uint32_t k;
    float b_nu, b_nv, b_d;
    uint32_t prim;
    float c_nu, c_nv, c_d;
    uint32_t unused; /* 48 bytes: three loads of 16 */
};

_Static_assert(sizeof(struct tri_accel) == 48, "a triangle has 48 bytes");

static inline struct tri_accel tri_accel_make(float v[3][3], uint32_t prim)
{
    float m[9];
    int k = baldwin_webber_transform(v, m);
    return (struct tri_accel){.n_u = m[6],
                              .n_v = m[7],
                              .n_d = -m[8],
                              .k = (uint32_t)k,
                              .b_nu = m[0],
                              .b_nv = m[1],
                              .b_d = m[2],
                              .prim = prim,
                              .c_nu = m[3],
                              .c_nv = m[4],
                              .c_d = m[5]};
}

/* The published test: one reciprocal, then t, then the weights of the point. The range is closed,
 * and so are the weights and their sum. Where the ray is parallel to the plane the reciprocal is
 * infinite, so that no weight is finite: a miss, as is NaN anywhere. Its twin: TWIN_TRI_ACCEL. */
static inline bool tri_accel_hit(const struct tri_accel *a, const float o[3], const float d[3],
                                 float tmin, float tmax, struct hit *out)
{
    uint32_t k = a->k, u = k == 2 ? 0 : k + 1, v = u == 2 ? 0 : u + 1;
    float nd = 1.0f / ((d[k] + a->n_u * d[u]) + a->n_v * d[v]);
    float t = (((a->n_d - o[k]) - a->n_u * o[u]) - a->n_v * o[v]) * nd;
    if (!(t >= tmin && t <= tmax))
        return false;
    float hu = o[u] + t * d[u], hv = o[v] + t * d[v];
    float lambda = (a->b_nu * hu + a->b_nv * hv) + a->b_d;
    float mue = (a->c_nu * hu + a->c_nv * hv) + a->c_d;
    if (!(lambda >= 0.0f && mue >= 0.0f && lambda + mue <= 1.0f))
        return false;
    *out = (struct hit){.t = t, .u = lambda, .v = mue, .prim = a->prim};
    return true;
}

#endif

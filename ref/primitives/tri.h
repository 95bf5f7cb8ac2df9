/* Ray against triangle, f32, double-sided. The shader has the same operations in the same order,
 * written separately (shaders/tri.glsl). Running-error twins are in ref/twin/twin.c. */
#ifndef TRI_H
#define TRI_H

#include "ref/abi.h"

#include <stdbool.h>

/* mt_rtrs: |determinant| at or below this is a miss, whatever the scale (F16). */
#define TRI_RTRS_EPS 1e-7f

/* Ray data for the triangle tests, computed once per ray. Only woop uses the shear. */
struct tri_ray {
    float o[3];
    float d[3];
    float tmin, tmax;
    int kx, ky, kz;   /* woop: kz is the largest axis of |d|, kx and ky swapped if d[kz] < 0 */
    float sx, sy, sz; /* woop: shear */
};

static inline struct tri_ray tri_ray_make(const struct ray *ray)
{
    struct tri_ray r = {.tmin = ray->tmin, .tmax = ray->tmax};
    float a[3];
    for (int k = 0; k < 3; k++) {
        r.o[k] = ray->org[k];
        r.d[k] = ray->dir[k];
        a[k] = r.d[k] < 0.0f ? -r.d[k] : r.d[k];
    }
    r.kz = a[1] > a[0] ? 1 : 0;
    r.kz = a[2] > a[r.kz] ? 2 : r.kz;
    r.kx = r.kz == 2 ? 0 : r.kz + 1;
    r.ky = r.kx == 2 ? 0 : r.kx + 1;
    if (r.d[r.kz] < 0.0f) {
        int swap = r.kx;
        r.kx = r.ky;
        r.ky = swap;
    }
    r.sx = r.d[r.kx] / r.d[r.kz];
    r.sy = r.d[r.ky] / r.d[r.kz];
    r.sz = 1.0f / r.d[r.kz];
    return r;
}

/* Moeller and Trumbore 1997, undivided until the end, without culling. `eps` is the determinant's
 * threshold: 0 accepts everything but exact zero. Closed in u, v, w; t is not range-tested. NaN
 * anywhere is a miss. Takes a vertex and the edges from it to vertices 1 and 2. */
static inline bool tri_moeller_trumbore_edges(const struct tri_ray *r, const float v0[3],
                                              const float e1[3], const float e2[3], float eps,
                                              struct hit *out)
{
    float s[3], p[3], q[3];
    for (int k = 0; k < 3; k++)
        s[k] = r->o[k] - v0[k];
    p[0] = r->d[1] * e2[2] - r->d[2] * e2[1];
    p[1] = r->d[2] * e2[0] - r->d[0] * e2[2];
    p[2] = r->d[0] * e2[1] - r->d[1] * e2[0];
    q[0] = s[1] * e1[2] - s[2] * e1[1];
    q[1] = s[2] * e1[0] - s[0] * e1[2];
    q[2] = s[0] * e1[1] - s[1] * e1[0];
    float det = (e1[0] * p[0] + e1[1] * p[1]) + e1[2] * p[2];
    float u = (s[0] * p[0] + s[1] * p[1]) + s[2] * p[2];
    float w = (r->d[0] * q[0] + r->d[1] * q[1]) + r->d[2] * q[2];
    float t = (e2[0] * q[0] + e2[1] * q[1]) + e2[2] * q[2];
    float size = det < 0.0f ? -det : det;
    if (!(size > eps))
        return false;
    float us = det < 0.0f ? -u : u;
    float ws = det < 0.0f ? -w : w;
    if (!(us >= 0.0f && us <= size && ws >= 0.0f && us + ws <= size))
        return false;
    out->t = t / det;
    out->u = u / det;
    out->v = w / det;
    return true;
}

static inline bool tri_moeller_trumbore(const struct tri_ray *r, float v[3][3], float eps,
                                        struct hit *out)
{
    float e1[3], e2[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
    }
    return tri_moeller_trumbore_edges(r, v[0], e1, e2, eps, out);
}

/* Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", without the fallback to
 * double. An edge function that rounds to zero counts as on the edge. This keeps the test
 * watertight if nothing is contracted: the sign is never wrong, since rounding is monotone. */
static inline bool tri_woop(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float x[3], y[3], z[3];
    for (int c = 0; c < 3; c++) {
        float ax = v[c][r->kx] - r->o[r->kx];
        float ay = v[c][r->ky] - r->o[r->ky];
        float az = v[c][r->kz] - r->o[r->kz];
        x[c] = ax - r->sx * az;
        y[c] = ay - r->sy * az;
        z[c] = r->sz * az;
    }
    float w0 = x[2] * y[1] - y[2] * x[1];
    float w1 = x[0] * y[2] - y[0] * x[2];
    float w2 = x[1] * y[0] - y[1] * x[0];
    if ((w0 < 0.0f || w1 < 0.0f || w2 < 0.0f) && (w0 > 0.0f || w1 > 0.0f || w2 > 0.0f))
        return false;
    float det = (w0 + w1) + w2;
    if (!(det > 0.0f || det < 0.0f)) /* zero and NaN */
        return false;
    float t = (w0 * z[0] + w1 * z[1]) + w2 * z[2];
    out->t = t / det;
    out->u = w1 / det;
    out->v = w2 / det;
    return true;
}

#endif

#include "ref/explain/fused.h"

#include <math.h>

/* a * b - c * d, as gcc contracts it. */
static float difference(float a, float b, float c, float d)
{
    return fmaf(a, b, -(c * d));
}

/* (a0 * b0 + a1 * b1) + a2 * b2 */
static float product(const float a[3], const float b[3])
{
    return fmaf(a[2], b[2], fmaf(a[0], b[0], a[1] * b[1]));
}

static void cross(const float a[3], const float b[3], float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = difference(a[(k + 1) % 3], b[(k + 2) % 3], a[(k + 2) % 3], b[(k + 1) % 3]);
}

static bool moeller_trumbore(const struct tri_ray *r, float v[3][3], float eps, struct hit *out)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
        s[k] = r->o[k] - v[0][k];
    }
    cross(r->d, e2, p);
    cross(s, e1, q);
    float det = product(e1, p), u = product(s, p), w = product(r->d, q), t = product(e2, q);
    float size = fabsf(det);
    if (!(size > eps))
        return false;
    float us = det < 0.0f ? -u : u, ws = det < 0.0f ? -w : w;
    if (!(us >= 0.0f && us <= size && ws >= 0.0f && us + ws <= size))
        return false;
    *out = (struct hit){t / det, u / det, w / det, 0};
    return true;
}

static bool woop(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float x[3], y[3], z[3], w[3];
    for (int c = 0; c < 3; c++) {
        float az = v[c][r->kz] - r->o[r->kz];
        x[c] = fmaf(-r->sx, az, v[c][r->kx] - r->o[r->kx]);
        y[c] = fmaf(-r->sy, az, v[c][r->ky] - r->o[r->ky]);
        z[c] = r->sz * az;
    }
    for (int i = 0; i < 3; i++)
        w[i] = difference(x[(i + 2) % 3], y[(i + 1) % 3], y[(i + 2) % 3], x[(i + 1) % 3]);
    if ((w[0] < 0.0f || w[1] < 0.0f || w[2] < 0.0f) && (w[0] > 0.0f || w[1] > 0.0f || w[2] > 0.0f))
        return false;
    float det = (w[0] + w[1]) + w[2];
    if (!(det > 0.0f || det < 0.0f))
        return false;
    *out = (struct hit){product(w, z) / det, w[1] / det, w[2] / det, 0};
    return true;
}

bool fused_tri_run(uint32_t id, const struct tri_ray *r, float v[3][3], struct hit *out)
{
    bool hit = id == ABI_TRI_WOOP
                   ? woop(r, v, out)
                   : moeller_trumbore(r, v, id == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0f, out);
    if (!hit)
        return false;
    if (id == ABI_TRI_MT_RTRS)
        return out->t > r->tmin && out->t < r->tmax;
    return out->t >= r->tmin && out->t <= r->tmax;
}

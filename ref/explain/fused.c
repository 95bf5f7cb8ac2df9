#include "ref/explain/fused.h"
#include "ref/primitives/test_run.h"

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

/* The edges from vertex 0. */
static void edges_of(float v[3][3], float e1[3], float e2[3])
{
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
    }
}

static bool moeller_trumbore(const struct tri_ray *r, float v[3][3], float eps, struct hit *out)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    edges_of(v, e1, e2);
    for (int k = 0; k < 3; k++)
        s[k] = r->o[k] - v[0][k];
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

static bool pluecker(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float a[3][3], e[3][3], w[3], n[3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            a[c][k] = v[c][k] - r->o[k];
    for (int c = 0; c < 3; c++) {
        const int p = (c + 1) % 3, q = (c + 2) % 3;
        float sum[3], side[3];
        for (int k = 0; k < 3; k++) {
            sum[k] = a[p][k] + a[q][k];
            e[c][k] = v[q][k] - v[p][k];
        }
        cross(sum, e[c], side);
        w[c] = product(r->d, side);
    }
    cross(e[1], e[2], n);
    float det = product(r->d, n), sum = (w[0] + w[1]) + w[2], sign = det < 0.0f ? -1.0f : 1.0f;
    if (!(det < 0.0f || det > 0.0f) || !(sign * sum > 0.0f))
        return false;
    if (!(sign * w[0] >= 0.0f && sign * w[1] >= 0.0f && sign * w[2] >= 0.0f))
        return false;
    *out = (struct hit){product(a[0], n) / det, w[1] / sum, w[2] / sum, 0};
    return true;
}

/* The axis of the transform; false without area. */
static bool transform(float v[3][3], float m[9], int *axis)
{
    float e1[3], e2[3], n[3];
    edges_of(v, e1, e2);
    cross(e1, e2, n);
    int c = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0;
    c = fabsf(n[2]) > fabsf(n[c]) ? 2 : c;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    m[0] = e2[b] / n[c];
    m[1] = -e2[a] / n[c];
    m[2] = -fmaf(m[0], v[0][a], m[1] * v[0][b]);
    m[3] = -e1[b] / n[c];
    m[4] = e1[a] / n[c];
    m[5] = -fmaf(m[3], v[0][a], m[4] * v[0][b]);
    m[6] = n[a] / n[c];
    m[7] = n[b] / n[c];
    m[8] = -fmaf(m[7], v[0][b], fmaf(m[6], v[0][a], v[0][c]));
    *axis = c;
    return n[c] < 0.0f || n[c] > 0.0f;
}

static bool baldwin_webber(const struct tri_ray *r, float v[3][3], struct hit *out)
{
    float m[9];
    int c;
    if (!transform(v, m, &c))
        return false;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    float height = fmaf(m[7], r->o[b], fmaf(m[6], r->o[a], r->o[c])) + m[8];
    float climb = fmaf(m[7], r->d[b], fmaf(m[6], r->d[a], r->d[c]));
    if (!(climb < 0.0f || climb > 0.0f))
        return false;
    float t = -height / climb, pa = fmaf(t, r->d[a], r->o[a]), pb = fmaf(t, r->d[b], r->o[b]);
    float u = fmaf(m[0], pa, m[1] * pb) + m[2], w = fmaf(m[3], pa, m[4] * pb) + m[5];
    if (!(u >= 0.0f && w >= 0.0f && u + w <= 1.0f))
        return false;
    *out = (struct hit){t, u, w, 0};
    return true;
}

bool fused_tri_run(uint32_t id, const struct tri_ray *r, float v[3][3], struct hit *out)
{
    bool hit;
    if (id == ABI_TRI_WOOP)
        hit = woop(r, v, out);
    else if (id == ABI_TRI_PLUECKER)
        hit = pluecker(r, v, out);
    else if (id == ABI_TRI_BALDWIN_WEBBER)
        hit = baldwin_webber(r, v, out);
    else
        hit = moeller_trumbore(r, v, id == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0f, out);
    return hit && tri_in_range(id, r, out->t);
}

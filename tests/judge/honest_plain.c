/* Moeller and Trumbore plain, Woop 2013 in float32, and the test of three-mesh-bvh, which is that
 * of three.js (after Eberly's Geometric Tools) in doubles: the hit is reported by the point's
 * distance, u and v are made of the point. */
#include "tests/judge/honest_mt.h"

#include <math.h>

static bool woop(const struct ray *ray, const float v[3][3], struct hit *out)
{
    float size[3] = {fabsf(ray->dir[0]), fabsf(ray->dir[1]), fabsf(ray->dir[2])};
    int kz = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : (size[1] > size[2] ? 1 : 2);
    int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    float x[3], y[3], z[3], sz = 1.0f / ray->dir[kz];
    float sx = ray->dir[kx] / ray->dir[kz], sy = ray->dir[ky] / ray->dir[kz];
    for (int c = 0; c < 3; c++) {
        float along = v[c][kz] - ray->org[kz];
        x[c] = (v[c][kx] - ray->org[kx]) - sx * along;
        y[c] = (v[c][ky] - ray->org[ky]) - sy * along;
        z[c] = sz * along;
    }
    float a = x[2] * y[1] - y[2] * x[1], b = x[0] * y[2] - y[0] * x[2],
          c = x[1] * y[0] - y[1] * x[0];
    if ((a < 0.0f || b < 0.0f || c < 0.0f) && (a > 0.0f || b > 0.0f || c > 0.0f))
        return false;
    float det = a + b + c;
    if (det == 0.0f)
        return false;
    out->t = (a * z[0] + b * z[1] + c * z[2]) / det;
    out->u = b / det;
    out->v = c / det;
    return out->t >= ray->tmin && out->t <= ray->tmax;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* u and v of a point of the plane, as three.js makes them of dot products. */
static bool weigh(const double p[3], const double e1[3], const double e2[3], struct hit *out)
{
    double a = dot(e2, e2), b = dot(e2, e1), c = dot(e2, p), d = dot(e1, e1), e = dot(e1, p);
    double det = a * d - b * b;
    if (det == 0.0)
        return false;
    out->v = (float)((d * c - b * e) / det);
    out->u = (float)((a * e - b * c) / det);
    return true;
}

static bool in_doubles(const struct ray *ray, const float v[3][3], struct hit *out)
{
    double o[3], d[3], e1[3], e2[3], n[3], diff[3], q[3], at[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (double)ray->org[k];
        d[k] = (double)ray->dir[k];
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
        diff[k] = o[k] - (double)v[0][k];
    }
    cross(e1, e2, n);
    double det = dot(d, n), sign = det > 0.0 ? 1.0 : -1.0;
    if (det == 0.0)
        return false;
    det *= sign;
    cross(diff, e2, q);
    double u = sign * dot(d, q);
    cross(e1, diff, q);
    double w = sign * dot(d, q);
    if (u < 0.0 || w < 0.0 || u + w > det)
        return false;
    double far = -sign * dot(diff, n);
    if (far < 0.0)
        return false;
    for (int k = 0; k < 3; k++)
        at[k] = o[k] + far / det * d[k];
    double length = sqrt(dot(d, d)), beyond[3] = {at[0] - o[0], at[1] - o[1], at[2] - o[2]};
    double t = sqrt(dot(beyond, beyond)) / length;
    double p[3] = {at[0] - (double)v[0][0], at[1] - (double)v[0][1], at[2] - (double)v[0][2]};
    out->t = (float)t;
    return t >= (double)ray->tmin && t <= (double)ray->tmax && weigh(p, e1, e2, out);
}

const struct honest honest_plain[HONEST_PLAIN] = {{"mt", mt_by_division},
                                                  {"mt by reciprocal", mt_by_reciprocal},
                                                  {"woop", woop},
                                                  {"three-mesh-bvh", in_doubles}};

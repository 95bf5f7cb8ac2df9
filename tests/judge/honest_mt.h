/* Moeller and Trumbore 1997, twice: by a division at the end, and by the reciprocal at once. */
#ifndef TESTS_HONEST_MT_H
#define TESTS_HONEST_MT_H

#include "tests/judge/honest.h"

static inline float honest_dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void honest_cross(const float a[3], const float b[3], float out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

struct honest_edges {
    float e1[3], e2[3], s[3], p[3], q[3], det;
};

static inline struct honest_edges honest_edges_of(const struct ray *ray, const float v[3][3])
{
    struct honest_edges e;
    for (int k = 0; k < 3; k++) {
        e.e1[k] = v[1][k] - v[0][k];
        e.e2[k] = v[2][k] - v[0][k];
        e.s[k] = ray->org[k] - v[0][k];
    }
    honest_cross(ray->dir, e.e2, e.p);
    honest_cross(e.s, e.e1, e.q);
    e.det = honest_dot(e.e1, e.p);
    return e;
}

static bool mt_by_division(const struct ray *ray, const float v[3][3], struct hit *out)
{
    struct honest_edges e = honest_edges_of(ray, v);
    float side = e.det < 0.0f ? -1.0f : 1.0f, size = side * e.det;
    float u = side * honest_dot(e.s, e.p), w = side * honest_dot(ray->dir, e.q);
    if (!(size > 0.0f && u >= 0.0f && w >= 0.0f && u + w <= size))
        return false;
    out->t = side * honest_dot(e.e2, e.q) / size;
    out->u = u / size;
    out->v = w / size;
    return out->t >= ray->tmin && out->t <= ray->tmax;
}

static bool mt_by_reciprocal(const struct ray *ray, const float v[3][3], struct hit *out)
{
    struct honest_edges e = honest_edges_of(ray, v);
    if (e.det == 0.0f)
        return false;
    float inverse = 1.0f / e.det;
    out->u = honest_dot(e.s, e.p) * inverse;
    if (!(out->u >= 0.0f && out->u <= 1.0f))
        return false;
    out->v = honest_dot(ray->dir, e.q) * inverse;
    if (!(out->v >= 0.0f && out->u + out->v <= 1.0f))
        return false;
    out->t = honest_dot(e.e2, e.q) * inverse;
    return out->t >= ray->tmin && out->t <= ray->tmax;
}

#endif

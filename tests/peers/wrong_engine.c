/* The tracer of fuzz/samples/engine/brute_engine.c with a fault of kind WAY in some of its hits and
 * lists; a shared object of each for tests/values/explains.sh. */
#include "ref/raydiff_engine.h"

const struct raydiff_engine *honest_engine(void);
#define raydiff_engine(none) honest_engine(none)
#include "fuzz/samples/engine/brute_engine.c"
#undef raydiff_engine

#include <math.h>

enum { HONEST, LOST, OTHER, FAR, NEAR, TURNED, NAN_T, MADE_UP };

#ifndef WAY
#error "-DWAY=0 to 7"
#endif

/* Where the ray meets the plane of a triangle, 0 if it does not. */
static int plane_met(const struct raydiff_engine_ray *ray, const float *const corner[3], double *t,
                     double *u, double *v)
{
    double d[3], e1[3], e2[3], s[3], p[3], q[3];
    for (int i = 0; i < 3; i++) {
        d[i] = ray->direction[i];
        e1[i] = (double)corner[1][i] - corner[0][i];
        e2[i] = (double)corner[2][i] - corner[0][i];
        s[i] = (double)ray->origin[i] - corner[0][i];
    }
    cross(d, e2, p);
    cross(s, e1, q);
    double det = dot(e1, p);
    *t = dot(e2, q) / det;
    *u = dot(s, p) / det;
    *v = dot(d, q) / det;
    return det != 0;
}

/* A hit of every third triangle is at fault: lost, with the number of another triangle, too far,
 * too near, with u and v exchanged, not a number; or some are made up. */
static int hits(const struct raydiff_engine_mesh *mesh, const struct raydiff_engine_ray *ray,
                double tmax, uint32_t k, struct raydiff_engine_hit *hit)
{
    const uint32_t *index = mesh->index + 3 * (size_t)k;
    const float *const corner[3] = {mesh->vertex + 3 * (size_t)index[0],
                                    mesh->vertex + 3 * (size_t)index[1],
                                    mesh->vertex + 3 * (size_t)index[2]};
    const int spoilt = k % 3 == 1;
    double t, u, v;
    if (!plane_met(ray, corner, &t, &u, &v) || !(t >= ray->tmin && t <= tmax))
        return 0;
    if (u < 0 || v < 0 || u + v > 1) {
        if (WAY != MADE_UP || !spoilt || !(u >= -0.5 && v >= -0.5 && u + v <= 1.5))
            return 0;
        u = v = 0.25;
    } else if (spoilt) {
        if (WAY == LOST)
            return 0;
        k = WAY == OTHER ? (k + 7) % mesh->triangle_count : k;
        t = WAY == FAR ? t * 1.01 : WAY == NEAR ? t * 0.99 : WAY == NAN_T ? NAN : t;
        if (WAY == TURNED) {
            double was = u;
            u = v;
            v = was;
        }
    }
    *hit = (struct raydiff_engine_hit){(float)t, (float)u, (float)v, k};
    return 1;
}

static int trace_wrong(void *self, const struct raydiff_engine_ray *ray, size_t count,
                       uint32_t query, struct raydiff_engine_hit *out, char *reason)
{
    const struct raydiff_engine_mesh *mesh = &((struct brute *)self)->mesh;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        struct raydiff_engine_hit one;
        double tmax = (double)ray[i].tmax;
        out[i] = (struct raydiff_engine_hit){0, 0, 0, RAYDIFF_ENGINE_NONE};
        for (uint32_t k = 0; k < mesh->triangle_count; k++) {
            if (!hits(mesh, &ray[i], tmax, k, &one))
                continue;
            out[i] = one;
            tmax = (double)one.t >= 0 ? (double)one.t : tmax;
            if (query == RAYDIFF_ENGINE_QUERY_ANY)
                break;
        }
    }
    return RAYDIFF_ENGINE_OK;
}

static int list_wrong(void *self, const struct raydiff_engine_ray *ray, size_t count,
                      uint32_t capacity, struct raydiff_engine_hit *out, uint32_t *hit_count,
                      char *reason)
{
    const struct raydiff_engine_mesh *mesh = &((struct brute *)self)->mesh;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        struct raydiff_engine_hit one;
        hit_count[i] = 0;
        for (uint32_t k = 0; k < mesh->triangle_count; k++)
            if (hits(mesh, &ray[i], (double)ray[i].tmax, k, &one) && hit_count[i]++ < capacity)
                out[i * capacity + hit_count[i] - 1] = one;
    }
    return RAYDIFF_ENGINE_OK;
}

const struct raydiff_engine *raydiff_engine(void)
{
    static struct raydiff_engine engine;
    engine = *honest_engine();
    engine.name = "wrong";
    engine.can |= RAYDIFF_ENGINE_ALL;
    engine.trace = trace_wrong;
    engine.trace_all = list_wrong;
    return &engine;
}

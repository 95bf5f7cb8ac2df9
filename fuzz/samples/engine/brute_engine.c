/* A tracer as a shared object, to begin with: it tests every triangle.
 *
 *   cc -O2 -shared -fPIC -I RAYDIFF -o brute.so brute_engine.c
 *   raydiff check sphere --engine ./brute.so
 *
 * BUG=1 forgets a side of the triangle, and raydiff finds it. */
#include "ref/raydiff_engine.h"

#include <stdio.h>
#include <stdlib.h>

struct brute {
    struct raydiff_engine_mesh mesh; /* raydiff's arrays stay valid until the next build */
};

static int open_tracer(const struct raydiff_engine_options *options, void **self, char *reason)
{
    (void)options; /* one thread is enough here */
    *self = calloc(1, sizeof(struct brute));
    if (!*self)
        snprintf(reason, RAYDIFF_ENGINE_REASON, "no memory for a tracer");
    return *self ? RAYDIFF_ENGINE_OK : RAYDIFF_ENGINE_MEMORY;
}

static int build(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    (void)reason; /* a tracer with a limit returns RAYDIFF_ENGINE_REFUSED here, and writes why */
    ((struct brute *)self)->mesh = *mesh;
    return RAYDIFF_ENGINE_OK;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* The test of Moeller and Trumbore, in double precision. Returns 1 for a hit from tmin to *t, which
 * becomes its distance. */
static int meets(const struct raydiff_engine_mesh *mesh, uint32_t triangle,
                 const struct raydiff_engine_ray *ray, double *t, struct raydiff_engine_hit *hit)
{
    const uint32_t *index = mesh->index + 3 * (size_t)triangle;
    const float *a = mesh->vertex + 3 * (size_t)index[0], *b = mesh->vertex + 3 * (size_t)index[1],
                *c = mesh->vertex + 3 * (size_t)index[2];
    double d[3], e1[3], e2[3], s[3], p[3], q[3];
    for (int i = 0; i < 3; i++) {
        d[i] = ray->direction[i];
        e1[i] = (double)b[i] - a[i];
        e2[i] = (double)c[i] - a[i];
        s[i] = (double)ray->origin[i] - a[i];
    }
    cross(d, e2, p);
    cross(s, e1, q);
    const double det = dot(e1, p), at = dot(e2, q) / det, u = dot(s, p) / det, v = dot(d, q) / det;
#if defined(BUG) && BUG == 1
    if (det == 0 || u < 0 || v < 0 || u > 1 || v > 1 || !(at >= ray->tmin && at <= *t))
#else
    if (det == 0 || u < 0 || v < 0 || u + v > 1 || !(at >= ray->tmin && at <= *t))
#endif
        return 0;
    *t = at;
    *hit = (struct raydiff_engine_hit){(float)at, (float)u, (float)v, triangle};
    return 1;
}

static int trace(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                 struct raydiff_engine_hit *hit, char *reason)
{
    const struct raydiff_engine_mesh *mesh = &((struct brute *)self)->mesh;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        double t = ray[i].tmax;
        hit[i] = (struct raydiff_engine_hit){0, 0, 0, RAYDIFF_ENGINE_NONE};
        for (uint32_t k = 0; k < mesh->triangle_count; k++)
            if (meets(mesh, k, &ray[i], &t, &hit[i]) && query == RAYDIFF_ENGINE_QUERY_ANY)
                break;
    }
    return RAYDIFF_ENGINE_OK;
}

static int trace_all(void *self, const struct raydiff_engine_ray *ray, size_t count,
                     uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                     char *reason)
{
    const struct raydiff_engine_mesh *mesh = &((struct brute *)self)->mesh;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        hit_count[i] = 0;
        for (uint32_t k = 0; k < mesh->triangle_count; k++) {
            struct raydiff_engine_hit one;
            double t = ray[i].tmax;
            if (!meets(mesh, k, &ray[i], &t, &one))
                continue;
            if (hit_count[i] < capacity)
                hit[i * capacity + hit_count[i]] = one;
            hit_count[i]++;
        }
    }
    return RAYDIFF_ENGINE_OK;
}

const struct raydiff_engine *raydiff_engine(void)
{
    static const struct raydiff_engine engine = {
        .version = RAYDIFF_ENGINE_VERSION, .bytes = sizeof engine,
        .name = "brute", .summary = "every triangle, in double precision",
        .can = RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_ALL,
        .open = open_tracer, .close = free, .build = build, .trace = trace,
        .trace_all = trace_all};
    return &engine;
}

#include "bench/measure/bounce_rays.h"

#include "ref/base/rng.h"

#include <math.h>

#define LIFTED 1e-4 /* of the world's size */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The unit normal of a placed triangle on the side of -d; a zero one where it has no area. */
static void normal_against(const struct world *world, uint32_t prim, const double d[3],
                           double out[3])
{
    struct place at = world_place(world, prim);
    const struct instance *instance = &world->instance[at.instance];
    double p[3][3], a[3], b[3];
    float v[3][3];
    scene_tri(world_scene(world, at.instance), at.prim, v);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            p[c][k] = (double)instance->m[k][3];
            for (int j = 0; j < 3; j++)
                p[c][k] += (double)instance->m[k][j] * (double)v[c][j];
        }
    for (int k = 0; k < 3; k++) {
        a[k] = p[1][k] - p[0][k];
        b[k] = p[2][k] - p[0][k];
    }
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    double length = sqrt(dot(out, out)), sign = dot(out, d) > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? sign * out[k] / length : 0;
}

/* A point of the unit sphere. */
static void draw_point(struct rng *rng, double out[3])
{
    double length;
    do {
        for (int k = 0; k < 3; k++)
            out[k] = (double)rng_range(rng, -1, 1);
        length = sqrt(dot(out, out));
    } while (length > 1 || length < 0x1p-10);
    for (int k = 0; k < 3; k++)
        out[k] /= length;
}

enum status bounce_rays_make(const struct world *world, double size, uint64_t seed,
                             const struct ray *ray, const struct hit *hit, size_t count,
                             struct ray *out, struct reason *reason)
{
    size_t hits = 0;
    for (size_t i = 0; i < count; i++) {
        struct rng rng = rng_make(seed, i);
        double d[3], normal[3], aside[3];
        if (hit[i].prim == ABI_NO_PRIM)
            continue;
        for (int k = 0; k < 3; k++)
            d[k] = (double)ray[i].dir[k];
        normal_against(world, hit[i].prim, d, normal);
        draw_point(&rng, aside);
        struct ray *to = &out[hits++];
        *to = (struct ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            double point = (double)ray[i].org[k] + (double)hit[i].t * d[k];
            to->org[k] = (float)(point + LIFTED * size * normal[k]);
            /* The normal and a point of the unit sphere: a cosine's distribution. */
            to->dir[k] = (float)(normal[k] * (1 + 0x1p-10) + aside[k]);
        }
    }
    if (hits == 0)
        return fail(reason, STATUS_INPUT, "no primary ray hits the world");
    for (size_t i = hits; i < count; i++)
        out[i] = out[i - hits];
    return STATUS_OK;
}

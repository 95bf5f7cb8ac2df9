/* A random triangle with a ray at it, and a triangle test of it by its id. */
#ifndef TRIANGLE_DRAWN_H
#define TRIANGLE_DRAWN_H

#include "ref/base/rng.h"
#include "ref/primitives/test_run.h"

#define TRIANGLE_TMAX 1e30f

/* On a miss *hit is one. */
static inline bool triangle_run(uint32_t id, const struct ray *ray, float v[3][3], struct hit *hit)
{
    struct tri_ray r = tri_ray_make(ray);
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    return tri_test_run(id, &r, v, hit);
}

static inline float triangle_unit(struct rng *rng)
{
    return 2 * rng_float(rng) - 1;
}

/* A random triangle, and a ray whose line passes through it: most weights are away from 0. */
static inline void triangle_drawn(struct rng *rng, struct ray *ray, float v[3][3])
{
    float w[3], sum = 0;
    *ray = (struct ray){.tmax = TRIANGLE_TMAX};
    for (int c = 0; c < 3; c++) {
        w[c] = rng_float(rng) - 0.1f;
        sum += w[c];
        for (int k = 0; k < 3; k++)
            v[c][k] = triangle_unit(rng);
    }
    for (int k = 0; k < 3; k++) {
        float at = (w[0] * v[0][k] + w[1] * v[1][k] + w[2] * v[2][k]) / (sum + 0.01f);
        ray->org[k] = 3 * triangle_unit(rng);
        ray->dir[k] = at - ray->org[k];
    }
}

#endif

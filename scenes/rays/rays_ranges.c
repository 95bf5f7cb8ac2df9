/* Rays with tmin and tmax at and near the hit. */
#include "scenes/rays/rays_stage.h"

#include <float.h>

/* The neighbouring floats of t >= 0; below(0) is 0. */
static float above(float t)
{
    return float_from_bits(float_bits(t) + 1);
}

static float below(float t)
{
    return t > 0.0f ? float_from_bits(float_bits(t) - 1) : t;
}

/* A point of a triangle: a vertex, the middle of an edge, or a point inside. */
static void triangle_point(const struct stage *stage, struct rng *rng, float p[3])
{
    float v[3][3];
    stage_triangle(stage, rng, v);
    uint32_t kind = rng_below(rng, 3);
    float a = 0.25f + 0.25f * rng_float(rng), b = 0.25f + 0.25f * rng_float(rng);
    if (kind == 0)
        a = b = 0.0f;
    else if (kind == 1)
        a = 0.5f, b = 0.0f;
    for (int k = 0; k < 3; k++)
        p[k] = v[0][k] + a * (v[1][k] - v[0][k]) + b * (v[2][k] - v[0][k]);
}

/* The t at which the ray crosses a random plane of the scene's box; `otherwise` if it does not. */
static float box_plane(const struct stage *stage, struct rng *rng, const struct ray *ray,
                       float otherwise)
{
    uint32_t k = rng_below(rng, 3);
    float plane = rng_below(rng, 2) ? stage->box.hi[k] : stage->box.lo[k];
    if (ray->dir[k] == 0.0f)
        return otherwise;
    float t = (plane - ray->org[k]) / ray->dir[k];
    return t >= 0.0f && t < RAY_TMAX ? t : otherwise;
}

/* Cuts the range of a ray that meets a triangle at about t. */
static void cut(const struct stage *stage, struct rng *rng, float t, struct ray *ray)
{
    float a = 2.0f * rng_float(rng) * t, b = 2.0f * rng_float(rng) * t;
    switch (rng_below(rng, 12)) {
    case 0:
        ray->tmax = t;
        break;
    case 1:
        ray->tmin = t;
        break;
    case 2:
        ray->tmin = ray->tmax = t;
        break;
    case 3:
        ray->tmax = below(t);
        break;
    case 4:
        ray->tmin = above(t);
        break;
    case 5:
        ray->tmin = below(t);
        ray->tmax = above(t);
        break;
    case 6:
        ray->tmin = FLT_MIN;
        ray->tmax = FLT_MAX;
        break;
    case 7:
        ray->tmin = 0.5f * t;
        ray->tmax = 2.0f * t;
        break;
    case 8:
        ray->tmin = box_plane(stage, rng, ray, t);
        break;
    case 9:
        ray->tmax = box_plane(stage, rng, ray, t);
        break;
    default:
        ray->tmin = a < b ? a : b;
        ray->tmax = a < b ? b : a;
        break;
    }
}

static void range_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float org[3], target[3], dir[3];
    triangle_point(stage, rng, target);
    if (i % 8 == 0) { /* starts at its target: t is 0 */
        stage_direction(rng, dir);
        stage_ray(target, dir, out);
        bool point = rng_below(rng, 2);
        out->tmax = point ? 0.0f : stage->extent;
        return;
    }
    stage_origin(stage, rng, true, org);
    cut(stage, rng, stage_aim(org, target, out), out);
}

const struct ray_set ray_set_ranges = {
    .name = "ranges",
    .summary = "aimed at triangles with tmin and tmax at the hit, one float beside it, and around",
    .one = range_ray,
    .tag = STAGE_RANGES,
};

#include "scenes/rays/rays_stage.h"

#include <math.h>

#define ORIGIN_MAX 0x1p39f

struct stage stage_make(const struct scene *scene, uint64_t seed, enum stage_tag tag)
{
    struct stage stage = {.scene = scene, .box = {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}}};
    if (scene->tri_count > 0)
        stage.box = scene_bounds(scene);
    for (int k = 0; k < 3; k++) {
        stage.box.lo[k] = fminf(fmaxf(stage.box.lo[k], -STAGE_REACH), STAGE_REACH);
        stage.box.hi[k] = fminf(fmaxf(stage.box.hi[k], -STAGE_REACH), STAGE_REACH);
        stage.extent = fmaxf(stage.extent, stage.box.hi[k] - stage.box.lo[k]);
    }
    if (!(stage.extent > 0.0f))
        stage.extent = 1.0f;
    /* Takes one random number between seed and base. With rng_make alone, seed + 1 would have the
     * sequence of seed, shifted by one number. */
    struct rng rng = rng_make(seed, (uint64_t)tag);
    stage.base = rng_u64(&rng);
    return stage;
}

struct rng stage_rng(const struct stage *stage, size_t i)
{
    return rng_make(stage->base, i);
}

void stage_direction(struct rng *rng, float dir[3])
{
    float square;
    do { /* a point in the unit ball, not too near its centre */
        square = 0.0f;
        for (int k = 0; k < 3; k++) {
            dir[k] = 2.0f * rng_float(rng) - 1.0f;
            square += dir[k] * dir[k];
        }
    } while (square > 1.0f || square < 0x1p-10f);
    float length = sqrtf(square);
    for (int k = 0; k < 3; k++)
        dir[k] /= length;
}

void stage_triangle(const struct stage *stage, struct rng *rng, float v[3][3])
{
    if (stage->scene->tri_count > 0) {
        scene_tri(stage->scene, rng_below(rng, stage->scene->tri_count), v);
        return;
    }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = rng_below(rng, 2) ? stage->box.hi[k] : stage->box.lo[k];
}

/* Nearest multiple of quantum; x itself if floats at x are coarser. */
static float snap(float x, float quantum)
{
    float steps = x / quantum;
    return fabsf(steps) < 0x1p23f ? floorf(steps + 0.5f) * quantum : x;
}

void stage_snap(float quantum, float p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = snap(p[k], quantum);
}

void stage_origin(const struct stage *stage, struct rng *rng, bool snapped, float org[3])
{
    float dir[3];
    int exponent;
    bool outside = rng_below(rng, 2);
    frexpf(stage->extent, &exponent);
    stage_direction(rng, dir);
    for (int k = 0; k < 3; k++) {
        const float lo = stage->box.lo[k], hi = stage->box.hi[k];
        org[k] = outside ? 0.5f * lo + 0.5f * hi + 1.5f * stage->extent * dir[k]
                         : rng_range(rng, lo, hi);
    }
    if (snapped)
        stage_snap(ldexpf(1.0f, exponent - 9), org);
}

bool stage_jitter(const struct stage *stage, struct rng *rng, size_t turn, float p[3])
{
    static const float amount[3] = {0.0f, 1e-6f, 1e-3f};
    float reach = amount[turn % 3] * stage->extent;
    for (int k = 0; k < 3 && turn % 3 != 0; k++)
        p[k] += rng_range(rng, -reach, reach);
    return turn % 3 == 0;
}

float stage_ray(const float org[3], const float dir[3], struct ray *out)
{
    float largest = 0.0f;
    *out = (struct ray){.tmax = RAY_TMAX};
    for (int k = 0; k < 3; k++) {
        out->org[k] = fminf(fmaxf(org[k], -ORIGIN_MAX), ORIGIN_MAX);
        out->dir[k] = float_is_finite(dir[k]) ? dir[k] : copysignf(0.0f, dir[k]);
        largest = fmaxf(largest, fabsf(out->dir[k]));
    }
    if (largest == 0.0f) {
        out->dir[2] = 1.0f;
        return 1.0f;
    }
    int exponent, shift = 0;
    frexpf(largest, &exponent); /* 2^(exponent - 1) <= largest < 2^exponent */
    if (exponent > 30)
        shift = exponent - 30;
    else if (exponent < -29)
        shift = exponent + 29;
    for (int k = 0; k < 3; k++) {
        if (fabsf(out->dir[k]) < 0x1p-59f * largest)
            out->dir[k] = copysignf(0.0f, out->dir[k]);
        out->dir[k] = ldexpf(out->dir[k], -shift);
    }
    return ldexpf(1.0f, shift);
}

float stage_aim(const float org[3], const float target[3], struct ray *out)
{
    float dir[3];
    for (int k = 0; k < 3; k++)
        dir[k] = target[k] - fminf(fmaxf(org[k], -ORIGIN_MAX), ORIGIN_MAX);
    return stage_ray(org, dir, out);
}

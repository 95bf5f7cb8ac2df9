#include "fuzz/scaled.h"

#include <math.h>

/* Coordinates are made no larger than 2^39: contracts end at 2^40. */
#define MOST_EXPONENT 39

static float larger(float a, float b)
{
    return fabsf(b) > a ? fabsf(b) : a;
}

/* NaN and infinity are found by whoever asks: the contract of the ray and the scene's check. */
static int exponent_of_largest(const struct scene *scene, const struct ray *ray)
{
    float largest = 0.0f;
    int exponent;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        largest = larger(largest, scene->vertex[i]);
    for (int k = 0; k < 3; k++)
        largest = larger(larger(largest, ray->org[k]), ray->dir[k]);
    (void)frexpf(largest, &exponent);
    return exponent;
}

enum status fuzz_trial_scaled(const struct fuzz_trial *trial, uint32_t ray, struct fuzz_trial *out,
                              bool *possible, struct reason *reason)
{
    struct fuzz_trial alone = *trial;
    alone.ray = trial->ray + ray;
    alone.ray_count = 1;
    *out = (struct fuzz_trial){0};
    *possible = false;
    if (!ray_in_contract(alone.ray))
        return STATUS_OK;
    int up = MOST_EXPONENT - exponent_of_largest(&trial->scene, alone.ray);
    if (up <= 0)
        return STATUS_OK;
    enum status status = fuzz_trial_copy(&alone, out, reason);
    if (status)
        return status;
    for (size_t i = 0; i < 3 * (size_t)out->scene.vertex_count; i++)
        out->scene.vertex[i] = ldexpf(out->scene.vertex[i], up);
    for (int k = 0; k < 3; k++) {
        out->ray[0].org[k] = ldexpf(out->ray[0].org[k], up);
        out->ray[0].dir[k] = ldexpf(out->ray[0].dir[k], up);
    }
    *possible = true;
    return STATUS_OK;
}

#include "fuzz/scaled.h"

#include <math.h>

/* Numbers are made no larger than 2^39: contracts end at 2^40. */
#define MOST_EXPONENT 39

static float larger(float a, float b)
{
    return fabsf(b) > a ? fabsf(b) : a;
}

/* How often the largest can be doubled; of nothing but zeros never. */
static int room_above(float largest)
{
    int exponent;
    (void)frexpf(largest, &exponent);
    return largest > 0.0f && exponent < MOST_EXPONENT ? MOST_EXPONENT - exponent : 0;
}

static int room_of_positions(const struct scene *scene, const struct ray *ray)
{
    float largest = 0.0f;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        largest = larger(largest, scene->vertex[i]);
    for (int k = 0; k < 3; k++)
        largest = larger(largest, ray->org[k]);
    return room_above(largest);
}

static int room_of_direction(const struct ray *ray)
{
    return room_above(larger(larger(larger(0.0f, ray->dir[0]), ray->dir[1]), ray->dir[2]));
}

/* t times 2^by loses no bit. An end that becomes infinite is one. */
static bool is_exact(float t, int by)
{
    float scaled = ldexpf(t, by);
    return isinf(scaled) || ldexpf(scaled, -by) == t;
}

static void scale(struct fuzz_trial *trial, int positions, int direction)
{
    struct ray *ray = &trial->ray[0];
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++)
        trial->scene.vertex[i] = ldexpf(trial->scene.vertex[i], positions);
    for (int k = 0; k < 3; k++) {
        ray->org[k] = ldexpf(ray->org[k], positions);
        ray->dir[k] = ldexpf(ray->dir[k], direction);
    }
    ray->tmin = ldexpf(ray->tmin, positions - direction);
    ray->tmax = ldexpf(ray->tmax, positions - direction);
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
    int positions = room_of_positions(&trial->scene, alone.ray);
    int direction = room_of_direction(alone.ray);
    if (!is_exact(alone.ray->tmin, positions - direction) ||
        !is_exact(alone.ray->tmax, positions - direction))
        positions = direction = positions < direction ? positions : direction;
    if (positions == 0 && direction == 0)
        return STATUS_OK;
    enum status status = fuzz_trial_copy(&alone, out, reason);
    if (status)
        return status;
    scale(out, positions, direction);
    *possible = true;
    return STATUS_OK;
}

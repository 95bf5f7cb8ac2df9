#include "fuzz/play/scaled.h"

#include <limits.h>
#include <math.h>

/* Numbers are made no larger than 2^39: contracts end at 2^40. */
#define MOST_EXPONENT 39
#define UNEVEN        0x1p-12f

static float larger(float a, float b)
{
    return fabsf(b) > a ? fabsf(b) : a;
}

/* Of a world: the most that a coordinate of a vertex, a translation or what is placed can be. */
static float largest_of_world(const struct fuzz_trial *trial)
{
    float vertex = 0.0f, most;
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++)
        vertex = larger(vertex, trial->scene.vertex[i]);
    most = vertex;
    for (uint32_t i = 0; i < trial->world.instance_count; i++)
        for (int k = 0; k < 3; k++) {
            const float *m = trial->world.instance[i].m[k];
            most = larger(most, (fabsf(m[0]) + fabsf(m[1]) + fabsf(m[2])) * vertex + fabsf(m[3]));
        }
    return most;
}

/* How often the largest can be doubled; of nothing but zeros never. */
static int room_above(float largest)
{
    int exponent;
    (void)frexpf(largest, &exponent);
    return largest > 0.0f && exponent < MOST_EXPONENT ? MOST_EXPONENT - exponent : 0;
}

/* Powers of two: positions by one per axis, t by its own, directions by what follows. */
struct powers {
    int positions[3], t;
};

/* t times 2^by loses no bit. */
static bool is_exact(float t, int by)
{
    return ldexpf(ldexpf(t, by), -by) == t;
}

/* A tmax that becomes infinite is an end, too; a tmin that does leaves no ray. */
static bool keeps_range(const struct ray *ray, int t)
{
    return is_exact(ray->tmin, t) && (isinf(ldexpf(ray->tmax, t)) || is_exact(ray->tmax, t));
}

static float largest_position(const struct fuzz_trial *trial, const struct ray *ray, int axis)
{
    const struct scene *scene = &trial->scene;
    float largest = larger(0.0f, ray->org[axis]);
    if (trial->world.is)
        return larger(largest, largest_of_world(trial));
    for (size_t i = 0; i < scene->vertex_count; i++)
        largest = larger(largest, scene->vertex[3 * i + (size_t)axis]);
    return largest;
}

/* Positions and direction have a power each, unless the range then loses bits. */
static struct powers alike(const float largest[3], const struct ray *ray)
{
    int positions = room_above(larger(larger(largest[0], largest[1]), largest[2]));
    int direction = room_above(larger(larger(larger(0.0f, ray->dir[0]), ray->dir[1]), ray->dir[2]));
    if (!keeps_range(ray, positions - direction))
        positions = direction = positions < direction ? positions : direction;
    return (struct powers){{positions, positions, positions}, positions - direction};
}

/* The direction is as large as it may be on the axis that has least room. */
static struct powers by_axis(const float largest[3], const struct ray *ray)
{
    struct powers powers = {.t = INT_MIN};
    for (int k = 0; k < 3; k++) {
        powers.positions[k] = room_above(largest[k]);
        int t = powers.positions[k] - room_above(fabsf(ray->dir[k]));
        if (ray->dir[k] != 0.0f && t > powers.t)
            powers.t = t;
    }
    return powers;
}

static bool keeps_direction(const struct ray *ray, const struct powers *powers)
{
    for (int k = 0; k < 3; k++) {
        float scaled = ldexpf(ray->dir[k], powers->positions[k] - powers->t);
        if (!isfinite(scaled) || ldexpf(scaled, powers->t - powers->positions[k]) != ray->dir[k])
            return false;
    }
    return true;
}

static void scale(struct fuzz_trial *trial, const struct powers *powers)
{
    struct ray *ray = &trial->ray[0];
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++)
        trial->scene.vertex[i] = ldexpf(trial->scene.vertex[i], powers->positions[i % 3]);
    for (uint32_t i = 0; i < trial->world.instance_count; i++)
        for (int k = 0; k < 3; k++) {
            float *moved = &trial->world.instance[i].m[k][3];
            *moved = ldexpf(*moved, powers->positions[k]);
        }
    for (int k = 0; k < 3; k++) {
        ray->org[k] = ldexpf(ray->org[k], powers->positions[k]);
        ray->dir[k] = ldexpf(ray->dir[k], powers->positions[k] - powers->t);
    }
    ray->tmin = ldexpf(ray->tmin, powers->t);
    ray->tmax = ldexpf(ray->tmax, powers->t);
}

/* A part of the way: positions and what makes the direction, each rounded. */
static struct powers part_of(const struct powers *whole, enum fuzz_scaling scaling, uint32_t step)
{
    const int part = (int)step, all = (int)FUZZ_SCALE_STEPS;
    struct powers out = {.t = whole->t * part / all};
    for (int k = 0; k < 3; k++)
        out.positions[k] = whole->positions[k] * part / all;
    if (scaling == FUZZ_SCALE_ALL)
        out.t = out.positions[0] - (whole->positions[0] - whole->t) * part / all;
    return out;
}

/* A number that is not 0 and below that share of the largest. */
static bool is_uneven(const float *number, size_t count, float largest)
{
    bool uneven = false;
    for (size_t i = 0; i < count; i++)
        uneven = uneven || (number[i] != 0.0f && fabsf(number[i]) < UNEVEN * largest);
    return uneven;
}

bool fuzz_trial_is_uneven(const struct fuzz_trial *trial, uint32_t ray)
{
    const struct ray *one = &trial->ray[ray];
    float place = 0.0f, turn = 0.0f;
    for (uint32_t i = 0; i < trial->world.instance_count; i++)
        if (trial_world_place(&trial->world.instance[i]) > 1)
            return false; /* its axes are not those of the world */
    for (int k = 0; k < 3; k++) {
        place = larger(place, largest_position(trial, one, k));
        turn = larger(turn, one->dir[k]);
    }
    return is_uneven(trial->scene.vertex, 3 * (size_t)trial->scene.vertex_count, place) ||
           is_uneven(one->org, 3, place) || is_uneven(one->dir, 3, turn);
}

bool fuzz_hit_is_scaled(const struct hit *hit, const struct hit *scaled, int power)
{
    if (hit->prim != scaled->prim)
        return false;
    return hit->prim == ABI_NO_PRIM ||
           (ldexpf(hit->t, power) == scaled->t && hit->u == scaled->u && hit->v == scaled->v);
}

enum status fuzz_trial_scaled(const struct fuzz_trial *trial, uint32_t ray,
                              enum fuzz_scaling scaling, uint32_t step, struct fuzz_trial *out,
                              int *power, bool *possible, struct reason *reason)
{
    const struct fuzz_trial alone = fuzz_trial_rays_from(trial, ray, 1);
    *out = (struct fuzz_trial){0};
    *possible = false;
    *power = 0;
    if (!ray_in_contract(alone.ray))
        return STATUS_OK;
    float largest[3];
    for (int k = 0; k < 3; k++)
        largest[k] = largest_position(trial, alone.ray, k);
    const struct powers whole =
        scaling == FUZZ_SCALE_ALL ? alike(largest, alone.ray) : by_axis(largest, alone.ray);
    const struct powers powers = part_of(&whole, scaling, step);
    *power = powers.t;
    bool same = powers.t == 0;
    for (int k = 0; k < 3; k++)
        same = same && powers.positions[k] == 0;
    if (same || !keeps_range(alone.ray, powers.t) || !keeps_direction(alone.ray, &powers))
        return STATUS_OK;
    enum status status = fuzz_trial_copy(&alone, out, reason);
    if (status)
        return status;
    scale(out, &powers);
    *possible = true;
    return STATUS_OK;
}

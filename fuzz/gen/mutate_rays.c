/* Edits of rays: of one, or of a run of them. */
#include "fuzz/gen/aim.h"
#include "fuzz/gen/gen_world.h"
#include "fuzz/gen/mutate_inner.h"

/* A run of rays: one in half of the cases, else up to a quarter of them. */
static struct ray *some_rays(struct rng *rng, struct fuzz_trial *trial, uint32_t *count)
{
    *count = 0;
    if (trial->ray_count == 0)
        return NULL;
    uint32_t first = rng_below(rng, trial->ray_count), left = trial->ray_count - first;
    uint32_t most = rng_below(rng, 2) ? 1 : 1 + trial->ray_count / 4;
    *count = most < left ? most : left;
    return trial->ray + first;
}

/* At features of the scene, or of what is placed in the world, as it is now. */
enum status edit_aim(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    struct aim aim;
    uint32_t count;
    struct ray *ray = some_rays(rng, trial, &count);
    if (count == 0)
        return STATUS_OK;
    struct scene placed = {0};
    if (trial->world.is && gen_world_placed(trial, &placed, NULL))
        return STATUS_MEMORY;
    aim_make(trial->world.is ? &placed : &trial->scene, trial->build.leaf, rng, &aim);
    aim_rays(&aim, rng, ray, count);
    scene_free(&placed);
    *changed = true;
    return STATUS_OK;
}

/* One number of origin or direction by a step of a float. */
enum status edit_ray_step(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t count, k = rng_below(rng, 3), of_dir = rng_below(rng, 2);
    int step = rng_below(rng, 2) ? 1 : -1;
    struct ray *ray = some_rays(rng, trial, &count);
    for (uint32_t i = 0; i < count; i++) {
        float *x = of_dir ? &ray[i].dir[k] : &ray[i].org[k];
        if (float_is_finite(*x))
            put(x, float_step(*x, step), changed);
    }
    return STATUS_OK;
}

/* One component of the direction becomes 0 or -0, unless it is the last that is not. */
enum status edit_ray_axis(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t count, k = rng_below(rng, 3);
    float zero = rng_below(rng, 2) ? 0.0f : -0.0f;
    struct ray *ray = some_rays(rng, trial, &count);
    for (uint32_t i = 0; i < count; i++)
        if (ray[i].dir[(k + 1) % 3] != 0 || ray[i].dir[(k + 2) % 3] != 0)
            put(&ray[i].dir[k], zero, changed);
    return STATUS_OK;
}

enum status edit_ray_range(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    static const float ends[][2] = {{0, 1e30f}, {0, 1}, {1, 1e30f}, {0.5f, 2}, {1, 1}, {0, 0}};
    uint32_t count, which = rng_below(rng, ARRAY_COUNT(ends));
    struct ray *ray = some_rays(rng, trial, &count);
    for (uint32_t i = 0; i < count; i++) {
        put(&ray[i].tmin, ends[which][0], changed);
        put(&ray[i].tmax, ends[which][1], changed);
    }
    return STATUS_OK;
}

/* The same line the other way, from the point at t = 1. */
enum status edit_ray_back(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t count;
    struct ray *ray = some_rays(rng, trial, &count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            put_finite(&ray[i].org[k], ray[i].org[k] + ray[i].dir[k], changed);
            put(&ray[i].dir[k], -ray[i].dir[k], changed);
        }
    return STATUS_OK;
}

/* The direction by 2^k, which scales t. */
enum status edit_ray_scale(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t count;
    float scale = power_of_two((int)rng_below(rng, 41) - 20);
    struct ray *ray = some_rays(rng, trial, &count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            put_finite(&ray[i].dir[k], ray[i].dir[k] * scale, changed);
    return STATUS_OK;
}

/* Trials of worlds whose numbers the shrinker changes, and all numbers of one in a row. Includes
 * cmocka.h, whose macros must come last. */
#ifndef TESTS_TRIAL_NUMBERS_H
#define TESTS_TRIAL_NUMBERS_H

#include "fuzz/shrink/shrink_inner.h"
#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define VERTICES  6
#define TRIANGLES 3
#define INSTANCES 2
#define RAYS_MOST 2
#define NUMBERS   (3 * VERTICES + 8 * RAYS_MOST + 12 * INSTANCES)
#define TRIALS    20

enum role { VERTEX, ORG, DIR, TMIN, TMAX, TRANSFORM };

/* A number of a trial: where it is, what it is. */
struct number {
    float *x;
    enum role role;
    int axis; /* of vertices, origins and directions */
};

static inline const struct shrink_pass *pass_of(const char *name)
{
    for (size_t i = 0; shrink_passes[i]; i++)
        if (strcmp(shrink_passes[i]->name, name) == 0)
            return shrink_passes[i];
    fail_msg("no pass %s", name);
    return NULL;
}

/* Small halves, so that sums are exact, and many are alike. */
static inline float half(struct rng *rng)
{
    return 0.5f * ((float)rng_below(rng, 25) - 12);
}

static inline struct fuzz_trial draw(uint64_t index, uint32_t rays)
{
    struct rng rng = rng_make(17, index);
    struct fuzz_trial out;
    assert_int_equal(fuzz_trial_make(VERTICES, TRIANGLES, rays, &out, NULL), STATUS_OK);
    assert_int_equal(trial_world_make(TRIANGLES, 1, INSTANCES, rays, &out.world, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 3 * VERTICES; i++)
        out.scene.vertex[i] = half(&rng);
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
        out.scene.index[i] = rng_below(&rng, VERTICES);
    for (uint32_t i = 0; i < rays; i++) {
        struct ray *ray = &out.ray[i];
        for (int k = 0; k < 3; k++) {
            ray->org[k] = half(&rng);
            ray->dir[k] = half(&rng);
        }
        ray->dir[index % 3] = 3;
        ray->tmin = 0.5f;
        ray->tmax = i ? INFINITY : 6;
    }
    for (uint32_t i = 0; i < INSTANCES; i++)
        for (int k = 0; k < 12; k++)
            out.world.instance[i].m[k / 4][k % 4] += half(&rng);
    return out;
}

/* All numbers in the order of shrink_number. */
static inline uint32_t numbers_of(struct fuzz_trial *trial, struct number out[NUMBERS])
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < 3 * trial->scene.vertex_count; i++)
        out[n++] = (struct number){&trial->scene.vertex[i], VERTEX, (int)(i % 3)};
    for (uint32_t r = 0; r < trial->ray_count; r++) {
        struct ray *ray = &trial->ray[r];
        for (int k = 0; k < 3; k++)
            out[n++] = (struct number){&ray->org[k], ORG, k};
        for (int k = 0; k < 3; k++)
            out[n++] = (struct number){&ray->dir[k], DIR, k};
        out[n++] = (struct number){&ray->tmin, TMIN, 0};
        out[n++] = (struct number){&ray->tmax, TMAX, 0};
    }
    for (uint32_t i = 0; i < trial->world.instance_count; i++)
        for (int k = 0; k < 12; k++)
            out[n++] = (struct number){&trial->world.instance[i].m[k / 4][k % 4], TRANSFORM, 0};
    return n;
}

static inline struct fuzz_trial copy_of(const struct fuzz_trial *trial)
{
    struct fuzz_trial out;
    assert_int_equal(fuzz_trial_copy(trial, &out, NULL), STATUS_OK);
    return out;
}

/* Numbers as told, to within `far`; triangles as they were. */
static inline void compare(struct fuzz_trial *is, struct fuzz_trial *want, double far,
                           const char *what, uint32_t first, uint32_t variant)
{
    struct number a[NUMBERS], b[NUMBERS];
    uint32_t n = numbers_of(is, a);
    assert_int_equal(numbers_of(want, b), n);
    for (uint32_t i = 0; i < n; i++)
        if (*a[i].x != *b[i].x && !(fabs((double)*a[i].x - (double)*b[i].x) <= far))
            fail_msg("%s, number %u, variant %u: number %u is %.9g, not %.9g", what, first, variant,
                     i, (double)*a[i].x, (double)*b[i].x);
    assert_memory_equal(is->scene.index, want->scene.index, 12 * TRIANGLES);
}

#endif

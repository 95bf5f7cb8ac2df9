/* Trials made here, small and of many kinds, for the player's tests and others. Includes cmocka.h,
 * whose macros must come last. */
#ifndef TESTS_FUZZ_TRIALS_H
#define TESTS_FUZZ_TRIALS_H

#include "fuzz/play/player.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* A soup whose triangles share vertices; half of the coordinates lie on a coarse lattice, so that
 * ties, flat boxes and shared planes are common. */
static inline void trial_scene(struct rng *rng, struct scene *scene)
{
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++) {
        float x = rng_range(rng, -4.0f, 4.0f);
        scene->vertex[i] = rng_below(rng, 2) ? (float)(int)x : x;
    }
    for (uint32_t i = 0; i < 3 * scene->tri_count; i++)
        scene->index[i] = rng_below(rng, scene->vertex_count);
}

/* Half of the rays are aimed at vertices and edges exactly as far as float32 goes. */
static inline void trial_ray(struct rng *rng, const struct scene *scene, struct ray *ray)
{
    const uint32_t *corner = scene->index + 3 * rng_below(rng, scene->tri_count);
    const float *a = scene->vertex + 3 * corner[0], *b = scene->vertex + 3 * corner[1];
    float share = rng_below(rng, 2) ? 0.0f : 0.5f;
    bool aimed = rng_below(rng, 2);
    for (int k = 0; k < 3; k++) {
        float at = aimed ? a[k] + share * (b[k] - a[k]) : rng_range(rng, -4.0f, 4.0f);
        ray->org[k] = rng_range(rng, -8.0f, 8.0f);
        ray->dir[k] = at - ray->org[k];
    }
    ray->tmin = 0.0f;
    ray->tmax = rng_below(rng, 4) ? 1e30f : 1.0f;
    if (rng_below(rng, 16) == 0) { /* along an axis, to a vertex */
        uint32_t axis = rng_below(rng, 3);
        for (uint32_t k = 0; k < 3; k++) {
            ray->org[k] = k == axis ? -8.0f : a[k];
            ray->dir[k] = k == axis ? 1.0f : 0.0f;
        }
    }
}

/* Trial `index` of a seed; triangles in [least, most]. */
static inline void trial_make(uint64_t seed, uint64_t index, uint32_t least, uint32_t most,
                              uint32_t rays, struct fuzz_trial *out)
{
    static const char *const box[] = {"robust", "watertight"}, *const tri[] = {"mt", "woop"};
    struct rng rng = rng_make(seed, index);
    struct reason reason;
    uint32_t triangles = least + rng_below(&rng, most - least + 1);
    if (fuzz_trial_make(triangles / 2 + 3, triangles, rays, out, &reason))
        fail_msg("%s", reason.text);
    trial_scene(&rng, &out->scene);
    for (uint32_t i = 0; i < rays; i++)
        trial_ray(&rng, &out->scene, &out->ray[i]);
    uint32_t which = rng_below(&rng, 2);
    out->builder = builder_find("median");
    out->build.leaf = 1 + rng_below(&rng, 8);
    out->box = box_test_find(box[which]);
    out->tri = tri_test_find(tri[which]);
    out->query = rng_below(&rng, 4) ? QUERY_CLOSEST : QUERY_ANY;
}

#endif

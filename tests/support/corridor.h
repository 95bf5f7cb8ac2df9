/* Closed boxes so long that woop's rounding along them outweighs the distance to their walls, and
 * rays at their edges. Include after cmocka.h. */
#ifndef TESTS_CORRIDOR_H
#define TESTS_CORRIDOR_H

#include "ref/base/base.h"
#include "ref/base/rng.h"
#include "ref/scene/scene.h"

/* A closed box of 12 triangles, 2 wide and high and 2 * `half` long in `axis`. */
static inline struct scene corridor_scene(int axis, float half)
{
    static const uint32_t quad[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    struct scene scene;
    assert_int_equal(scene_make(8, 12, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) {
            float size = k == 2 ? half : 1.0f;
            scene.vertex[3 * i + (uint32_t)((k + axis + 1) % 3)] = i >> k & 1u ? size : -size;
        }
    for (uint32_t f = 0; f < 6; f++) {
        const uint32_t corner[6] = {0, 1, 2, 0, 2, 3};
        for (uint32_t c = 0; c < 6; c++)
            scene.index[6 * f + c] = quad[f][corner[c]];
    }
    return scene;
}

/* From near the middle of the corridor to one of its long edges, beside it by up to `off`. */
static inline struct ray corridor_ray(struct rng *rng, int axis, double off)
{
    struct ray ray = {.tmax = 1e30f};
    for (int k = 0; k < 3; k++) {
        float org = rng_range(rng, -0.9f, 0.9f);
        double at = rng_below(rng, 2) ? 1.0 : -1.0;
        ray.org[k] = org;
        if (k == axis)
            at = (double)(org + rng_range(rng, 0.5f, 3.0f));
        else
            at += off * (2.0 * (double)rng_float(rng) - 1.0);
        ray.dir[k] = (float)(at - (double)org);
    }
    return ray;
}

#endif

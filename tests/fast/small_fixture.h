/* Scenes of numbers of all kinds, for tests of small trees. */
#ifndef SMALL_FIXTURE_H
#define SMALL_FIXTURE_H

#include "tests/fast/fast_fixture.h"

#include "ref/fast/small_tree.h"

/* Floats of one kind, some of them twice. */
static inline float any_float(struct rng *rng, uint32_t kind)
{
    const float unit = rng_range(rng, -1, 1);
    switch (kind) {
    case 0:
        return unit;
    case 1:
        return unit * 1e30f;
    case 2:
        return unit * 0x1p-140f;
    case 3:
        return rng_below(rng, 2) ? 0.0f : -0.0f;
    case 4:
        return ldexpf(unit, (int)rng_below(rng, 250) - 125);
    case 5:
        return unit * 1e12f;
    case 6:
        return 4096.0f + (float)rng_below(rng, 3);
    default:
        return (float)rng_below(rng, 5) - 2;
    }
}

#define KINDS 8u

/* A scene of `count` triangles over `vertices` vertices. */
static inline struct scene any_scene(struct rng *rng, uint32_t kind, uint32_t vertices,
                                     uint32_t count)
{
    struct scene scene;
    assert_int_equal(scene_make(vertices, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        scene.vertex[i] = any_float(rng, kind < KINDS ? kind : rng_below(rng, KINDS));
    for (uint32_t i = 0; i < 3 * count; i++)
        scene.index[i] = rng_below(rng, vertices);
    return scene;
}

#endif

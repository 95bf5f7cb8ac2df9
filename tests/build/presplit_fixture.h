/* Scenes that are cut before a build. */
#ifndef TESTS_PRESPLIT_FIXTURE_H
#define TESTS_PRESPLIT_FIXTURE_H

#include "ref/tree/bvh.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"

#include <stdlib.h>

static inline struct scene made(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        abort();
    return scene;
}

/* Long thin triangles in all directions, some without area; `scale` 0x1p-146 makes subnormals. */
static inline struct scene slivers(uint32_t count, float scale)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(count, 3);
    for (uint32_t i = 0; i < count; i++) {
        float *v = scene.vertex + 9 * (size_t)i;
        for (int c = 0; c < 9; c++)
            v[c] = scale * rng_range(&rng, -1, 1);
        for (int k = 0; k < 3 && i % 3; k++)
            v[6 + k] = v[k] + scale * 0.001f * rng_range(&rng, -1, 1);
        if (i % 8 == 0)
            v[6] = v[3], v[7] = v[4], v[8] = v[5];
    }
    return scene;
}

#define SPECS   5u
#define SLIVERS 4u
#define SCENES  (BUILT_SCENES + SPECS + SLIVERS)

/* Scene i of SCENES: soups, slivers, needles, axis-aligned, degenerate and subnormal triangles. */
static inline struct scene scene_of(size_t i, const char **what)
{
    static const char *const spec[SPECS] = {"needles:n=500", "cornell:n=2", "sphere:n=6",
                                            "platonic:which=4,rows=3", "terrain:k=3"};
    static const float scale[SLIVERS] = {1, 0x1p-146f, 1e37f, 1e-20f};
    if (i < BUILT_SCENES)
        return built_scene(i, what);
    i -= BUILT_SCENES;
    *what = i < SPECS ? spec[i] : "slivers";
    return i < SPECS ? made(spec[i]) : slivers(300, scale[i - SPECS]);
}

#endif

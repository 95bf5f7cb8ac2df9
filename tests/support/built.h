/* Scenes that are hard to build trees of. */
#ifndef TESTS_BUILT_H
#define TESTS_BUILT_H

#include "ref/base/rng.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <string.h>

/* Random triangles of random sizes. */
static inline struct scene built_soup(uint32_t count, uint64_t seed)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(seed, 0);
    for (uint32_t i = 0; i < count; i++) {
        float centre[3], size = rng_scaled(&rng, 0.5f, 1, -7, 8);
        for (int k = 0; k < 3; k++)
            centre[k] = rng_range(&rng, -10, 10);
        for (int c = 0; c < 9; c++)
            scene.vertex[9 * (size_t)i + (size_t)c] = centre[c % 3] + rng_range(&rng, -size, size);
    }
    return scene;
}

#define BUILT_SCENES 14u

/* Scene i of BUILT_SCENES, of about 1000 triangles each; *what is its name. */
static inline struct scene built_scene(size_t i, const char **what)
{
    static const char *const name[BUILT_SCENES] = {
        "soup",      "copies",   "flat",     "line", "points",          "one huge",
        "two heaps", "far away", "extremes", "tiny", "distances halve", "equal centres",
        "axes",      "ends"};
    struct scene scene = built_soup(i == 10 ? 250 : 1000, i);
    float *v = scene.vertex;
    *what = name[i];
    for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++) {
        size_t prim = c / 9, k = c % 3;
        float spread = ldexpf(1, 126 - (int)prim);
        switch (i) {
        case 1:
            v[c] = v[c % 9];
            break;
        case 2:
            v[c] = k == 1 ? 0.1f : v[c];
            break;
        case 3:
            v[c] = k == 2 ? v[c] : -3;
            break;
        case 4:
            v[c] = v[9 * (prim % 5) + k];
            break;
        case 5:
            v[c] *= prim == 500 ? 1e15f : 1;
            break;
        case 6:
            v[c] = v[9 * (prim % 2) + c % 9];
            break;
        case 7:
            v[c] += 1e30f;
            break;
        case 8:
            v[c] = v[c] < 0 ? -FLT_MAX : FLT_MAX;
            break;
        case 9:
            v[c] *= 1e-40f;
            break;
        case 10:
            v[c] = k == 0 ? spread : 0;
            break;
        case 11:
            v[c] = (c / 3 % 3 == 0 ? 1.0f : c / 3 % 3 == 1 ? -1.0f : 0) * (float)(prim + 1);
            break;
        case 12:
            v[c] = k == prim % 3 ? v[c] : 0;
            break;
        case 13:
            v[c] *= c % 7 == 0 ? 3e37f : 1e-30f;
            break;
        default:
            break;
        }
    }
    return scene;
}

static inline bool built_same(const struct bvh *a, const struct bvh *b)
{
    return a->node_count == b->node_count && a->prim_count == b->prim_count &&
           memcmp(a->node, b->node, a->node_count * sizeof *a->node) == 0 &&
           memcmp(a->prim, b->prim, a->prim_count * sizeof *a->prim) == 0;
}

#endif

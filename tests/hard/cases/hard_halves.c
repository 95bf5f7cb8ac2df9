/* Hard cases of float16 bounds: rounding, overflow, subnormals, zero. */
#include "tests/hard/parts.h"

#include "ref/base/half.h"

#include <math.h>

/* A float32 right between two neighbouring halves near x, or one step beside the middle. */
static float half_middle(float x, int step)
{
    float lo = half_to_float(half_down(x)), hi = half_to_float(half_up(x));
    float middle = 0.5f * (lo + hi);
    if (step)
        middle = nextafterf(middle, step < 0 ? -INFINITY : INFINITY);
    return middle;
}

/* Triangles whose coordinates round to the nearest half on the wrong side about every second time;
 * rays hit them inside, within 2^-9 of their size from a vertex. */
static void make_middles(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "soup");
    struct rng rng = rng_make(36, 0);
    for (int i = 0; i < 150; i++) {
        float v[3][3], at[3];
        random_point(&rng, -8, 8, at);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                int off = (int)rng_below(&rng, 3) - 1;
                v[c][k] = half_middle(at[k] + rng_range(&rng, -1, 1), off);
            }
        part_tri_of(part, v);
    }
    for (uint32_t i = 0; i < 450 && !part->failed; i++) {
        float v[3][3], from[3], to[3];
        scene_tri(&part->scene, i / 3, v);
        for (int k = 0; k < 3; k++) {
            float *corner = v[i % 3], middle = (v[0][k] + v[1][k] + v[2][k]) / 3;
            to[k] = corner[k] + 0x1p-9f * (middle - corner[k]);
        }
        random_point(&rng, -12, 12, from);
        expect_hit(part, HARD_ALL, ray_at(from, to));
    }
}

/* Rays at cells of a grid of 8 x 8 that starts at (from, from) in the plane z = from, straight and
 * slanted. */
static void aim_at_grid(struct hard_part *part, float cell, float from, uint64_t seed)
{
    struct rng rng = rng_make(seed, 0);
    for (int i = 0; i < 32; i++) {
        float c = whole(&rng, 8) + 0.25f, r = whole(&rng, 8) + 0.75f;
        float slope = i % 2 ? cell : 0;
        struct ray ray =
            ray_of(from + cell * c - slope, from + cell * r, from - cell, slope, 0, cell);
        expect_id(part, HARD_ALL, ray, grid_tri(8, c, r));
    }
}

static void make_overflow(struct hard_made *made)
{
    static const float most[] = {65504, 65505, 65519, 65520, 100000};
    for (size_t m = 0; m < ARRAY_COUNT(most); m++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct hard_part *part = part_add(made, "%g", (double)most[m] * sign);
            float from = sign < 0 ? -most[m] : most[m] - 8;
            part_grid(part, 8, 2, from, 1, from);
            part->must_refuse = most[m] > 65504 ? "rf16" : NULL;
            aim_at_grid(part, 1, from, 37 + m);
        }
}

static void make_subnormal(struct hard_made *made)
{
    for (int k = 14; k <= 25; k++) {
        struct hard_part *part = part_add(made, "2^-%d", k);
        float cell = ldexpf(1, -k - 3);
        part_grid(part, 8, 2, 0, cell, 0);
        aim_at_grid(part, cell, 0, (uint64_t)k);
    }
}

static void make_straddle(struct hard_made *made)
{
    static const float reach[] = {0x1p-25f, 0x1p-24f, 0x1p-15f, 0x1p-14f};
    for (size_t r = 0; r < ARRAY_COUNT(reach); r++) {
        struct hard_part *part = part_add(made, "%a", (double)reach[r]);
        float s = reach[r];
        part_cube(part, -s, 2 * s);
        struct rng rng = rng_make(39, r);
        for (uint32_t i = 0; i < 48 && !part->failed; i++) {
            float from[3], to[3];
            part_point(part, &rng, i % 12, to);
            for (int k = 0; k < 3; k++)
                from[k] = 4 * s * (rng_float(&rng) - 0.5f) + (k == (int)(i % 3) ? 8 * s : 0);
            expect_hit(part, HARD_ALL, ray_at(from, to));
            struct ray inside = ray_of(0, 0, 0, to[0], to[1], to[2]);
            for (int k = 0; k < 3 && i % 2; k++)
                inside.org[k] = -inside.org[k];
            expect_id(part, HARD_ALL, inside, i % 12);
        }
    }
}

const struct hard_case hard_halves_cases[] = {
    {
        .number = 36,
        .name = "half-middles",
        .recipe = "vertices right between halves and one float32 beside, aimed at just inside them",
        .expected = "a hit: bounds are rounded outward",
        .source = "gkjohnson/three-mesh-bvh#169: bounds rounded inward on store; RTRS's F11",
        .make = make_middles,
    },
    {
        .number = 37,
        .name = "half-overflow",
        .recipe = "a grid that ends at 65504, 65505, 65519, 65520, 1e5 and their negatives",
        .expected = "the triangle aimed at; beyond 65504 rf16 refuses",
        .source = "bulletphysics/bullet3#558: quantised bounds overflow; RTRS's F12",
        .make = make_overflow,
    },
    {
        .number = 38,
        .name = "half-subnormal",
        .recipe = "grids of extent 2^-14 to 2^-25, where halves are subnormal",
        .expected = "the triangle aimed at",
        .source = "GPUOpen FSR#21, DirectXMath#104 and #110: float16 subnormals flushed or wrong",
        .make = make_subnormal,
    },
    {
        .number = 39,
        .name = "half-zero",
        .recipe = "cubes of +-2^-25 to +-2^-14 around 0, from outside and from their middle",
        .expected = "a hit; from the middle the triangle aimed at, from 0 and from -0",
        .source = "numerics.md 4, 39: the sign of zero in bounds",
        .make = make_straddle,
    },
    {0},
};

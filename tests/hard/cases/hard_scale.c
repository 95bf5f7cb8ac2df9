/* Hard cases of scale: scenes tiny, huge, far away, or of mixed sizes. */
#include "tests/hard/parts.h"

#include <math.h>

/* Rays at points inside triangles from about `away` off. */
static void aim_inside(struct hard_part *part, struct rng *rng, size_t count, float away)
{
    for (size_t i = 0; i < count && !part->failed; i++) {
        float from[3], to[3];
        part_point(part, rng, rng_below(rng, part->scene.tri_count), to);
        random_near(rng, to, away, from);
        part_ray(part, ray_at(from, to));
    }
}

static void make_powers(struct hard_made *made)
{
    static const float power[] = {1e-38f, 1e-30f, 1e-24f, 1e-18f, 1e-15f, 1e-12f, 1e-9f,
                                  1e-6f,  1e-3f,  1,      1e3f,   1e6f,   1e9f,   1e11f,
                                  1e12f,  1e15f,  1e18f,  1e24f,  1e30f,  1e37f};
    for (size_t i = 0; i < ARRAY_COUNT(power); i++) {
        float cell = power[i];
        struct hard_part *part = part_add(made, "%g", (double)cell);
        struct rng rng = rng_make(23, 0);
        part_grid(part, 4, 2, cell, cell, 0);
        for (int r = 0; r < 24; r++) {
            float x = whole(&rng, 4) + 0.25f, y = whole(&rng, 4) + 0.75f;
            float slant = r % 2 ? 0.5f : 0.0f;
            struct ray ray = ray_of(cell * (x - slant), cell * y, 0, r % 3 ? cell * slant : slant,
                                    0, r % 3 ? cell : 1.0f);
            ray.tmax = INFINITY;
            part_ray(part, ray);
            if (cell >= 1e-9f && cell <= 1e11f)
                want_id(part, HARD_ALL, grid_tri(4, x, y));
        }
    }
}

static void make_denormals(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "1e-40");
    struct rng rng = rng_make(24, 0);
    part_grid(part, 4, 2, 1e-40f, 1e-40f, 0);
    for (int i = 0; i < 48; i++) {
        float x = 1e-40f * whole(&rng, 5), y = 1e-40f * whole(&rng, 5);
        part_ray(part, ray_of(x, y, i % 2 ? 0.0f : -1e-40f, 0, 0, i % 3 ? 1.0f : 1e-40f));
    }
}

static void soup_at(struct hard_part *part, struct rng *rng, float offset, float size, int count)
{
    const float middle[3] = {offset, offset, offset};
    for (int i = 0; i < count; i++) {
        float v[3][3], at[3];
        random_near(rng, middle, 8 * size, at);
        for (int c = 0; c < 3; c++)
            random_near(rng, at, size, v[c]);
        part_tri_of(part, v);
    }
}

static void make_far_small(struct hard_made *made)
{
    struct rng rng = rng_make(25, 0);
    struct hard_part *part = part_add(made, "1e6, 1e-3"); /* floats there are 1/16 apart */
    soup_at(part, &rng, 1e6f, 1e-3f, 100);
    aim_inside(part, &rng, 150, 4);
    part = part_add(made, "1e4, 1e-2");
    soup_at(part, &rng, 1e4f, 1e-2f, 100);
    aim_inside(part, &rng, 150, 0.5f);
}

static void make_far_unit(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "flat grid at 1e6");
    struct rng rng = rng_make(26, 0);
    part_grid(part, 16, 2, 1e6f, 1, 1e6f);
    for (int i = 0; i < 200; i++) {
        float x = whole(&rng, 16) + 0.25f, y = whole(&rng, 16) + 0.75f;
        float slant = whole(&rng, 5) - 2, d = i % 2 ? -4.0f : 4.0f;
        struct ray ray = ray_of(1e6f + x - slant, 1e6f + y, 1e6f - d, slant, 0, d);
        expect_id(part, HARD_ALL, ray, grid_tri(16, x, y));
    }
    part = part_add(made, "soup at 1e6");
    soup_at(part, &rng, 1e6f, 4, 100);
    aim_inside(part, &rng, 150, 32);
}

static void make_mixed(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "1e6 under 1e-3");
    struct rng rng = rng_make(27, 0);
    soup_at(part, &rng, 0, 1e-3f, 150);
    uint32_t below = part_triangle(part, -1e6f, -1e6f, -0.5f, 1e6f, -1e6f, -0.5f, 0, 1e6f, -0.5f);
    aim_inside(part, &rng, 200, 0.02f);
    for (int i = 0; i < 100; i++) {
        float x = rng_range(&rng, -1, 1), y = rng_range(&rng, -1, 1);
        float far = i % 2 ? 1e4f : 1;
        if (x * x + y * y < 0.01f)
            x += 1; /* beside the small ones */
        part_ray(part, ray_of(far * x, far * y, 1, 0.25f, 0, -1));
        if (i % 2 == 0) /* from afar woop's noise is as large as the small ones */
            want_id(part, HARD_ALL, below);
    }
}

/* A corridor seen lengthwise: walls that reach far behind the origin. Woop's absolute rounding
 * error there grows with their length; a relative pad of the boxes does not. */
static void make_corridor(struct hard_made *made)
{
    for (float length = 10; length <= 1000; length *= 10) {
        struct hard_part *part = part_add(made, "%g", (double)length);
        struct rng rng = rng_make(64, (uint64_t)length);
        part_cube(part, -1, 2);
        for (size_t i = 0; i < part->scene.vertex_count && !part->failed; i++)
            part->scene.vertex[3 * i + 2] *= length;
        for (int i = 0; i < 400; i++) { /* at the long edges, off by at most 1e-3 */
            float from[3] = {rng_range(&rng, -0.9f, 0.9f), rng_range(&rng, -0.9f, 0.9f), 0};
            float off = ldexpf(i & 4 ? 1.0f : -1.0f, -20 + (int)rng_below(&rng, 11));
            float to[3] = {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, rng_range(&rng, 0.2f, 4)};
            to[i & 8 ? 0 : 1] += off;
            expect_hit(part, HARD_TIGHT, ray_at(from, to));
        }
    }
}

const struct hard_case hard_scale_cases[] = {
    {
        .number = 23,
        .name = "powers-of-ten",
        .recipe = "a 4x4 grid times 1e-38 to 1e37; directions of its scale, and of length 1",
        .expected = "1e-9 to 1e11: the triangle aimed at; beyond: within the proven bounds",
        .source = "jbikker/tinybvh#283, godotengine/godot#53844: |det| < 1e-6; RTRS's F16",
        .make = make_powers,
    },
    {
        .number = 24,
        .name = "denormal-vertices",
        .recipe = "a grid whose coordinates are all denormal",
        .expected = "stored bounds contain it; answers within the proven bounds; the same twice",
        .source = "numerics.md 3.1: F16C under DAZ is not outward",
        .flags = HARD_TWICE,
        .make = make_denormals,
    },
    {
        .number = 25,
        .name = "far-and-small",
        .recipe = "triangles of 1e-3 at 1e6 (most snap to points or segments), of 1e-2 at 1e4",
        .expected = "what the oracle says, within the proven bounds",
        .source = "gkjohnson/three-mesh-bvh#112; Cycles T43835: far from the origin",
        .make = make_far_small,
    },
    {
        .number = 26,
        .name = "far-unit",
        .recipe = "a unit grid and a soup of size 4 at 1e6",
        .expected = "grid: the triangle aimed at, t within its bound; rf16 refuses",
        .source = "numerics.md 2.6: Embree's default slabs b/d - o/d lose 376 of 4096 there",
        .make = make_far_unit,
    },
    {
        .number = 27,
        .name = "mixed-scales",
        .recipe = "150 triangles of 1e-3 over one of 1e6",
        .expected = "what the oracle says; beside the small ones the large one",
        .source = "numerics.md 4, 27: thresholds relative to the scene",
        .make = make_mixed,
    },
    {
        .number = 64,
        .name = "corridor",
        .recipe = "a closed box 2 x 2 x 20 to 2000, from its middle at its long edges",
        .expected = "watertight tests: always a hit, through every tree whose boxes allow for it",
        .source = "found here: a relative pad of boxes is less than Woop's rounding of long walls",
        .make = make_corridor,
    },
    {0},
};

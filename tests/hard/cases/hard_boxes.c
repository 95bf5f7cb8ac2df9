/* Hard cases of boxes: origins in, on and beside them, flat ones, corners met by equal planes. */
#include "tests/hard/parts.h"

#include <math.h>

/* Triangle k, k = 1 .. 32, spans (-k, -k, 0), (k, -k, 0), (0, k, 2 k) in the plane z = y + k: every
 * box contains the points a little above the origin, no triangle comes nearer than 0.3. */
static struct hard_part *nested(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "nested");
    for (int i = 1; i <= 32; i++) {
        float k = (float)i;
        part_triangle(part, -k, -k, 0, k, -k, 0, 0, k, 2 * k);
    }
    return part;
}

static void make_away(struct hard_made *made)
{
    struct hard_part *part = nested(made);
    struct rng rng = rng_make(19, 0);
    for (int i = 0; i < 100; i++) {
        float o[3] = {0.125f * rng_float(&rng), 0.25f + 0.25f * rng_float(&rng),
                      0.125f + 0.125f * rng_float(&rng)};
        float dx = rng_range(&rng, -1, 1), dy = rng_float(&rng), dz = rng_range(&rng, -2, 0);
        /* away from z = y + k: dz - dy <= 0 */
        expect_miss(part, HARD_ALL,
                    ray_of(o[0], o[1], o[2], i % 3 ? dx : 0, i % 5 ? dy : 0, dz - 0.125f));
    }
}

static void make_behind(struct hard_made *made)
{
    struct hard_part *part = nested(made);
    for (int i = 0; i < 64; i++) {
        float x = 0.03125f * (float)(i % 8), y = 0.0625f * (float)(i / 8);
        float up = i % 2 ? 1.0f : 0.5f;
        expect_miss(part, HARD_ALL, ray_of(x, y, 0.25f, 0, 0, -up));
        expect_id(part, HARD_ALL, ray_of(x, y, 0.25f, 0, 0, up),
                  0); /* the same line, the other way */
        want_t(part, HARD_OWN, (y + 0.75f) / up);
    }
}

static void make_along_face(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "cube");
    part_cube(part, 0, 4);
    for (int axis = 0; axis < 3; axis++)
        for (int way = 0; way < 8; way++)
            for (int i = 1; i < 8; i++) {
                float from = way & 1 ? -2.0f : 6.0f, d = way & 1 ? 1.0f : -1.0f;
                float face = way & 2 ? 4.0f : 0.0f, zero = way & 4 ? -0.0f : 0.0f;
                struct ray ray = ray_of(from, 0.5f * (float)i, face, d, zero, 0);
                expect_t(part, HARD_OWN, ray_turned(axis, ray), 2);
            }
}

/* The ray meets the edge x = c, y = c of a cube from outside in one point only, at t = k: the near
 * plane of x and the far plane of y at exactly the same t. o = c - k d is exact. */
static void make_corner(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "cube");
    struct rng rng = rng_make(22, 0);
    part_cube(part, 0, 4);
    for (int i = 0; i < 300; i++) {
        float k = 1 + whole(&rng, 31), dx = 1 + whole(&rng, 63), dy = 1 + whole(&rng, 63);
        float z = 0.5f * (1 + whole(&rng, 7));
        part_ray(part, ray_turned(i % 3, ray_of(0 - k * dx, 4 - k * dy, z, dx, dy, 0)));
    }
}

static void make_flat(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "quads");
    struct rng rng = rng_make(34, 0);
    for (uint32_t i = 0; i < 150; i++) { /* axis-aligned squares, no two in one plane */
        float v[3], at[3];
        uint32_t up = i % 3, first = 4 * i;
        random_point(&rng, -50, 50, at);
        for (int c = 0; c < 4; c++) {
            v[up] = at[up];
            v[(up + 1) % 3] = at[(up + 1) % 3] + (c == 1 || c == 2 ? 2.0f : 0.0f);
            v[(up + 2) % 3] = at[(up + 2) % 3] + (c >= 2 ? 2.0f : 0.0f);
            part_vertex(part, v[0], v[1], v[2]);
        }
        part_tri(part, first, first + 1, first + 2);
        part_tri(part, first, first + 2, first + 3);
    }
    for (uint32_t i = 0; i < 300 && !part->failed; i++) {
        float from[3], to[3];
        part_point(part, &rng, i, to);
        random_point(&rng, -60, 60, from);
        struct ray ray = ray_at(from, to);
        uint32_t up = i / 2 % 3;
        if (i % 4 == 0) { /* straight down on it */
            ray = ray_of(to[0], to[1], to[2], 0, 0, 0);
            ray.org[up] -= 8;
            ray.dir[up] = 8;
        }
        expect_hit(part, HARD_ALL, ray);
    }
}

static void make_flat_far(struct hard_made *made)
{
    static const float at[] = {100.3f, -100.3f, 1000.7f, 60000.1f};
    for (size_t a = 0; a < ARRAY_COUNT(at); a++)
        for (int up = 0; up < 3; up++) {
            struct hard_part *part = part_add(made, "%g %c", (double)at[a], "xyz"[up]);
            struct rng rng = rng_make(35, 3 * a + (size_t)up);
            part_grid(part, 8, up, at[a], 1, 0);
            for (int i = 0; i < 32; i++) {
                float x = 0.25f + whole(&rng, 8), y = 0.75f + whole(&rng, 8);
                struct ray ray = ray_of(0, x, y, at[a] > 0 ? 1.0f : -1.0f, 0, 0);
                if (i % 2) { /* slanted: the origin a few cells aside */
                    ray.org[1] -= 64;
                    ray.dir[1] = 64 / fabsf(at[a]);
                }
                expect_id(part, HARD_ALL, ray_turned(up, ray), grid_tri(8, x, y));
            }
        }
}

/* The mean cost of rays with zeros among 8192 triangles: a tree that culls needs a few dozen box
 * tests, one that treats 0 as NaN or never culls needs thousands. */
static void make_budget(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", 64, 1);
    struct rng rng = rng_make(63, 0);
    part->boxes_most = 100;
    for (int i = 0; i < 96; i++) {
        float x = whole(&rng, 64) + 0.25f, y = whole(&rng, 64) + 0.75f;
        float zero = i & 1 ? -0.0f : 0.0f;
        struct ray ray = ray_of(x, y, 0, zero, zero, 1);
        if (i % 3 == 1)
            ray = ray_of(x - 2, y, 0, 2, zero, 1);
        else if (i % 3 == 2)
            ray = ray_of(x, y - 2, 0, zero, 2, 1);
        expect_id(part, HARD_ALL, ray, grid_tri(64, x, y));
    }
}

const struct hard_case hard_boxes_cases[] = {
    {
        .number = 19,
        .name = "away",
        .recipe =
            "the origin in the boxes of 32 nested triangles, directions away from all of them",
        .expected = "a miss",
        .source = "numerics.md 4, 19: the sign of the far distance",
        .flags = HARD_NO_HITS,
        .make = make_away,
    },
    {
        .number = 20,
        .name = "behind",
        .recipe = "the origin in boxes whose triangles all lie behind it; and the other way round",
        .expected = "a miss; the other way triangle 0 at an exact t",
        .source = "numerics.md 4, 20: a missing test of tmax >= 0",
        .make = make_behind,
    },
    {
        .number = 21,
        .name = "along-face",
        .recipe = "origins in the planes of a cube's faces, directions along them",
        .expected = "the edge of the face across, t = 2 exactly",
        .source = "svenstaro/bvh#140 and #142, libigl#2232: NaN of rays tangent to a face",
        .make = make_along_face,
    },
    {
        .number = 22,
        .name = "box-corner",
        .recipe =
            "rays that touch an edge of a cube from outside: near x and far y at equal exact t",
        .expected = "no tree loses what brute force with the same test hits",
        .source = "libigl#2232, #2271: Ize-type misses; numerics.md 3.4",
        .make = make_corner,
    },
    {
        .number = 34,
        .name = "flat-boxes",
        .recipe = "axis-aligned squares, aimed at inside, straight and slanted",
        .expected = "a hit",
        .source = "svenstaro/bvh#107, slangpy#1: a strict < loses boxes without thickness",
        .make = make_flat,
    },
    {
        .number = 35,
        .name = "flat-far",
        .recipe =
            "a flat grid at 100.3, -100.3, 1000.7, 60000.1 on each axis, seen from the origin",
        .expected = "the triangle aimed at",
        .source = "numerics.md 4, 35: a pad of 2e-6 is absorbed; RTRS's F14",
        .make = make_flat_far,
        .defect = {{.fault = "RTRS's fault F14: boxes flat in x and farther than 64 are lost",
                    .cause = CAUSE_STRICT_COMPARISON,
                    .members = "closest.*.f32.median.rtrs.mt"}},
    },
    {
        .number = 63,
        .name = "visit-budget",
        .recipe = "rays with zero components over a grid of 8192 triangles, box tests counted",
        .expected = "the triangle above, in at most 100 box tests on average",
        .source = "madmann91/bvh#60: 700 times slower; hankotanks/rt_rs: RTRS's F1 never culls",
        .make = make_budget,
        .defect = {{.fault = "RTRS's fault F1: y and z never cull, so that a ray visits every node",
                    .members = "closest.cpu.*.median.rtrs.mt"}},
    },
    {0},
};

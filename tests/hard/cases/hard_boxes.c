/* Hard cases of boxes: origins in, on and beside them, flat ones, corners met by equal planes. */
#include "tests/hard/parts.h"

#include <math.h>

/* Triangle k, k = 1 .. 32, spans (-k, -k, 0), (k, -k, 0), (0, k, 2 k) in the plane z = y + k: every
 * box contains what lies a little above the origin, no triangle comes nearer than 0.3. */
static struct hard_part *nested(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "nested");
    for (int i = 1; i <= 32; i++) {
        float k = (float)i, v[3][3] = {{-k, -k, 0}, {k, -k, 0}, {0, k, 2 * k}};
        part_tri_of(part, (const float(*)[3])v);
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
        want(part_ray(part, ray_of(o[0], o[1], o[2], i % 3 ? dx : 0, i % 5 ? dy : 0, dz - 0.125f)),
             HARD_ALL, WANT_MISS);
    }
}

const struct hard_case hard_away = {
    .number = 19,
    .name = "away",
    .recipe = "the origin in the boxes of 32 nested triangles, directions away from all of them",
    .expected = "a miss",
    .source = "numerics.md 4, 19: the sign of the far distance",
    .flags = HARD_NO_HITS,
    .make = make_away,
};

static void make_behind(struct hard_made *made)
{
    struct hard_part *part = nested(made);
    for (int i = 0; i < 64; i++) {
        float x = 0.03125f * (float)(i % 8), y = 0.0625f * (float)(i / 8);
        float up = i % 2 ? 1.0f : 0.5f;
        want(part_ray(part, ray_of(x, y, 0.25f, 0, 0, -up)), HARD_ALL, WANT_MISS);
        struct hard_want *w = part_ray(part, ray_of(x, y, 0.25f, 0, 0, up));
        want_id(part, w, HARD_ALL, 0); /* the same line, the other way */
        want_t(w, HARD_OWN, (y + 0.75f) / up);
    }
}

const struct hard_case hard_behind = {
    .number = 20,
    .name = "behind",
    .recipe = "the origin in boxes whose triangles all lie behind it; and the other way round",
    .expected = "a miss; the other way triangle 0 at an exact t",
    .source = "numerics.md 4, 20: a missing test of tmax >= 0",
    .make = make_behind,
};

static void make_along_face(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "cube");
    part_cube(part, (const float[3]){0, 0, 0}, 4);
    for (int axis = 0; axis < 3; axis++)
        for (int way = 0; way < 8; way++)
            for (int i = 1; i < 8; i++) {
                struct ray ray = ray_of(0, 0, 0, 0, 0, 0);
                int in = (axis + 1) % 3, on = (axis + 2) % 3;
                ray.org[axis] = way & 1 ? -2.0f : 6.0f;
                ray.dir[axis] = way & 1 ? 1.0f : -1.0f;
                ray.org[in] = 0.5f * (float)i;
                ray.org[on] = way & 2 ? 4.0f : 0.0f; /* in the plane of a face */
                ray.dir[in] = way & 4 ? -0.0f : 0.0f;
                want_t(part_ray(part, ray), HARD_OWN, 2);
            }
}

const struct hard_case hard_along_face = {
    .number = 21,
    .name = "along-face",
    .recipe = "origins in the planes of a cube's faces, directions along them",
    .expected = "the edge of the face across, t = 2 exactly",
    .source = "svenstaro/bvh#140 and #142, libigl#2232: NaN of rays tangent to a face",
    .make = make_along_face,
};

/* The ray meets the edge x = c, y = c of a cube from outside in one point only, at t = k: the near
 * plane of x and the far plane of y at exactly the same t. o = c - k d is exact. */
static void make_corner(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "cube");
    struct rng rng = rng_make(22, 0);
    part_cube(part, (const float[3]){0, 0, 0}, 4);
    for (int i = 0; i < 300; i++) {
        float k = (float)(1 + rng_below(&rng, 31));
        float dx = (float)(1 + rng_below(&rng, 63)), dy = (float)(1 + rng_below(&rng, 63));
        float o[3] = {0 - k * dx, 4 - k * dy, 0.5f * (float)(1 + rng_below(&rng, 7))};
        struct ray ray = ray_of(0, 0, 0, 0, 0, 0);
        int axis = i % 3;
        ray.org[axis] = o[0];
        ray.org[(axis + 1) % 3] = o[1];
        ray.org[(axis + 2) % 3] = o[2];
        ray.dir[axis] = dx;
        ray.dir[(axis + 1) % 3] = dy;
        part_ray(part, ray);
    }
}

const struct hard_case hard_corner = {
    .number = 22,
    .name = "box-corner",
    .recipe = "rays that touch an edge of a cube from outside: near x and far y at equal exact t",
    .expected = "no tree loses what brute force with the same test hits",
    .source = "libigl#2232, #2271: Ize-type misses; numerics.md 3.4",
    .make = make_corner,
};

static void make_flat(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "quads");
    struct rng rng = rng_make(34, 0);
    for (int i = 0; i < 150; i++) { /* axis-aligned squares, no two in one plane */
        float v[4][3], at[3];
        int up = i % 3;
        for (int k = 0; k < 3; k++)
            at[k] = rng_range(&rng, -50, 50);
        for (int c = 0; c < 4; c++) {
            v[c][up] = at[up];
            v[c][(up + 1) % 3] = at[(up + 1) % 3] + (c == 1 || c == 2 ? 2.0f : 0.0f);
            v[c][(up + 2) % 3] = at[(up + 2) % 3] + (c >= 2 ? 2.0f : 0.0f);
        }
        uint32_t first = part_vertex(part, v[0][0], v[0][1], v[0][2]);
        for (int c = 1; c < 4; c++)
            part_vertex(part, v[c][0], v[c][1], v[c][2]);
        part_tri(part, first, first + 1, first + 2);
        part_tri(part, first, first + 2, first + 3);
    }
    for (uint32_t i = 0; i < 300 && !part->failed; i++) {
        float from[3], to[3];
        part_point(part, &rng, i, to);
        for (int k = 0; k < 3; k++)
            from[k] = rng_range(&rng, -60, 60);
        struct ray ray = ray_at(from, to);
        int up = (int)(i / 2 % 3);
        if (i % 4 == 0) { /* straight down on it */
            ray = ray_of(to[0], to[1], to[2], 0, 0, 0);
            ray.org[up] -= 8;
            ray.dir[up] = 8;
        }
        want(part_ray(part, ray), HARD_ALL, WANT_HIT);
    }
}

const struct hard_case hard_flat = {
    .number = 34,
    .name = "flat-boxes",
    .recipe = "axis-aligned squares, aimed at inside, straight and slanted",
    .expected = "a hit",
    .source = "svenstaro/bvh#107, slangpy#1: a strict < loses boxes without thickness",
    .make = make_flat,
};

static void make_flat_far(struct hard_made *made)
{
    static const float at[] = {100.3f, -100.3f, 1000.7f, 60000.1f};
    for (size_t a = 0; a < ARRAY_COUNT(at); a++)
        for (int up = 0; up < 3; up++) {
            struct hard_part *part = part_add(made, "%g %c", (double)at[a], "xyz"[up]);
            struct rng rng = rng_make(35, 3 * a + (size_t)up);
            part_grid(part, 8, up, at[a], 1, 0);
            for (int i = 0; i < 32; i++) {
                float x = 0.25f + (float)rng_below(&rng, 8), y = 0.75f + (float)rng_below(&rng, 8);
                struct ray ray = ray_of(0, 0, 0, 0, 0, 0);
                ray.org[(up + 1) % 3] = x;
                ray.org[(up + 2) % 3] = y;
                ray.dir[up] = at[a] > 0 ? 1.0f : -1.0f;
                if (i % 2) { /* slanted: the origin a few cells aside */
                    ray.org[(up + 1) % 3] -= 64;
                    ray.dir[(up + 1) % 3] = 64 / fabsf(at[a]);
                }
                struct hard_want *w = part_ray(part, ray);
                want_id(part, w, HARD_ALL, grid_tri(8, x, y));
            }
        }
}

const struct hard_case hard_flat_far = {
    .number = 35,
    .name = "flat-far",
    .recipe = "a flat grid at 100.3, -100.3, 1000.7, 60000.1 on each axis, seen from the origin",
    .expected = "the triangle aimed at",
    .source = "numerics.md 4, 35: a pad of 2e-6 is absorbed; RTRS's F14",
    .make = make_flat_far,
    .defect = {{.fault = "F14: boxes flat in x and farther than 64 are lost",
                .cause = CAUSE_STRICT_COMPARISON,
                .members = "closest.*.f32.median.rtrs.mt"}},
};

/* The mean cost of rays with zeros among 8192 triangles: a tree that culls needs a few dozen box
 * tests, one that treats 0 as NaN or never culls needs thousands. */
static void make_budget(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "grid");
    struct rng rng = rng_make(63, 0);
    part_grid(part, 64, 2, 1, 1, 0);
    part->boxes_most = 100;
    for (int i = 0; i < 96; i++) {
        float x = (float)rng_below(&rng, 64) + 0.25f, y = (float)rng_below(&rng, 64) + 0.75f;
        float zero = i & 1 ? -0.0f : 0.0f;
        struct hard_want *w;
        if (i % 3 == 0)
            w = part_ray(part, ray_of(x, y, 0, zero, zero, 1));
        else if (i % 3 == 1)
            w = part_ray(part, ray_of(x - 2, y, 0, 2, zero, 1));
        else
            w = part_ray(part, ray_of(x, y - 2, 0, zero, 2, 1));
        want_id(part, w, HARD_ALL, grid_tri(64, x, y));
    }
}

const struct hard_case hard_budget = {
    .number = 63,
    .name = "visit-budget",
    .recipe = "rays with zero components over a grid of 8192 triangles, box tests counted",
    .expected = "the triangle above, in at most 100 box tests on average",
    .source = "madmann91/bvh#60: 700 times slower; hankotanks/rt_rs: RTRS's F1 never culls",
    .make = make_budget,
    .defect = {{.fault = "F1: y and z never cull, so that a ray visits every node",
                .members = "closest.cpu.*.median.rtrs.mt"}},
};

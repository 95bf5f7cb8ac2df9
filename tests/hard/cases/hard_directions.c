/* Hard cases of directions: zero, minus zero, tiny, huge and denormal components. */
#include "tests/hard/parts.h"

#include <math.h>

#define N 16 /* cells of the grid */

/* A point inside a triangle of the grid, a multiple of 1/8, off all its edges. */
static void inside(struct rng *rng, float *x, float *y)
{
    do {
        *x = off_lines(rng, N);
        *y = off_lines(rng, N);
    } while (*x - floorf(*x) == *y - floorf(*y));
}

static void make_axis(struct hard_made *made)
{
    for (int up = 0; up < 3; up++) {
        struct hard_part *part = part_add(made, "along %c", "xyz"[up]);
        struct rng rng = rng_make(1, (uint64_t)up);
        part_grid(part, N, up, 1, 1, 0);
        for (int i = 0; i < 64; i++) {
            float x, y, d = i % 2 ? -1.0f : 1.0f;
            inside(&rng, &x, &y);
            expect_id(part, HARD_ALL, ray_turned(up, ray_of(1 - d, x, y, d, 0, 0)),
                      grid_tri(N, x, y));
            want_t(part, HARD_ALL, 1);
        }
    }
}

static void make_minus_zero(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(2, 0);
    part->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    for (int i = 0; i < 32; i++) {
        float x, y;
        inside(&rng, &x, &y);
        size_t base = part->ray_count;
        for (int sign = 0; sign < 8; sign++) {
            struct ray ray = ray_of(x, y, sign & 4 ? -0.0f : 0.0f, sign & 1 ? -0.0f : 0.0f,
                                    sign & 2 ? -0.0f : 0.0f, 1);
            expect_id(part, HARD_ALL, ray, grid_tri(N, x, y));
            want_t(part, HARD_ALL, 1);
            want_like(part, HARD_ALL, base, 0, 0);
        }
    }
}

/* 1e-18 keeps the contract (2^-60 of the largest is 8.7e-19), 1e-19 does not. */
static void make_tiny_component(struct hard_made *made)
{
    static const float tiny[] = {1e-18f, -1e-18f, 1e-19f, -1e-19f, 1e-30f, -1e-30f};
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(6, 0);
    for (int i = 0; i < 16; i++) {
        float x, y;
        inside(&rng, &x, &y);
        for (int way = 0; way < 2; way++)
            for (size_t t = 0; t < ARRAY_COUNT(tiny); t++) {
                float slope = way ? 0.0625f : 0.0f;
                struct ray ray = ray_of(x, y - slope, 0, tiny[t], slope, 1);
                expect_id(part, HARD_ALL, ray, grid_tri(N, x, y));
            }
    }
}

/* A unit square whose plane is 2^40 to 2^64 away: only the tiny component brings the ray there. */
static void make_far_away(struct hard_made *made)
{
    for (int k = 40; k <= 64; k += 6) {
        struct hard_part *part = part_add(made, "2^%d", k);
        struct rng rng = rng_make(7, (uint64_t)k);
        float far = ldexpf(1, k);
        part_grid(part, 4, 1, far, 0.5f, 0);
        for (int i = 0; i < 32; i++) {
            float x = 0.0625f * (1 + whole(&rng, 31));
            float z = 0.0625f * (1 + whole(&rng, 31));
            part_ray(part, ray_of(x - 1, 0, z, 1 / far, 1, 0));
        }
    }
}

static void make_scaled(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(8, 0);
    part->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    for (int i = 0; i < 8; i++) {
        float x, y;
        inside(&rng, &x, &y);
        float from[3] = {rng_range(&rng, 0, N), rng_range(&rng, 0, N), rng_range(&rng, -8, 0)};
        struct ray base = ray_at(from, (const float[3]){x, y, 1});
        size_t like = part->ray_count;
        for (int k = -125; k <= 120; k += 5) {
            struct ray ray = base;
            int shift = k == -125 ? 0 : k; /* the ray that the others are compared with */
            for (int a = 0; a < 3; a++)
                ray.dir[a] = ldexpf(base.dir[a], shift);
            ray.tmax = INFINITY;
            bool promised = shift >= -36 && shift <= 36;
            enum hard_scope own = shift > 115 ? HARD_LEAN : HARD_OWN;
            enum hard_scope scope = promised ? HARD_ALL : own;
            expect_id(part, scope, ray, grid_tri(N, x, y));
            want_like(part, scope, like, -shift, 0);
        }
    }
}

static void make_denormal(struct hard_made *made)
{
    static const float small[] = {1e-40f, -1e-40f, 1e-45f, 0x1p-127f, 0x1p-126f, 1e-38f};
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(9, 0);
    for (int i = 0; i < 32; i++)
        for (size_t s = 0; s < ARRAY_COUNT(small); s++) {
            float x, y;
            inside(&rng, &x, &y);
            struct ray ray = ray_of(x, y, 0, i & 1 ? small[s] : 0, i & 2 ? small[s] : 0, small[s]);
            ray.tmax = INFINITY;
            part_ray(part, ray);
        }
}

static void make_zero(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(10, 0);
    for (int i = 0; i < 64; i++) {
        float x, y;
        inside(&rng, &x, &y);
        struct ray ray = ray_of(x, y, i & 8 ? 1.0f : 0.5f, 0, 0, 0);
        for (int k = 0; k < 3; k++)
            ray.dir[k] = i >> k & 1 ? -0.0f : 0.0f;
        expect_miss(part, HARD_ALL, ray);
    }
}

const struct hard_case hard_directions_cases[] = {
    {
        .number = 1,
        .name = "axis",
        .recipe =
            "d = (0,0,1) and the other axes, both ways, from inside the outline of a 16x16 grid",
        .expected = "the triangle above, t = 1 exactly",
        .source = "madmann91/bvh#9, #20, #21: zero components lose hits",
        .make = make_axis,
    },
    {
        .number = 2,
        .name = "minus-zero",
        .recipe = "as 1, with -0 for 0 in every combination of direction and origin",
        .expected = "the same triangle and t as with +0",
        .source = "jbikker/tinybvh#282: -0 picks the wrong octant",
        .make = make_minus_zero,
    },
    {
        .number = 6,
        .name = "tiny-component",
        .recipe = "one component of d is 1e-18, 1e-19 or 1e-30, the largest 1",
        .expected = "the same triangle as with 0",
        .source = "clamps of |d| < 1e-12 or 1e-18, as in Embree and several ports",
        .make = make_tiny_component,
    },
    {
        .number = 7,
        .name = "far-away",
        .recipe = "d = (2^-k, 1, 0) at unit cells in the plane y = 2^k, k = 40, 46 ... 64",
        .expected = "what the oracle says, within the proven bounds",
        .source = "numerics.md 4, 7: clamped slabs become infinite",
        .make = make_far_away,
    },
    {
        .number = 8,
        .name = "scaled-direction",
        .recipe = "d times 2^k, k = -120, -115 ... 120, tmax infinite",
        .expected = "the same triangle, t times 2^-k exactly",
        .source = "numerics.md 4, 8: absolute thresholds, overflow, Embree's largest float",
        .make = make_scaled,
    },
    {
        .number = 9,
        .name = "denormal-direction",
        .recipe = "d of 1e-38 down to 1e-45",
        .expected = "out of contract: ends, writes only its own answers, the same twice",
        .source = "numerics.md 4, 9: flush to zero, 1 / d = infinity",
        .flags = HARD_TWICE,
        .make = make_denormal,
    },
    {
        .number = 10,
        .name = "zero-direction",
        .recipe = "d = 0 in all signs of zero, origin in the boxes and on the triangles",
        .expected = "a miss, and an end",
        .source = "numerics.md 4, 10: NaN walks the whole tree",
        .flags = HARD_NO_HITS | HARD_TWICE,
        .make = make_zero,
    },
    {0},
};

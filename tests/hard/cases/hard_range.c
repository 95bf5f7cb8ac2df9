/* Hard cases of ranges: t at and beside tmin and tmax, empty and endless ranges. */
#include "tests/hard/parts.h"

#include <float.h>
#include <math.h>

#define N 8

/* A ray that hits the grid z = 4 at exactly t, a power of two; sometimes slanted. */
static struct ray meets_at(struct rng *rng, float t, uint32_t *id)
{
    float x = whole(rng, N) + 0.25f, y = whole(rng, N) + 0.75f;
    float slant = whole(rng, 3) - 1;
    *id = grid_tri(N, x, y);
    return ray_of(x - slant, y, 3, slant / t, 0, 1 / t);
}

static void make_ends(struct hard_made *made)
{
    static const float at[] = {1, 0.5f, 8, 0x1p20f, 0x1p-20f};
    struct hard_part *part = part_floor(made, "grid", N, 4);
    struct rng rng = rng_make(40, 0);
    for (size_t a = 0; a < ARRAY_COUNT(at); a++)
        for (int i = 0; i < 8; i++) {
            float t = at[a], less = nextafterf(t, 0), more = nextafterf(t, INFINITY);
            const float range[][2] = {{t, RAY_TMAX}, {less, RAY_TMAX}, {more, RAY_TMAX},
                                      {0, t},        {0, less},        {0, more},
                                      {t, t},        {less, more}};
            uint32_t id;
            struct ray ray = meets_at(&rng, t, &id);
            for (size_t r = 0; r < ARRAY_COUNT(range); r++) {
                part_ray(part, ray_between(ray, range[r][0], range[r][1]));
                if (range[r][0] > t || range[r][1] < t)
                    want(part, HARD_OWN, WANT_MISS);
                else if (range[r][0] == t || range[r][1] == t)
                    want(part, HARD_OWN, WANT_ENDS);
                else
                    want_id(part, HARD_OWN, id);
            }
        }
}

static void make_empty(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 4);
    struct rng rng = rng_make(41, 0);
    for (int i = 0; i < 12; i++) {
        const float range[][2] = {
            {2, 0.5f}, {nextafterf(1, 2), 1}, {INFINITY, 0},         {0.5f, 0.5f}, {2, 2},
            {0, -1},   {-0.5f, -0.5f},        {INFINITY, -INFINITY}, {0, 0}};
        uint32_t id;
        struct ray ray = meets_at(&rng, 1, &id);
        for (size_t r = 0; r < ARRAY_COUNT(range); r++)
            expect_miss(part, HARD_ALL, ray_between(ray, range[r][0], range[r][1]));
        part_ray(part, ray_between(ray, 1, 1));
        want(part, HARD_OWN, WANT_ENDS);
    }
}

static void make_endless(struct hard_made *made)
{
    static const float most[] = {INFINITY, FLT_MAX, 1e38f, 1e30f};
    struct hard_part *part = part_floor(made, "grid", N, 4);
    struct rng rng = rng_make(42, 0);
    for (int i = 0; i < 24; i++)
        for (size_t m = 0; m < ARRAY_COUNT(most); m++) {
            uint32_t id;
            struct ray ray = meets_at(&rng, i % 3 ? 1 : 0x1p30f, &id);
            expect_id(part, HARD_ALL, ray_between(ray, 0, most[m]), id);
            for (int k = 0; k < 3; k++) /* the same way off the scene */
                ray.dir[k] = -ray.dir[k];
            expect_miss(part, HARD_ALL, ray_between(ray, 0, most[m]));
        }
}

const struct hard_case hard_range_cases[] = {
    {
        .number = 40,
        .name = "range-ends",
        .recipe = "an exact t, with tmin or tmax at it and one float beside",
        .expected = "at an end: a hit where ends count; within: the triangle; beside: a miss",
        .source = "numerics.md 4, 40: open and closed ranges mixed; Embree: tnear < t <= tfar",
        .make = make_ends,
    },
    {
        .number = 41,
        .name = "empty-range",
        .recipe = "tmin > tmax, tmin = tmax beside the hit and at it, negative and infinite ends",
        .expected = "a miss, and an end; tmin = tmax = t: a hit where ends count",
        .source = "numerics.md 4, 41: a loop that never ends",
        .flags = HARD_TWICE,
        .make = make_empty,
    },
    {
        .number = 42,
        .name = "endless-range",
        .recipe =
            "tmax = infinity, the largest float, 1e38, 1e30; towards the grid and away from it",
        .expected = "the triangle aimed at; away: a miss",
        .source = "numerics.md 4, 42: infinity times the far factor, infinity - infinity",
        .make = make_endless,
    },
    {0},
};

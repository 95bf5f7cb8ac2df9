/* Hard cases of bad input: numbers outside every engine's contract. Every engine must return, write
 * only its own answers, and repeat them; a NaN ray hits nothing. */
#include "tests/hard/parts.h"

#include <float.h>
#include <math.h>

#define N 8

/* A ray that hits the grid z = 1, to be spoilt. */
static struct ray good_ray(struct rng *rng)
{
    float x = whole(rng, N) + 0.25f, y = whole(rng, N) + 0.75f;
    return rng_below(rng, 2) ? ray_of(x, y, 0, 0, 0, 1)
                             : ray_of(x - 0.5f, y - 0.5f, 0, 0.5f, 0.5f, 1);
}

/* Number `slot` of a ray: org, tmin, dir, tmax. */
static void spoil(struct ray *ray, int slot, float x)
{
    if (slot < 3)
        ray->org[slot] = x;
    else if (slot == 3)
        ray->tmin = x;
    else if (slot < 7)
        ray->dir[slot - 4] = x;
    else
        ray->tmax = x;
}

static void make_nan(struct hard_made *made)
{
    static const uint32_t pattern[] = {0x7FC00000u, 0xFFC00000u, 0x7F800001u, 0xFFFFFFFFu};
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(43, 0);
    for (int slot = 0; slot < 8; slot++)
        for (size_t p = 0; p < ARRAY_COUNT(pattern); p++)
            for (int i = 0; i < 4; i++) {
                struct ray ray = good_ray(&rng);
                spoil(&ray, slot, float_from_bits(pattern[p]));
                expect_miss(part, HARD_ALL, ray);
            }
    for (int i = 0; i < 8; i++) { /* everywhere */
        float nan = float_from_bits(pattern[i % 4]);
        expect_miss(part, HARD_ALL, (struct ray){{nan, nan, nan}, nan, {nan, nan, nan}, nan});
    }
}

static void infinite_rays(struct hard_made *made)
{
    static const float large[] = {INFINITY, FLT_MAX, 1e38f, 2e18f, 1.85e18f, 1e18f};
    struct hard_part *part = part_floor(made, "rays", N, 1);
    struct rng rng = rng_make(44, 0);
    for (int slot = 0; slot < 8; slot++)
        for (size_t l = 0; l < ARRAY_COUNT(large); l++)
            for (int sign = 0; sign < 2; sign++) {
                struct ray ray = good_ray(&rng);
                spoil(&ray, slot, sign ? -large[l] : large[l]);
                part_ray(part, ray);
            }
}

static void bad_vertex(struct hard_made *made, const char *label, float x, int axis)
{
    struct hard_part *part = part_floor(made, label, N, 1);
    struct rng rng = rng_make(44, (uint64_t)axis);
    part->bad_scene = !float_is_finite(x);
    part->must_refuse = part->bad_scene ? "f32 rf16" : NULL;
    if (!part->failed)
        part->scene.vertex[3 * 40 + axis] = x; /* six triangles meet there */
    for (int i = 0; i < 32; i++)
        part_ray(part, good_ray(&rng));
}

static void make_infinite(struct hard_made *made)
{
    infinite_rays(made);
    bad_vertex(made, "NaN in x", NAN, 0);
    bad_vertex(made, "NaN in y", NAN, 1);
    bad_vertex(made, "NaN in z", -NAN, 2);
    bad_vertex(made, "infinite x", INFINITY, 0);
    bad_vertex(made, "-infinite z", -INFINITY, 2);
    bad_vertex(made, "largest z", FLT_MAX, 2);
    bad_vertex(made, "-largest x", -FLT_MAX, 0);
    bad_vertex(made, "1.9e18", 1.9e18f, 0);
    bad_vertex(made, "2^40", 0x1p40f, 1);
}

const struct hard_case hard_bad_input_cases[] = {
    {
        .number = 43,
        .name = "nan-ray",
        .recipe = "NaN of every kind in each of a ray's eight numbers, and in all",
        .expected = "a miss, and an end; the same twice",
        .source = "reone#341: NaN walks the whole tree",
        .flags = HARD_NO_HITS | HARD_TWICE,
        .make = make_nan,
    },
    {
        .number = 44,
        .name = "infinite",
        .recipe = "infinite and huge numbers in rays; vertices NaN, infinite, huge",
        .expected = "ends, the same twice, finite hits; layouts refuse what is not finite",
        .source = "devil_ray#62, gfx-rs/wgpu#8204: NaN vertices; Embree asserts from 1.8e18 on",
        .flags = HARD_TWICE,
        .make = make_infinite,
    },
    {0},
};

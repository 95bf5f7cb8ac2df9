/* Laws of ref/primitives/tri.h: directions longer than those in contract. */
#include "ref/base/rng.h"
#include "ref/primitives/test_run.h"
#include "tests/support/triangle_drawn.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

/* A direction that an instance made long: the products of an edge, a vertex and it are beyond
 * float32. mt_rtrs has a scale of its own. */
static void a_long_direction_changes_t_alone(void **state)
{
    (void)state;
    static const uint32_t scale_free[] = {ABI_TRI_MT, ABI_TRI_WOOP, ABI_TRI_PLUECKER,
                                          ABI_TRI_BALDWIN_WEBBER};
    for (size_t i = 0; i < ARRAY_COUNT(scale_free); i++) {
        struct rng rng = rng_make(8, i);
        uint32_t hits = 0;
        for (int n = 0; n < 20000; n++) {
            struct ray ray;
            struct hit hit, other;
            float v[3][3];
            int k = (int)rng_below(&rng, 41), j = (int)rng_below(&rng, 120);
            triangle_drawn(&rng, &ray, v);
            for (int x = 0; x < 3; x++) {
                ray.org[x] = ldexpf(ray.org[x], k);
                for (int c = 0; c < 3; c++)
                    v[c][x] = ldexpf(v[c][x], k);
            }
            ray.tmax = INFINITY;
            bool first = triangle_run(scale_free[i], &ray, v, &hit);
            for (int x = 0; x < 3; x++)
                ray.dir[x] = ldexpf(ray.dir[x], j);
            assert_int_equal(triangle_run(scale_free[i], &ray, v, &other), first);
            if (!first)
                continue;
            hits++;
            assert_true(other.t == ldexpf(hit.t, -j));
            assert_true(other.u == hit.u && other.v == hit.v);
        }
        assert_true(hits > 5000);
    }
}

/* The threshold is for the determinant of the direction as given, however long: a triangle of size
 * 2^-k with a direction of length 2^j has one near 2^(j - 2k). */
static void the_threshold_of_mt_rtrs_knows_long_directions(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 0);
    uint32_t passed = 0, refused = 0;
    for (int n = 0; n < 20000; n++) {
        struct ray ray;
        struct hit hit;
        float v[3][3];
        double d[3], e1[3], e2[3];
        int k = 35 + (int)rng_below(&rng, 11), j = 2 * k - 28 + (int)rng_below(&rng, 9);
        triangle_drawn(&rng, &ray, v);
        for (int x = 0; x < 3; x++) {
            ray.org[x] = ldexpf(ray.org[x], -k);
            ray.dir[x] = ldexpf(ray.dir[x], j);
            for (int c = 0; c < 3; c++)
                v[c][x] = ldexpf(v[c][x], -k);
            d[x] = (double)ray.dir[x];
            e1[x] = (double)v[1][x] - (double)v[0][x];
            e2[x] = (double)v[2][x] - (double)v[0][x];
        }
        double det = d[0] * (e1[1] * e2[2] - e1[2] * e2[1]) +
                     d[1] * (e1[2] * e2[0] - e1[0] * e2[2]) +
                     d[2] * (e1[0] * e2[1] - e1[1] * e2[0]);
        ray.tmax = INFINITY;
        if (!triangle_run(ABI_TRI_MT, &ray, v, &hit) || fabs(fabs(det) / 1e-7 - 1) < 1e-2)
            continue;
        assert_int_equal(triangle_run(ABI_TRI_MT_RTRS, &ray, v, &hit), fabs(det) > 1e-7);
        *(fabs(det) > 1e-7 ? &passed : &refused) += 1;
    }
    assert_true(passed > 2000 && refused > 2000);
}

/* inf / inf would be the u of a hit. woop divides by the direction alone: it has a shear of 0. */
static void a_direction_that_is_not_finite_is_a_miss(void **state)
{
    (void)state;
    static const uint32_t tests[] = {ABI_TRI_MT, ABI_TRI_MT_RTRS, ABI_TRI_PLUECKER,
                                     ABI_TRI_BALDWIN_WEBBER};
    for (size_t i = 0; i < ARRAY_COUNT(tests); i++) {
        struct rng rng = rng_make(10, i);
        for (int n = 0; n < 3000; n++) {
            struct ray ray;
            struct hit hit;
            float v[3][3];
            triangle_drawn(&rng, &ray, v);
            ray.dir[n % 3] = n % 2 ? INFINITY : -INFINITY;
            assert_false(triangle_run(tests[i], &ray, v, &hit));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_direction_changes_t_alone),
        cmocka_unit_test(the_threshold_of_mt_rtrs_knows_long_directions),
        cmocka_unit_test(a_direction_that_is_not_finite_is_a_miss),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

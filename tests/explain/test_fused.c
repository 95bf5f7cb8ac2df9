/* Triangle tests as a compiler contracts them (ref/explain/fused.h). Where nothing is rounded they
 * are the tests as written, bit by bit. */
#include "ref/base/rng.h"
#include "ref/explain/fused.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

static bool is_power(float x)
{
    return (float_bits(x) & 0x007FFFFFu) == 0 && x != 0;
}

static float whole(struct rng *rng, uint32_t most)
{
    return (float)((int)rng_below(rng, 2 * most + 1) - (int)most);
}

/* In whole numbers of a power of two; what the tests divide by are powers of two: the direction's
 * largest component, the normal's, and the determinant, unless it is 0. */
static bool draw(struct rng *rng, struct ray *ray, float v[3][3])
{
    float n[3], e1[3], e2[3], largest = 0, along = 0, det;
    *ray = (struct ray){.tmin = -64, .tmax = 64};
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            v[c][k] = whole(rng, 6);
        ray->org[k] = whole(rng, 6);
        ray->dir[k] = whole(rng, 4);
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
        largest = fmaxf(largest, fabsf(ray->dir[k]));
    }
    tri_cross(e1, e2, n);
    for (int k = 0; k < 3; k++)
        along = fmaxf(along, fabsf(n[k]));
    det = tri_dot(ray->dir, n);
    const int size = 9 * ((int)rng_below(rng, 3) - 1), way = 7 * ((int)rng_below(rng, 3) - 1);
    for (int k = 0; k < 3; k++) { /* of any size: the powers of two change nothing */
        for (int c = 0; c < 3; c++)
            v[c][k] = ldexpf(v[c][k], size);
        ray->org[k] = ldexpf(ray->org[k], size);
        ray->dir[k] = ldexpf(ray->dir[k], way);
    }
    ray->tmin = ldexpf(ray->tmin, size - way);
    ray->tmax = ldexpf(ray->tmax, size - way);
    return is_power(largest) && is_power(along) && (det == 0 || is_power(det));
}

static void same_as_written_where_nothing_is_rounded(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 17);
    uint32_t hits[8] = {0}, played = 0;
    while (played < 60000) {
        struct ray ray;
        float v[3][3];
        if (!draw(&rng, &ray, v))
            continue;
        struct tri_ray ready = tri_ray_make(&ray);
        played++;
        for (size_t i = 0; tri_tests[i]; i++) {
            struct hit plain = {0}, fused = {0};
            uint32_t id = tri_tests[i]->id;
            bool hit = tri_test_run(id, &ready, v, &plain);
            if (fused_tri_run(id, &ready, v, &fused) != hit)
                fail_msg("%s: %d as written", tri_tests[i]->name, hit);
            if (hit && (fused.t != plain.t || fused.u != plain.u || fused.v != plain.v))
                fail_msg("%s: t %g u %g v %g, as written %g %g %g", tri_tests[i]->name,
                         (double)fused.t, (double)fused.u, (double)fused.v, (double)plain.t,
                         (double)plain.u, (double)plain.v);
            hits[i] += hit;
        }
    }
    for (size_t i = 0; tri_tests[i]; i++)
        assert_true(hits[i] > 500);
}

/* Else they are other numbers, near those as written. */
static void other_numbers_where_products_are_rounded(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 17);
    uint32_t hits[8] = {0}, others[8] = {0};
    for (int n = 0; n < 20000; n++) {
        struct ray ray = {.tmax = 64};
        float v[3][3];
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -1, 1);
            for (int c = 0; c < 3; c++)
                v[c][k] = rng_range(&rng, -1, 1);
            ray.dir[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - ray.org[k];
        }
        struct tri_ray ready = tri_ray_make(&ray);
        for (size_t i = 0; tri_tests[i]; i++) {
            struct hit plain = {0}, fused = {0};
            uint32_t id = tri_tests[i]->id;
            if (!tri_test_run(id, &ready, v, &plain) || !fused_tri_run(id, &ready, v, &fused))
                continue;
            hits[i]++;
            others[i] += fused.t != plain.t;
        }
    }
    for (size_t i = 0; tri_tests[i]; i++)
        assert_true(hits[i] > 15000 && others[i] > hits[i] / 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_as_written_where_nothing_is_rounded),
        cmocka_unit_test(other_numbers_where_products_are_rounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What the map of states says of a ray, each state by its own definition, for rays of every number
 * that is special in each of their eight places. */
#include "fuzz/play/coverage_bits.h"
#include "ref/base/rng.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static const struct box root = {{-1, -2, -3}, {1, 2, 0.5f}};

/* Those below, at and above each border, either sign. */
static float special(struct rng *rng)
{
    static const float about[] = {0, 0x1p-149f, FLT_MIN, 0x1p-20f, 0.5f,     1,       2,
                                  3, 0x1p20f,   0x1p40f, FLT_MAX,  INFINITY, INFINITY};
    float x = about[rng_below(rng, ARRAY_COUNT(about))];
    uint32_t step = rng_below(rng, 6);
    if (rng_below(rng, 40) == 0)
        x = NAN;
    else if (step < 2 && x > 0)
        x = nextafterf(x, step ? INFINITY : 0);
    return rng_below(rng, 2) ? -x : x;
}

/* The states of the ray, as coverage_bits.h defines them. */
static uint32_t states_of(const struct ray *ray)
{
    const float number[8] = {ray->org[0], ray->org[1], ray->org[2], ray->dir[0],
                             ray->dir[1], ray->dir[2], ray->tmin,   ray->tmax};
    bool is[COVERAGE_RAYS] = {[COVERAGE_RAY_OUT] = !ray_in_contract(ray),
                              [COVERAGE_RAY_POINT] = ray->tmin == ray->tmax,
                              [COVERAGE_RAY_BACKWARD] = ray->tmin > ray->tmax,
                              [COVERAGE_RAY_ENDLESS] = ray->tmax == INFINITY};
    bool finite = true, within = true, on_plane = false;
    uint32_t zeros = 0, mask = 0;
    float most = 0;
    for (int k = 0; k < 8; k++) {
        is[COVERAGE_RAY_NAN] |= isnan(number[k]);
        is[COVERAGE_RAY_INFINITE] |= k < 6 && isinf(number[k]);
        finite = finite && (k >= 6 || isfinite(number[k]));
    }
    for (int k = 0; k < 3 && finite; k++) {
        float o = ray->org[k], d = ray->dir[k];
        zeros += d == 0;
        most = fmaxf(most, fabsf(d));
        is[COVERAGE_RAY_MINUS] |= d == 0 && signbit(d);
        is[COVERAGE_RAY_SUBNORMAL] |= fpclassify(d) == FP_SUBNORMAL;
        within = within && o >= root.lo[k] && o <= root.hi[k];
        on_plane = on_plane || o == root.lo[k] || o == root.hi[k];
    }
    if (finite) {
        is[COVERAGE_RAY_PARALLEL] = zeros == 1;
        is[COVERAGE_RAY_ONE_AXIS] = zeros == 2;
        is[COVERAGE_RAY_ZERO] = zeros == 3;
        is[COVERAGE_RAY_FAST] = most > 0x1p20f;
        is[COVERAGE_RAY_SLOW] = most > 0 && most < 0x1p-20f;
        is[COVERAGE_RAY_INSIDE] = within && !on_plane;
        is[COVERAGE_RAY_ON_FACE] = within && on_plane;
    }
    for (uint32_t b = 0; b < COVERAGE_RAYS; b++)
        mask |= (uint32_t)is[b] << b;
    return mask;
}

static uint32_t told(const struct ray *ray)
{
    uint64_t map[COVERAGE_WORDS] = {0};
    uint32_t mask = 0;
    coverage_add_truth(map, ray, &root, &(struct oracle_answer){.prim = ABI_NO_PRIM});
    for (uint32_t b = 0; b < COVERAGE_RAYS; b++)
        mask |= (uint32_t)(map[(COVERAGE_RAY + b) / 64] >> (COVERAGE_RAY + b) % 64 & 1) << b;
    return mask;
}

static void each_state_of_a_ray_is_as_defined(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 1);
    uint32_t seen[COVERAGE_RAYS] = {0};
    for (uint32_t i = 0; i < 200000; i++) {
        const float plain[8] = {0.25f, 1.5f, -0.5f, 1, 2, -3, 0, 100};
        struct ray ray;
        float *const number[8] = {&ray.org[0], &ray.org[1], &ray.org[2], &ray.dir[0],
                                  &ray.dir[1], &ray.dir[2], &ray.tmin,   &ray.tmax};
        uint32_t drawn = (uint32_t)rng_u64(&rng), all = rng_below(&rng, 3);
        for (int k = 0; k < 8; k++)
            *number[k] = all || drawn >> k & 1 ? special(&rng) : plain[k];
        for (int k = 0; k < 3 && rng_below(&rng, 8) == 0; k++)
            ray.dir[k] = drawn >> (8 + k) & 1 ? -0.0f : 0.0f;
        if (all == 1)
            *number[i % 8] = NAN, *number[(i + 1 + i / 8 % 7) % 8] = plain[0];
        uint32_t wanted = states_of(&ray), got = told(&ray);
        if (got != wanted)
            fail_msg("o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a]: states %#x, not %#x", (double)ray.org[0],
                     (double)ray.org[1], (double)ray.org[2], (double)ray.dir[0], (double)ray.dir[1],
                     (double)ray.dir[2], (double)ray.tmin, (double)ray.tmax, got, wanted);
        for (uint32_t b = 0; b < COVERAGE_RAYS; b++)
            seen[b] += wanted >> b & 1;
    }
    for (uint32_t b = 0; b < COVERAGE_RAYS; b++)
        if (seen[b] < 50)
            fail_msg("state %u of %u rays alone", b, seen[b]);
}

/* NaN in one place alone, beside numbers that are plain. */
static void a_number_that_is_none_is_seen_in_every_place(void **state)
{
    (void)state;
    for (int k = 0; k < 8; k++) {
        struct ray ray = {{0.25f, 1.5f, -0.5f}, 0, {1, 2, -3}, 100};
        float *const number[8] = {&ray.org[0], &ray.org[1], &ray.org[2], &ray.dir[0],
                                  &ray.dir[1], &ray.dir[2], &ray.tmin,   &ray.tmax};
        assert_int_equal(told(&ray) >> COVERAGE_RAY_NAN & 1, 0);
        *number[k] = NAN;
        assert_int_equal(told(&ray), states_of(&ray));
        assert_int_equal(told(&ray) >> COVERAGE_RAY_NAN & 1, 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_state_of_a_ray_is_as_defined),
        cmocka_unit_test(a_number_that_is_none_is_seen_in_every_place),
    };
    return cmocka_run_group_tests_name("coverage_rays", tests, NULL, NULL);
}

/* A trial at another scale is the one that it is made from, to the bit, when it is scaled back: of
 * rays and scenes of all sizes, each kind of scaling, each step; and nothing of it leaves what rays
 * and scenes are answered for. Where a bit would be lost, there is none. */
#include "fuzz/play/scaled.h"
#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define MOST 0x1p39 /* numbers are made no larger */

static struct reason reason;

/* A number of up to `bits` bits, about 2^exponent; sometimes 0. */
static float drawn(struct rng *rng, int exponent, uint32_t bits)
{
    uint32_t m = (uint32_t)rng_u64(rng) >> 9 & (UINT32_MAX << (23 - bits));
    float x = ldexpf(1 + ldexpf((float)m, -23), exponent);
    x = rng_below(rng, 6) ? x : 0;
    return rng_below(rng, 2) ? -x : x;
}

static int between(struct rng *rng, int low, int high)
{
    return low + (int)rng_below(rng, (uint32_t)(high - low + 1));
}

static struct fuzz_trial trial_of(struct rng *rng)
{
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(3, 1, 1, &trial, &reason), STATUS_OK);
    struct ray *ray = &trial.ray[0];
    const int large = between(rng, -20, 37), turn = between(rng, -20, 37);
    const uint32_t bits = rng_below(rng, 2) ? 23 : rng_below(rng, 4);
    for (int k = 0; k < 3; k++) {
        const int size = rng_below(rng, 3) ? large : between(rng, -130, large);
        for (int c = 0; c < 3; c++)
            trial.scene.vertex[3 * c + k] = drawn(rng, size, bits);
        ray->org[k] = drawn(rng, size, bits);
        ray->dir[k] = drawn(rng, rng_below(rng, 2) ? turn : turn - between(rng, 0, 58), bits);
    }
    for (uint32_t i = 0; i < 3; i++)
        trial.scene.index[i] = i;
    ray->tmin = rng_below(rng, 3) ? 0 : fabsf(drawn(rng, between(rng, -149, 2), 3));
    ray->tmax = rng_below(rng, 3) ? INFINITY : ray->tmin + 100;
    return trial;
}

/* Power by which b is a; 0 with *exact false if no power of two does. */
static int power_of(float a, float b, bool *exact)
{
    int from, to;
    *exact = *exact && frexpf(a, &from) == frexpf(b, &to);
    return *exact ? to - from : 0;
}

/* Positions of an axis have one power, t and the direction those that go with it. */
static void assert_scaled(const struct fuzz_trial *trial, const struct fuzz_trial *to, int t)
{
    const struct ray *a = &trial->ray[0], *b = &to->ray[0];
    bool exact = true;
    for (int k = 0; k < 3; k++) {
        int by = 0;
        for (int c = 0; c < 4; c++) {
            float from = c < 3 ? trial->scene.vertex[3 * c + k] : a->org[k];
            float scaled = c < 3 ? to->scene.vertex[3 * c + k] : b->org[k];
            int power = power_of(from, scaled, &exact);
            assert_true(from == 0 || by == 0 || by == power);
            by = from == 0 ? by : power;
            assert_true(fabs((double)scaled) < MOST);
        }
        int power = power_of(a->dir[k], b->dir[k], &exact);
        /* Nothing tells the power of an axis of zeros. */
        assert_true(a->dir[k] == 0 || by == 0 || power == by - t);
        assert_true(fabs((double)b->dir[k]) < MOST);
    }
    exact = exact && (isinf(b->tmax) || ldexpf(b->tmax, -t) == a->tmax);
    if (!exact || ldexpf(b->tmin, -t) != a->tmin)
        fail_msg("d=(%a,%a,%a) t=[%a,%a] by 2^%d is d=(%a,%a,%a) t=[%a,%a]", (double)a->dir[0],
                 (double)a->dir[1], (double)a->dir[2], (double)a->tmin, (double)a->tmax, t,
                 (double)b->dir[0], (double)b->dir[1], (double)b->dir[2], (double)b->tmin,
                 (double)b->tmax);
}

static void what_is_scaled_loses_no_bit(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 1);
    size_t made[FUZZ_SCALINGS] = {0}, refused[FUZZ_SCALINGS] = {0};
    for (uint32_t i = 0; i < 40000; i++) {
        struct fuzz_trial trial = trial_of(&rng), scaled;
        const enum fuzz_scaling scaling = i % FUZZ_SCALINGS;
        const uint32_t step = i % 3 ? FUZZ_SCALE_STEPS : 1 + rng_below(&rng, FUZZ_SCALE_STEPS);
        bool possible;
        int power;
        assert_int_equal(
            fuzz_trial_scaled(&trial, 0, scaling, step, &scaled, &power, &possible, &reason),
            STATUS_OK);
        if (possible)
            assert_scaled(&trial, &scaled, power);
        else
            assert_null(scaled.ray);
        made[scaling] += possible;
        refused[scaling] += !possible && ray_in_contract(&trial.ray[0]);
        fuzz_trial_free(&scaled);
        fuzz_trial_free(&trial);
    }
    for (size_t s = 0; s < FUZZ_SCALINGS; s++)
        assert_true(made[s] > 3000);
    assert_true(refused[FUZZ_SCALE_AXES] > 100);
}

/* The most that anything is in the world, placed or not, by doubles. */
static double extent(const struct fuzz_trial *trial)
{
    double vertex = 0, most;
    for (size_t i = 0; i < 9; i++)
        vertex = fmax(vertex, fabs((double)trial->scene.vertex[i]));
    most = vertex;
    for (uint32_t i = 0; i < trial->world.instance_count; i++)
        for (int k = 0; k < 3; k++) {
            const float *m = trial->world.instance[i].m[k];
            const double turned = fabs((double)m[0]) + fabs((double)m[1]) + fabs((double)m[2]);
            most = fmax(most, turned * vertex + fabs((double)m[3]));
        }
    return most;
}

/* An entry of a transform that is far larger than the others counts, wherever it is. */
static void nothing_placed_grows_beyond_what_is_answered(void **state)
{
    (void)state;
    for (uint32_t entry = 0; entry < 24; entry++)
        for (int size = -10; size <= 18; size += 2) {
            struct fuzz_trial trial, scaled;
            bool possible;
            int power;
            assert_int_equal(fuzz_trial_make(3, 1, 1, &trial, &reason), STATUS_OK);
            assert_int_equal(trial_world_make(1, 1, 2, 1, &trial.world, &reason), STATUS_OK);
            for (uint32_t i = 0; i < 3; i++) {
                trial.scene.index[i] = i;
                trial.scene.vertex[4 * i] = 1;
            }
            trial.ray[0] = (struct ray){{0.5f, 0.5f, 0.5f}, 0, {0, 0, 1}, INFINITY};
            trial.world.instance[entry / 12].m[entry % 12 / 4][entry % 4] = ldexpf(1.5f, size);
            assert_int_equal(fuzz_trial_scaled(&trial, 0, FUZZ_SCALE_ALL, FUZZ_SCALE_STEPS, &scaled,
                                               &power, &possible, &reason),
                             STATUS_OK);
            assert_true(possible);
            /* As far as can be, and no further. */
            assert_true(extent(&scaled) < MOST && extent(&scaled) >= MOST / 4);
            fuzz_trial_free(&scaled);
            fuzz_trial_free(&trial);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_scaled_loses_no_bit),
        cmocka_unit_test(nothing_placed_grows_beyond_what_is_answered),
    };
    return cmocka_run_group_tests_name("scaled_exact", tests, NULL, NULL);
}

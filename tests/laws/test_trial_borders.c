/* Borders of what a trial of a world may be, and the powers of two of the shrinker, by libm's. */
#include "fuzz/play/trial.h"
#include "fuzz/shrink/shrink_inner.h"
#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* A world of one mesh of so many triangles, placed so many times. */
static struct fuzz_trial placed(uint32_t triangles, uint32_t instances)
{
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(3, triangles, 1, &trial, &reason), STATUS_OK);
    trial.scene.vertex[0] = trial.scene.vertex[4] = 1;
    for (uint32_t i = 0; i < 3 * triangles; i++)
        trial.scene.index[i] = i % 3;
    trial.ray[0].dir[2] = 1;
    assert_int_equal(trial_world_make(triangles, 1, instances, 1, &trial.world, &reason),
                     STATUS_OK);
    for (uint32_t i = 0; i < instances; i++)
        trial.world.instance[i].mesh = 0;
    return trial;
}

static void placed_triangles_have_a_border(void **state)
{
    (void)state;
    const uint32_t most = FUZZ_PLACED_MOST / FUZZ_INSTANCES_MOST;
    for (uint32_t triangles = most - 1; triangles < most + 3; triangles++) {
        const uint32_t border = FUZZ_PLACED_MOST / triangles;
        for (uint32_t more = 0; more < 2; more++) {
            uint32_t count = border + more;
            if (count > FUZZ_INSTANCES_MOST)
                continue;
            struct fuzz_trial trial = placed(triangles, count);
            char why[80];
            snprintf(why, sizeof why, "a trial has at most 1048576 placed triangles, not %u",
                     count * triangles);
            enum status status = fuzz_trial_check(&trial, &reason);
            assert_int_equal(status, more ? STATUS_LIMIT : STATUS_OK);
            if (more && !strstr(reason.text, why))
                fail_msg("%s", reason.text);
            fuzz_trial_free(&trial);
        }
    }
}

/* Counts that no array is as long as are refused before it is read. */
static void counts_have_a_border(void **state)
{
    (void)state;
    static const uint32_t count[][2] = {
        {FUZZ_GEOMETRIES_MOST + 1, 1}, {1, FUZZ_INSTANCES_MOST + 1}, {UINT32_MAX, UINT32_MAX}};
    for (size_t i = 0; i < ARRAY_COUNT(count); i++) {
        struct fuzz_trial trial = placed(2, 1);
        trial.world.geometry_count = count[i][0];
        trial.world.instance_count = count[i][1];
        assert_int_equal(trial_world_check(&trial.world, &trial.scene, 0, &reason), STATUS_LIMIT);
        assert_string_equal(reason.text, "a trial has at most 64 geometries and 4096 instances");
        trial.world.geometry_count = trial.world.instance_count = 1;
        assert_int_equal(trial_world_check(&trial.world, &trial.scene, 0, &reason), STATUS_OK);
        fuzz_trial_free(&trial);
    }
}

/* Each number of what a trial has by itself, and how far a world's instances are from the identity
 * as the sum of what each is. */
static void each_count_has_its_own_border(void **state)
{
    (void)state;
    static const uint32_t most[3] = {3 * FUZZ_TRIANGLES_MOST, FUZZ_TRIANGLES_MOST, FUZZ_RAYS_MOST};
    for (int which = 0; which < 3; which++)
        for (uint32_t more = 0; more < 2; more++) {
            uint32_t count[3] = {3, 1, 1};
            struct fuzz_trial trial;
            count[which] = most[which] + more;
            assert_int_equal(fuzz_trial_make(count[0], count[1], count[2], &trial, &reason),
                             more ? STATUS_LIMIT : STATUS_OK);
            assert_int_equal(trial.ray_count, more ? 0 : count[2]);
            fuzz_trial_free(&trial);
        }
}

static void places_are_the_sum_of_the_instances(void **state)
{
    (void)state;
    struct rng rng = rng_make(6, 1);
    uint32_t kinds = 0;
    for (uint32_t turn = 0; turn < 50; turn++) {
        struct fuzz_trial trial = placed(1, 1 + turn % 7);
        uint32_t sum = 0;
        for (uint32_t i = 0; i < trial.world.instance_count; i++) {
            float(*m)[4] = trial.world.instance[i].m;
            const uint32_t kind = rng_below(&rng, 4);
            m[0][3] = kind > 0 ? 2 : 0;
            m[1][1] = kind > 1 ? 3 : 1;
            m[1][2] = kind > 2 ? 0.5f : 0;
            sum += trial_world_place(&trial.world.instance[i]);
            kinds |= 1u << trial_world_place(&trial.world.instance[i]);
        }
        assert_int_equal(trial_world_places(&trial.world), sum);
        fuzz_trial_free(&trial);
    }
    assert_true((kinds & (kinds - 1)) != 0); /* of more than one kind */
}

static void exponents_are_libms(void **state)
{
    (void)state;
    static const float none[] = {0.0f, -0.0f, INFINITY, -INFINITY, NAN};
    struct rng rng = rng_make(3, 1);
    for (size_t i = 0; i < ARRAY_COUNT(none); i++)
        assert_int_equal(shrink_exponent(none[i]), 0);
    for (uint32_t i = 0; i < 200000; i++) {
        uint32_t bits = (uint32_t)rng_u64(&rng);
        float x = float_from_bits(i % 2 ? bits : bits & 0x80FFFFFFu >> i % 24); /* many subnormal */
        if (x != 0 && float_is_finite(x) && shrink_exponent(x) != ilogbf(x))
            fail_msg("%a: %d", (double)x, shrink_exponent(x));
    }
}

/* Wherever no bit is lost, by powers of all sizes. */
static void scaling_is_libms(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 1);
    size_t up = 0, down = 0;
    for (uint32_t i = 0; i < 400000; i++) {
        float x = float_from_bits((uint32_t)rng_u64(&rng) & (i % 2 ? UINT32_MAX : 0xFFF00000u));
        int by = (int)rng_below(&rng, 601) - 300;
        float wanted = ldexpf(x, by);
        if (!float_is_finite(wanted) || (double)wanted != ldexp((double)x, by))
            continue;
        if (float_bits(shrink_scaled(x, by)) != float_bits(wanted))
            fail_msg("%a by 2^%d: %a", (double)x, by, (double)shrink_scaled(x, by));
        up += by > 127 && x != 0;
        down += by < -126 && x != 0;
    }
    assert_true(up > 1000 && down > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(placed_triangles_have_a_border),
        cmocka_unit_test(counts_have_a_border),
        cmocka_unit_test(each_count_has_its_own_border),
        cmocka_unit_test(places_are_the_sum_of_the_instances),
        cmocka_unit_test(exponents_are_libms),
        cmocka_unit_test(scaling_is_libms),
    };
    return cmocka_run_group_tests_name("trial_borders", tests, NULL, NULL);
}

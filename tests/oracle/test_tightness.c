/* Tightness: a pair that arithmetic on paper gives, the smallest rejected error against a walk over
 * all floats, and sums of few values. */
#include "bench/measure/tightness.h"
#include "scenes/scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

struct tightness_stand {
    struct scene scene;
    struct oracle *oracle;
    struct judge *judge;
    struct model model;
};

/* A right triangle of legs 1 in the plane z = depth, its corner at x = y = side. */
static void stand_make(struct tightness_stand *s, enum twin_formula judged, float side, float depth)
{
    *s = (struct tightness_stand){.model = {.formula = judged, .rounding = ROUNDING_IEEE}};
    struct reason reason = {""};
    assert_int_equal(scene_make(3, 1, &s->scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++) {
        s->scene.index[c] = c;
        s->scene.vertex[3 * c] = side + (c == 1 ? 1 : 0);
        s->scene.vertex[3 * c + 1] = side + (c == 2 ? 1 : 0);
        s->scene.vertex[3 * c + 2] = depth;
    }
    assert_int_equal(oracle_make(&s->scene, &s->oracle, &reason), STATUS_OK);
    assert_int_equal(judge_make(s->oracle, &s->model, QUERY_ANY, &s->judge, &reason), STATUS_OK);
}

static void stand_free(struct tightness_stand *s)
{
    judge_free(s->judge);
    oracle_free(s->oracle);
    scene_free(&s->scene);
}

static bool wrong(const struct tightness_stand *s, const struct ray *ray, float t)
{
    const struct oracle_answer nothing = {.prim = ABI_NO_PRIM};
    const struct hit answer = {t, 0.25f, 0.25f, 0};
    struct judgement judgement;
    assert_int_equal(judge_answer(s->judge, ray, &nothing, &answer, &judgement), STATUS_OK);
    if (judgement.verdict == VERDICT_WRONG)
        assert_int_equal(judgement.wrong, WRONG_DISTANCE);
    return judgement.verdict == VERDICT_WRONG;
}

/* t = 1 / 3, between 11184810 and 11184811 steps of 2^-25, nearer to the latter by a third. */
static void a_third_is_off_by_a_third(void **state)
{
    (void)state;
    static const enum twin_formula formulas[] = {
        TWIN_MT,        TWIN_WOOP,   TWIN_PLUECKER,     TWIN_BALDWIN_WEBBER,
        TWIN_TRI_ACCEL, TWIN_EMBREE, TWIN_EMBREE_ROBUST};
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
        struct tightness_stand s;
        stand_make(&s, formulas[f], 0, 1);
        struct tightness_pair pair = {{{0.25f, 0.25f, 0}, 0, {0, 0, 3}, 1e30f}, 0, 1.0 / 3};
        struct tightness_one one = tightness_measure(s.judge, &s.scene, &s.model, &pair);
        assert_float_equal(one.real, 1.0 / 3, 1e-6);
        assert_false(one.alarm);
        int above = 1, below = 0;
        while (!wrong(&s, &pair.ray, (float)(11184810 + above) * 0x1p-25f))
            above++;
        while (!wrong(&s, &pair.ray, (float)(11184810 - below) * 0x1p-25f))
            below++;
        double least = fmin(above - 2.0 / 3, below + 2.0 / 3);
        assert_float_equal(one.rejected, least, 1e-6);
        assert_true(one.rejected > 1 && one.rejected < 40);
        stand_free(&s);
    }
}

/* What baldwin_webber computes a thousand away is nothing that mt may. */
static void what_another_formula_computes_is_an_alarm(void **state)
{
    (void)state;
    struct tightness_stand s;
    stand_make(&s, TWIN_MT, 1000.3f, 1000.7f);
    struct tightness_pair pair = {
        {{1000.5f, 1000.6f, 999.9f}, 0, {0.07f, -0.03f, 1.1f}, 1e30f}, 0, 0};
    struct oracle_pair exact;
    oracle_pair(s.oracle, &pair.ray, 0, &exact);
    assert_int_equal(exact.class, ORACLE_INSIDE);
    pair.t = exact.t_lo;
    const struct model other = {.formula = TWIN_BALDWIN_WEBBER, .rounding = ROUNDING_IEEE};
    assert_true(tightness_measure(s.judge, &s.scene, &other, &pair).alarm);
    assert_false(tightness_measure(s.judge, &s.scene, &s.model, &pair).alarm);
    stand_free(&s);
}

static void few_are_summed_by_hand(void **state)
{
    (void)state;
    struct tightness_one one[] = {
        {1, 40, false}, {2, 10, false}, {3, (double)INFINITY, true}, {4, 20, false}};
    struct tightness sum;
    struct reason reason = {""};
    assert_int_equal(tightness_sum(one, 4, &sum, &reason), STATUS_OK);
    assert_int_equal(sum.count, 4);
    assert_int_equal(sum.alarms, 1);
    assert_int_equal(sum.unbounded, 1);
    assert_float_equal(sum.real_p50, 2, 0);
    assert_float_equal(sum.real_p999, 4, 0);
    assert_float_equal(sum.real_most, 4, 0);
    assert_float_equal(sum.rejected_p50, 20, 0);
    assert_float_equal(sum.medians, 10, 0);
    assert_float_equal(sum.times, 5, 0);
    assert_float_equal(sum.group_p50, 5, 0); /* 10, 20 and 40 with 2, 4 and 1 */
    assert_float_equal(sum.group_most, 5, 0);
}

/* Three groups: errors 1, 2 and 5 with bounds of 10 to 10.999, 100 to 100.999, 1000 to 1001.499. */
static void groups_are_of_like_bounds(void **state)
{
    (void)state;
    static const double real[] = {1, 2, 5}, rejected[] = {10, 100, 1000};
    struct tightness_one *one = calloc(3500, sizeof *one);
    struct tightness sum;
    struct reason reason = {""};
    assert_non_null(one);
    for (size_t i = 0; i < 3500; i++) {
        size_t group = i % 7 < 2 ? 0 : i % 7 < 4 ? 1 : 2; /* 1000, 1000 and 1500, mixed */
        size_t place = i / 7 * (group < 2 ? 2 : 3) + (i % 7 - 2 * group);
        one[i] = (struct tightness_one){real[group], rejected[group] + 1e-3 * (double)place, false};
    }
    assert_int_equal(tightness_sum(one, 3500, &sum, &reason), STATUS_OK);
    assert_float_equal(sum.group_p50, 100.499 / 2, 1e-9);
    assert_float_equal(sum.group_most, 1000.749 / 5, 1e-9);
    assert_float_equal(sum.real_p50, 2, 0);
    assert_float_equal(sum.times, 100.749 / 5, 1e-9);
    free(one);
}

/* Of triangles of a mesh, for every formula and rounding: real errors are those of one evaluation,
 * every operation to nearest, so that Vulkan's looser roundings leave more room. */
static void no_bound_is_twenty_times_too_wide(void **state)
{
    (void)state;
    static const enum twin_formula formulas[] = {
        TWIN_MT,     TWIN_MT_RTRS,        TWIN_WOOP,          TWIN_PLUECKER,
        TWIN_EMBREE, TWIN_BALDWIN_WEBBER, TWIN_EMBREE_ROBUST, TWIN_TRI_ACCEL};
    static const struct rounding roundings[] = {ROUNDING_IEEE, ROUNDING_FLUSHED, ROUNDING_EMBREE,
                                                ROUNDING_VULKAN_RTE, ROUNDING_VULKAN};
    enum { PAIRS = 2000 };
    static struct tightness_pair pair[PAIRS];
    static struct tightness_one one[PAIRS];
    struct tightness_stand s = {.oracle = NULL};
    struct reason reason = {""};
    struct rng rng = rng_make(5, 0);
    assert_int_equal(scene_open("sphere:n=35", 1, &s.scene, &reason), STATUS_OK);
    assert_int_equal(oracle_make(&s.scene, &s.oracle, &reason), STATUS_OK);
    struct box bounds = scene_bounds(&s.scene);
    for (size_t i = 0; i < PAIRS; i++)
        while (!tightness_draw(s.oracle, &s.scene, &bounds, &rng, &pair[i]))
            continue;
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
        for (size_t r = 0; r < ARRAY_COUNT(roundings); r++) {
            struct tightness sum;
            s.model = (struct model){.formula = formulas[f], .rounding = roundings[r]};
            assert_int_equal(judge_make(s.oracle, &s.model, QUERY_ANY, &s.judge, &reason),
                             STATUS_OK);
            for (size_t i = 0; i < PAIRS; i++)
                one[i] = tightness_measure(s.judge, &s.scene, &s.model, &pair[i]);
            judge_free(s.judge);
            assert_int_equal(tightness_sum(one, PAIRS, &sum, &reason), STATUS_OK);
            assert_int_equal(sum.alarms, 0);
            assert_true(sum.unbounded <= 2);
            assert_true(sum.times < 20 && sum.group_most < 20);
            assert_true(r > 1 || sum.medians < 20);
        }
    oracle_free(s.oracle);
    scene_free(&s.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_third_is_off_by_a_third),
        cmocka_unit_test(what_another_formula_computes_is_an_alarm),
        cmocka_unit_test(few_are_summed_by_hand),
        cmocka_unit_test(groups_are_of_like_bounds),
        cmocka_unit_test(no_bound_is_twenty_times_too_wide),
    };
    return cmocka_run_group_tests_name("tightness", tests, NULL, NULL) ? 1 : 0;
}

/* Laws of ref/match/match.h about answers: wrong ones are found, and told apart. The engine here is
 * made up: it answers what the test tells it. */
#include "ref/match/match.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/made_up.h"

#include <string.h>

/* --- wrong answers --------------------------------------------------------------------------- */

/* The first ray that misses, and not closely. */
static size_t a_miss(const struct match *match)
{
    for (size_t i = 0;; i++) {
        bool close = match->truth[i].prim != ABI_NO_PRIM || !ray_in_contract(&match->ray[i]);
        for (uint32_t prim = 0; prim < match->scene->tri_count && !close; prim++) {
            float v[3][3];
            scene_tri(match->scene, prim, v);
            close = twin_eval(TWIN_MT, ROUNDING_IEEE, &match->ray[i], v).possible;
        }
        if (!close)
            return i;
    }
}

/* The first ray whose hit no engine may lose. */
static size_t a_hit(const struct match *match)
{
    for (size_t i = 0;; i++) {
        float v[3][3];
        if (match->truth[i].prim == ABI_NO_PRIM || !ray_in_contract(&match->ray[i]))
            continue;
        scene_tri(match->scene, match->truth[i].prim, v);
        if (twin_eval(TWIN_MT, ROUNDING_IEEE, &match->ray[i], v).certain)
            return i;
    }
}

static void one_bit_of_t(const struct match *match, struct hit *hit)
{
    struct hit *one = &hit[a_hit(match)];
    one->t = float_from_bits(float_bits(one->t) ^ 1);
}

static void one_bit_of_v(const struct match *match, struct hit *hit)
{
    struct hit *one = &hit[a_hit(match)];
    one->v = float_from_bits(float_bits(one->v) ^ 1);
}

static void far_too_far(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)].t *= 1.001f;
}

static void off_in_u(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)].u += 0.01f;
}

static void not_a_number(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)].v = float_from_bits(0x7FC00000u);
}

static void another_triangle(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)].prim ^= 1;
}

static void no_triangle(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)].prim = match->scene->tri_count;
}

static void a_lost_hit(const struct match *match, struct hit *hit)
{
    hit[a_hit(match)] = (struct hit){.prim = ABI_NO_PRIM};
}

static void a_phantom(const struct match *match, struct hit *hit)
{
    hit[a_miss(match)] = (struct hit){3, 0.25f, 0.25f, 1};
}

static void a_miss_spelt_otherwise(const struct match *match, struct hit *hit)
{
    hit[a_miss(match)].t = 1;
}

static void moods(const struct match *match, struct hit *hit)
{
    (void)match;
    if (script.traced % 2)
        hit[5].t = 7;
}

static void a_single_wrong_answer_is_found(void **state)
{
    (void)state;
    static const struct {
        void (*spoil)(const struct match *, struct hit *);
        enum wrong wrong; /* WRONG_NOT: within the bounds, so only bits can tell */
    } lies[] = {{one_bit_of_t, WRONG_NOT},        {one_bit_of_v, WRONG_NOT},
                {far_too_far, WRONG_DISTANCE},    {off_in_u, WRONG_BARYCENTRIC},
                {not_a_number, WRONG_NOT_FINITE}, {another_triangle, WRONG_TRIANGLE},
                {no_triangle, WRONG_PHANTOM},     {a_lost_hit, WRONG_MISSED},
                {a_phantom, WRONG_PHANTOM},       {a_miss_spelt_otherwise, WRONG_NOT}};
    static struct engine inexact;
    struct fixture *f = begin();
    inexact = made_up;
    inexact.model = cpu_rays_model;
    for (size_t i = 0; i < ARRAY_COUNT(lies); i++) {
        size_t wrong = lies[i].wrong != WRONG_NOT;
        script.spoil = lies[i].spoil;
        match_run(&f->match, &made_up, &f->row);
        assert_int_equal(f->row.bit_differences, 1);
        assert_int_equal(f->row.count[VERDICT_WRONG], wrong);
        assert_int_equal(f->row.differences, 1 + wrong);
        assert_int_equal(f->row.finding_count, 1 + wrong);
        assert_differs(f, true);
        match_run(&f->match, &inexact, &f->row); /* is judged by the truth alone */
        assert_int_equal(f->row.differences, wrong);
        assert_int_equal(f->row.wrong[lies[i].wrong], wrong ? 1 : RAYS);
        if (wrong)
            assert_differs(f, false);
    }
    done(f);
}

static void an_answer_that_changes_is_wrong(void **state)
{
    (void)state;
    struct fixture *f = begin();
    script.spoil = moods;
    for (unsigned repeats = 1; repeats <= 3; repeats++) {
        f->match.options.repeats = repeats;
        script.traced = 0;
        match_run(&f->match, &made_up, &f->row);
        assert_int_equal(script.traced, repeats > 1 ? repeats : 2);
        assert_int_equal(f->row.wrong[WRONG_NOT_REPEATABLE], 1);
        assert_int_equal(f->row.count[VERDICT_WRONG], 1);
        assert_differs(f, true);
    }
    f->ray[5].dir[0] = f->ray[5].dir[1] = f->ray[5].dir[2] = 0; /* even out of contract */
    match_run(&f->match, &made_up, &f->row);
    assert_int_equal(f->row.wrong[WRONG_NOT_REPEATABLE], 1);
    done(f);
}

/* Any-hits are right only if they say hit where the same engine's closest hits do. */
static void an_any_hit_that_contradicts_the_closest_hit_is_wrong(void **state)
{
    (void)state;
    static struct engine inexact, other;
    struct fixture *f = begin();
    inexact = made_up;
    inexact.model = cpu_rays_model;
    /* A ray on the rim of triangle 7: a boundary, so either answer could be excused. */
    const float *v = f->scene.vertex + 63;
    for (int k = 0; k < 3; k++) {
        f->ray[9].dir[k] = k == 2 ? 1 : 0.25f;
        f->ray[9].org[k] = 0.5f * v[k] + 0.5f * v[3 + k] - 4 * f->ray[9].dir[k];
    }
    f->ray[9].tmin = 0;
    f->ray[9].tmax = 1e30f;
    assert_int_equal(oracle_closest(f->match.oracle, ORACLE_BRUTE, ORACLE_CLOSED, f->ray, RAYS, 1,
                                    f->match.truth, NULL, &f->reason),
                     STATUS_OK);
    for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        match_set(&f->match, box_tests[0], (enum query)query);
        match_run(&f->match, &inexact, &f->row);
        assert_int_equal(f->row.differences, 0);
    }
    f->match.closest.hit[9].prim = f->match.answer[9].prim == ABI_NO_PRIM ? 7 : ABI_NO_PRIM;
    match_run(&f->match, &inexact, &f->row);
    assert_int_equal(f->row.wrong[WRONG_ANY_DISAGREES], 1);
    assert_int_equal(f->row.differences, 1);
    assert_int_equal(f->row.finding[0].ray_index, 9);
    pack(f, "f32"); /* forgets the closest hits */
    match_run(&f->match, &inexact, &f->row);
    assert_int_equal(f->row.differences, 0);
    /* By another box test it contradicts nothing, unless the engine has its own; nor does another
     * engine. */
    for (int packed = 0; packed < 2; packed++) {
        other = inexact;
        inexact.needs_packed = packed;
        for (size_t box = 0; box < 4; box++) { /* the third and fourth: by another engine */
            match_set(&f->match, box_tests[0], QUERY_CLOSEST);
            match_run(&f->match, &inexact, &f->row);
            f->match.closest.hit[9].prim = f->match.answer[9].prim == ABI_NO_PRIM ? 7 : ABI_NO_PRIM;
            match_set(&f->match, box_tests[box % 2], QUERY_ANY);
            match_run(&f->match, box < 2 ? &inexact : &other, &f->row);
            assert_int_equal(f->row.wrong[WRONG_ANY_DISAGREES], box == 0 || (box == 1 && !packed));
        }
    }
    done(f);
}

static void all_lost(const struct match *match, struct hit *hit)
{
    for (size_t i = 0; i < match->ray_count; i++)
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
}

static void findings_are_few_and_all_are_counted(void **state)
{
    (void)state;
    struct fixture *f = begin();
    run(f, "brute");
    size_t hits = f->row.hits;
    script.spoil = all_lost;
    match_run(&f->match, &made_up, &f->row);
    size_t bits = 0;
    for (size_t i = 0; i < f->row.finding_count; i++)
        bits += f->row.finding[i].bits;
    assert_int_equal(bits, FINDING_MOST); /* they leave room for what is WRONG */
    assert_int_equal(f->row.finding_count, 2 * FINDING_MOST);
    assert_true(f->row.count[VERDICT_WRONG] > hits / 2);
    assert_true(f->row.bit_differences > hits * 9 / 10);
    assert_true(f->row.bit_differences <= hits); /* but rays out of contract */
    assert_true(row_failed(&f->row));
    done(f);
}

static struct model no_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){.formula = TWIN_UNKNOWN};
}

static void an_unknown_formula_is_judged_by_displacements(void **state)
{
    (void)state;
    static struct engine secret;
    struct fixture *f = begin();
    secret = made_up;
    secret.model = no_model;
    match_run(&f->match, &secret, &f->row);
    assert_agrees(f);
    assert_true(f->row.displacement.count >= f->row.hits * 9 / 10);
    assert_true(f->row.displacement.count <= f->row.hits + f->row.count[VERDICT_BOUNDARY]);
    assert_true(f->row.displacement.p50 > 0);
    assert_true(f->row.displacement.p50 < f->row.displacement.p99);
    assert_true(f->row.displacement.p99 <= f->row.displacement.most);
    assert_true(f->row.displacement.most < 300); /* slivers: mt is not backward stable */
    assert_true(f->row.worst_over == 0);
    script.spoil = a_lost_hit;
    match_run(&f->match, &secret, &f->row);
    assert_int_equal(f->row.wrong[WRONG_MISSED], 1);
    assert_true(f->row.displacement.most > JUDGE_DISPLACEMENT_MOST);
    assert_differs(f, false);
    done(f);
}

/* Bits are compared even where a faithful member keeps a row from being judged. */
static void an_exact_engine_must_have_the_seeds_faults_bit_for_bit(void **state)
{
    (void)state;
    struct fixture *f = begin();
    pack(f, "rtrs_rf");
    match_set(&f->match, box_test_find("rtrs"), QUERY_CLOSEST);
    match_run(&f->match, &made_up, &f->row);
    assert_int_equal(f->row.status, ROW_OK);
    assert_int_equal(f->row.differences, 0);
    script.spoil = one_bit_of_v;
    match_run(&f->match, &made_up, &f->row);
    assert_false(f->row.judged);
    assert_int_equal(f->row.differences, 1);
    assert_true(f->row.finding[0].bits && row_failed(&f->row));
    done(f);
}

/* --- too few hits ---------------------------------------------------------------------------- */

/* All rays miss but `most` of the first `traced`, which are those of brute force: their last. */
static struct fixture *begin_misses(size_t traced, size_t most)
{
    struct fixture *f = prepare("soup:n=500", "median", 4);
    struct hit hit = {.prim = ABI_NO_PRIM};
    struct ray meets = f->ray[0];
    for (size_t i = 0; i < RAYS && hit.prim == ABI_NO_PRIM; i++) {
        meets = f->ray[i];
        trace_brute(&f->scene, tri_tests[0], QUERY_CLOSEST, &meets, &hit);
    }
    for (size_t i = 0; i < RAYS; i++)
        f->ray[i] = i < traced && i + most >= traced
                        ? meets
                        : (struct ray){{100, 100, 100}, 0, {1, 0.5f, 0.25f}, 1e30f};
    f->options.brute_budget = 500 * traced;
    start(f);
    pack(f, "f32");
    return f;
}

/* Of the rays that the row traced, which are fewer where brute force was given less work. */
static void one_hit_in_a_thousand_rays_is_enough(void **state)
{
    (void)state;
    static const size_t traced[] = {1, 999, 1000, 1999, 2000, RAYS};
    for (size_t k = 0; k < ARRAY_COUNT(traced); k++)
        for (size_t most = 0; most <= 3 && most <= traced[k]; most++) {
            struct fixture *f = begin_misses(traced[k], most);
            for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++)
                for (int brute = 0; brute < 2; brute++) {
                    const size_t rays = brute ? traced[k] : RAYS;
                    const bool enough = most > 0 && most >= rays / 1000;
                    match_set(&f->match, box_tests[0], (enum query)query);
                    run(f, brute ? "brute" : "cpu");
                    assert_int_equal(f->row.rays, rays);
                    assert_int_equal(f->row.hits, most);
                    assert_int_equal(f->row.status, enough ? ROW_OK : ROW_VACUOUS);
                }
            done(f);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_single_wrong_answer_is_found),
        cmocka_unit_test(an_answer_that_changes_is_wrong),
        cmocka_unit_test(an_any_hit_that_contradicts_the_closest_hit_is_wrong),
        cmocka_unit_test(an_unknown_formula_is_judged_by_displacements),
        cmocka_unit_test(findings_are_few_and_all_are_counted),
        cmocka_unit_test(an_exact_engine_must_have_the_seeds_faults_bit_for_bit),
        cmocka_unit_test(one_hit_in_a_thousand_rays_is_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The judge: right answers are right, and wrong answers of every kind are caught, for every
 * formula. The allowed classes: test_judge_classes.c. */
#include "ref/judge/judge.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>
#include <stdio.h>

/* --- right ----------------------------------------------------------------------------------- */

static void the_nearest_triangle_and_a_true_miss_are_right(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            judge_fixture_seat(c, &subjects[s], (enum query)query);
            judge_fixture_ask(c, along_z(0.5f, -0.25f));
            must_be(c, right_answer(c, 0), VERDICT_RIGHT);
            assert_int_equal(c->judgement.expected, 0);
            assert_true(c->judgement.t_lo <= 1.0 && c->judgement.t_hi >= 1.0);
            judge_fixture_ask(c, along_z(5, 5));
            must_be(c, a_miss(), VERDICT_RIGHT);
            assert_int_equal(c->judgement.expected, ABI_NO_PRIM);
        }
    judge_fixture_close(c);
}

static void any_triangle_in_range_is_right_for_any_hit(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ANY);
        must_be(c, right_answer(c, 2), VERDICT_RIGHT);
        if (subjects[s].model.any_unnamed)
            must_be(c, (struct hit){.prim = 0}, VERDICT_RIGHT); /* all that Embree says */
        else
            must_be_wrong(c, (struct hit){.t = 0, .prim = 0}, WRONG_DISTANCE);
    }
    judge_fixture_close(c);
}

/* --- wrong ----------------------------------------------------------------------------------- */

static void a_lost_hit_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            judge_fixture_seat(c, &subjects[s], (enum query)query);
            must_be_wrong(c, a_miss(), WRONG_MISSED);
            assert_int_equal(c->judgement.expected, 0);
            if (query == QUERY_CLOSEST)
                must_be_wrong(c, right_answer(c, 2), WRONG_MISSED);
        }
    judge_fixture_close(c);
}

static void a_triangle_that_is_not_hit_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            if (query == QUERY_ANY && subjects[s].model.any_unnamed)
                continue;
            judge_fixture_seat(c, &subjects[s], (enum query)query);
            judge_fixture_ask(c, along_z(0.5f, -0.25f));
            must_be_wrong(c, right_answer(c, 1), WRONG_TRIANGLE); /* the other half of the quad */
            must_be_wrong(c, (struct hit){1, 0.25f, 0.25f, 3}, WRONG_TRIANGLE);
            must_be_wrong(c, (struct hit){1, 0.25f, 0.25f, 77}, WRONG_PHANTOM);
            judge_fixture_ask(c, along_z(5, 5));
            must_be_wrong(c, (struct hit){1, 0.25f, 0.25f, 1}, WRONG_PHANTOM);
        }
    judge_fixture_close(c);
}

static void an_unnamed_phantom_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++)
        if (subjects[s].model.any_unnamed) {
            judge_fixture_seat(c, &subjects[s], QUERY_ANY);
            judge_fixture_ask(c, along_z(5, 5));
            must_be_wrong(c, (struct hit){.prim = 0}, WRONG_PHANTOM);
            judge_fixture_ask(c, along_z(nextafterf(1, 2), 0.25f));
            must_be(c, (struct hit){.prim = 0}, VERDICT_BOUNDARY);
        }
    judge_fixture_close(c);
}

static void a_wrong_distance_is_wrong(void **state)
{
    (void)state;
    static const float factors[] = {0.5f, 0.999f, 1.001f, 2.0f, 1e9f};
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        for (size_t i = 0; i < ARRAY_COUNT(factors); i++) {
            struct hit hit = right_answer(c, 0);
            hit.t *= factors[i];
            must_be_wrong(c, hit, WRONG_DISTANCE);
        }
        struct hit hit = right_answer(c, 0);
        hit.t = nextafterf(hit.t, 2);
        must_be(c, hit, VERDICT_RIGHT);
        hit.t *= 1.00001f; /* 170 u: beyond every formula's bound here */
        must_be_wrong(c, hit, WRONG_DISTANCE);
    }
    judge_fixture_close(c);
}

static void wrong_barycentrics_are_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_ask(c, along_z(0.75f, -0.5f));
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        struct hit right = right_answer(c, 0), off = right,
                   swapped = {right.t, right.v, right.u, 0};
        off.u += 0.001f;
        must_be_wrong(c, off, WRONG_BARYCENTRIC);
        off = right;
        off.v -= 0.001f;
        must_be_wrong(c, off, WRONG_BARYCENTRIC);
        must_be_wrong(c, swapped, WRONG_BARYCENTRIC);
        off = right;
        off.u = nextafterf(off.u, 1);
        must_be(c, off, VERDICT_RIGHT);
    }
    judge_fixture_close(c);
}

static void what_is_not_finite_is_wrong(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++)
        for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
            for (int field = 0; field < 3; field++) {
                judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
                struct hit hit = right_answer(c, 0);
                *(field == 0 ? &hit.t : field == 1 ? &hit.u : &hit.v) = bad[i];
                must_be_wrong(c, hit, WRONG_NOT_FINITE);
            }
    judge_fixture_close(c);
}

/* --- the rest of the interface --------------------------------------------------------------- */

static void any_and_closest_must_agree(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_ask(c, along_z(1, 0.25f)); /* on the rim */
    struct hit miss = a_miss(), hit = right_answer(c, 0);
    for (size_t s = 0; s < SUBJECTS; s++) {
        struct judgement closest, any;
        bool own = twin_is_own(subjects[s].model.formula);
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        must_be(c, hit, VERDICT_RIGHT);
        closest = c->judgement;
        judge_fixture_seat(c, &subjects[s], QUERY_ANY);
        must_be(c, miss, VERDICT_BOUNDARY);
        any = c->judgement;
        judge_any_against_closest(c->judge, &c->ray, &hit, &closest, &hit, &any);
        assert_int_equal(any.wrong, WRONG_NOT); /* they agree */
        judge_any_against_closest(c->judge, &c->ray, &hit, &closest, &miss, &any);
        assert_int_equal(any.wrong, own ? WRONG_ANY_DISAGREES : WRONG_NOT);
        any = c->judgement;
        any.verdict = VERDICT_RIGHT;
        judge_any_against_closest(c->judge, &c->ray, &hit, &closest, &miss, &any);
        assert_int_equal(any.wrong, WRONG_ANY_DISAGREES);
        assert_int_equal(any.verdict, VERDICT_WRONG);
        any = c->judgement;
        struct ray still = {{0, 0, 0}, 0, {0, 0, 0}, 1};
        judge_any_against_closest(c->judge, &still, &hit, &closest, &miss, &any);
        assert_int_equal(any.wrong, WRONG_NOT); /* out of contract */
    }
    judge_fixture_close(c);
}

static void bits_are_compared_as_bits(void **state)
{
    (void)state;
    struct ray ray = along_z(0.5f, -0.25f), still = {{0, 0, 0}, 0, {0, 0, 0}, 1};
    struct hit a = {1, 0, 0.5f, 3}, b = a;
    assert_int_equal(judge_bits(&ray, &a, &b), VERDICT_RIGHT);
    b.u = -0.0f;
    assert_int_equal(judge_bits(&ray, &a, &b), VERDICT_WRONG);
    assert_int_equal(judge_bits(&still, &a, &b), VERDICT_OUT_OF_CONTRACT);
    char line[300];
    judge_bits_line(&ray, &a, &b, line, sizeof line);
    assert_non_null(strstr(line, "d=(0x0p+0,0x0p+0,0x1p+0) t=[0x0p+0,"));
    assert_non_null(strstr(line, "=> prim=3 t=0x1p+0 u=-0x0p+0 v=0x1p-1  expected: prim=3 t=0x1p+0 "
                                 "u=0x0p+0 v=0x1p-1"));
}

static void names_and_lines(void **state)
{
    (void)state;
    for (int v = 0; v < VERDICT_COUNT; v++)
        for (int other = 0; other < v; other++)
            assert_string_not_equal(verdict_name((enum verdict)v),
                                    verdict_name((enum verdict)other));
    for (int w = 0; w < WRONG_COUNT; w++)
        for (int other = 0; other < w; other++)
            assert_string_not_equal(wrong_name((enum wrong)w), wrong_name((enum wrong)other));
    assert_string_equal(verdict_name(VERDICT_COUNT), "unknown");
    assert_string_equal(wrong_name(WRONG_COUNT), "unknown");
    struct ray ray = along_z(0.5f, -0.25f);
    struct judgement judgement = {.expected = 7, .t_lo = 1.5, .over = 2.5};
    struct hit hit = {1, 0, 0.5f, 3};
    char line[300];
    judge_line(&ray, &judgement, &hit, line, sizeof line);
    assert_non_null(strstr(line, "expected: prim=7 t=1.5 err/E=2.5"));
    judgement = (struct judgement){
        .expected = 7, .t_lo = 0x1.fffffffffp-3, .t_hi = 0x1.0000000004p-2, .displacement = 3};
    judge_set_lost(&judgement, 7, judgement.t_lo, judgement.t_hi);
    judge_line(&ray, &judgement, &hit, line, sizeof line);
    assert_non_null(strstr(line, "expected: prim=7 t=0.25 displacement=3 uM"));
    judge_set_lost(&judgement, 8, 3, 3);
    judge_line(&ray, &judgement, &hit, line, sizeof line);
    assert_non_null(strstr(line, "expected: prim=7 t=0.25, lost: prim=8 t=3 displacement=3 uM"));
    judgement = (struct judgement){.expected = ABI_NO_PRIM, .displacement = 3};
    judge_line(&ray, &judgement, &hit, line, sizeof line);
    assert_non_null(strstr(line, "expected: miss displacement=3 uM"));
}

/* What a line ends with; numbers of 0 are none. */
static void ends_with(const struct judgement *judgement, const char *end)
{
    char line[400];
    const struct ray ray = along_z(0.5f, -0.25f);
    const struct hit miss = a_miss();
    judge_line(&ray, judgement, &miss, line, sizeof line);
    assert_string_equal(strstr(line, "=> ") + 3, end);
}

static void a_line_has_what_there_is(void **state)
{
    (void)state;
    struct judgement judgement = {.expected = ABI_NO_PRIM};
    ends_with(&judgement, "miss  expected: miss");
    judgement.displacement = 0.25;
    ends_with(&judgement, "miss  expected: miss displacement=0.25 uM");
    judgement.over = 0.5;
    ends_with(&judgement, "miss  expected: miss err/E=0.5");
    judgement = (struct judgement){.expected = 7, .t_lo = 2.9999, .t_hi = 3.0001};
    ends_with(&judgement, "miss  expected: prim=7 t=3");
    judge_set_lost(&judgement, 8, 4.9999, 5.0001);
    ends_with(&judgement, "miss  expected: prim=7 t=3, lost: prim=8 t=5");
}

/* The longest numbers are printed to their ends. */
static void the_longest_line_is_whole(void **state)
{
    (void)state;
    const double least = -0x1.fffffffffffffp+1023, tiny = -0x1.fffffffffffffp-1022;
    const float far = -0x1.fffffep+127f, fine = -0x1.fffffep-126f;
    struct hit hit = {far, fine, far, 0xFFFFFFFEu};
    struct ray ray = {{far, fine, far}, fine, {fine, far, fine}, far};
    struct judgement judgement = {.expected = 0xFFFFFFFDu, .displacement = 1.79e308};
    judgement.t_lo = judgement.t_hi = least;
    judge_set_lost(&judgement, 0xFFFFFFFCu, tiny, tiny);
    char line[600], whole[600], hits[200];
    snprintf(hits, sizeof hits, "prim=4294967294 t=%a u=%a v=%a", (double)far, (double)fine,
             (double)far);
    judge_line(&ray, &judgement, &hit, line, sizeof line);
    snprintf(whole, sizeof whole,
             "o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a] => %s  expected: prim=4294967293 t=%.17g, "
             "lost: prim=4294967292 t=%.17g displacement=1.79e+308 uM",
             (double)far, (double)fine, (double)far, (double)fine, (double)far, (double)fine,
             (double)fine, (double)far, hits, least, tiny);
    assert_string_equal(line, whole);
    judge_bits_line(&ray, &hit, &hit, line, sizeof line);
    assert_string_equal(strstr(line, "expected: ") + 10, hits);
    assert_non_null(strstr(line, "=> prim=4294967294"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_triangle_and_a_true_miss_are_right),
        cmocka_unit_test(any_triangle_in_range_is_right_for_any_hit),
        cmocka_unit_test(a_lost_hit_is_wrong),
        cmocka_unit_test(a_triangle_that_is_not_hit_is_wrong),
        cmocka_unit_test(an_unnamed_phantom_is_wrong),
        cmocka_unit_test(a_wrong_distance_is_wrong),
        cmocka_unit_test(wrong_barycentrics_are_wrong),
        cmocka_unit_test(what_is_not_finite_is_wrong),
        cmocka_unit_test(any_and_closest_must_agree),
        cmocka_unit_test(bits_are_compared_as_bits),
        cmocka_unit_test(names_and_lines),
        cmocka_unit_test(a_line_has_what_there_is),
        cmocka_unit_test(the_longest_line_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

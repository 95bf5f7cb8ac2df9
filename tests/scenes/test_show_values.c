/* Numbers of the pictures of a tree: errors, differences, sums, and their texts. */
#include "tests/scenes/show_fixture.h"

/* The error of each pixel is the judge's own. */
static void errors_are_the_judges(void **state)
{
    (void)state;
    static double error[PIXELS];
    static struct judgement judgement[PIXELS];
    static struct ray ray[PIXELS];
    static struct hit hit[PIXELS];
    struct trace_report report;
    struct reason reason;
    struct show_stand s;
    size_t some = 0;
    stand_make(&s, "terrain:k=4", "f32");
    struct show_source source = source_of(&s, "error");
    values_of(&source, PIXELS, error);
    for (uint32_t i = 0; i < PIXELS; i++) {
        struct shade_path path;
        shade_begin(&s.job, &s.view, i % WIDTH, i / WIDTH, &path);
        ray[i] = shade_ray(&s.job, &path);
    }
    assert_int_equal(engine_find("cpu")->trace(s.self, ray, PIXELS, hit, &report, &reason),
                     STATUS_OK);
    assert_int_equal(verdicts_make(s.oracle, s.judge, ray, hit, PIXELS, judgement, &reason),
                     STATUS_OK);
    for (size_t i = 0; i < PIXELS; i++) {
        const double expected = verdict_error(&judgement[i], &hit[i], false);
        assert_true(isnan(expected) ? isnan(error[i]) : error[i] == expected);
        some += expected > 0;
    }
    assert_true(some > 100);
    stand_free(&s);
}

static void an_unknown_formula_is_measured_by_its_displacement(void **state)
{
    (void)state;
    const struct hit hit = {.t = 1, .prim = 3}, miss = {.prim = ABI_NO_PRIM};
    const struct judgement judgement = {
        .verdict = VERDICT_RIGHT, .over = 0.25, .displacement = 3, .share = 0.5};
    struct judgement noise = judgement, outside = judgement;
    noise.verdict = VERDICT_NOISE;
    outside.verdict = VERDICT_OUT_OF_CONTRACT;
    assert_true(verdict_error(&judgement, &hit, false) == 0.25);
    assert_true(verdict_error(&judgement, &hit, true) == 0.5);
    assert_true(isnan(verdict_error(&judgement, &miss, false)));
    assert_true(isnan(verdict_error(&noise, &hit, false)));
    assert_true(isnan(verdict_error(&outside, &hit, true)));
}

static void differences_are_second_less_first(void **state)
{
    (void)state;
    const double a[] = {1, 5, NAN, 2, NAN}, b[] = {3, 4, 7, NAN, NAN};
    double out[5];
    size_t alone = 99;
    show_difference(show_find("boxes"), a, b, 5, out, &alone);
    assert_true(out[0] == 2.0 && out[1] == -1.0 && isnan(out[2]) && isnan(out[3]) && isnan(out[4]));
    assert_int_equal(alone, 2);
    const double same[] = {4, 4, NAN, 4, NAN}, names[] = {4, 5, 4, NAN, NAN};
    show_difference(show_find("prim"), same, names, 5, out, &alone);
    assert_true(out[0] == 0.0 && out[1] == 1.0 && out[2] == 1.0 && out[3] == 1.0 && isnan(out[4]));
    assert_int_equal(alone, 2);
    const double x[] = {1, 0, 0, 0, 1, 0, NAN, NAN, NAN}, y[] = {0, 1, 0, 0, 1, 0, 1, 0, 0};
    show_difference(show_find("normal"), x, y, 3, out, NULL);
    assert_true(fabs(out[0] - 90.0) < 1e-9 && out[1] == 0.0 && isnan(out[2]));
}

static void sums_leave_out_what_has_no_value(void **state)
{
    (void)state;
    const double value[] = {NAN, 4, -2, NAN, 7}, none[] = {NAN, NAN};
    struct show_sum sum = show_sum_of(value, 5);
    assert_int_equal(sum.pixels, 3);
    assert_true(sum.sum == 9.0 && sum.least == -2.0 && sum.most == 7.0 && sum.mean == 3.0);
    assert_int_equal(sum.most_at, 4);
    sum = show_sum_of(none, 2);
    assert_true(sum.pixels == 0 && sum.sum == 0.0 && sum.mean == 0.0);
}

/* Every order of the same values, with pixels that have none at every place. */
static void sums_do_not_depend_on_the_order(void **state)
{
    (void)state;
    const double of[4] = {-3, 0.5, 8, 8};
    for (size_t order = 0; order < 256; order++) {
        double value[9];
        size_t at[4] = {order & 3, order >> 2 & 3, order >> 4 & 3, order >> 6 & 3}, taken = 0;
        for (size_t i = 0; i < 4; i++)
            taken |= (size_t)1 << at[i];
        if (taken != 15)
            continue; /* no order */
        for (size_t i = 0; i < ARRAY_COUNT(value); i++)
            value[i] = i % 2 ? of[at[i / 2]] : (double)NAN;
        size_t most_at = 1;
        while (value[most_at] != 8)
            most_at += 2;
        for (size_t from = 0; from <= most_at; from++) {
            size_t left = 4 - from / 2;
            double sum = 0, least = INFINITY;
            for (size_t i = from; i < ARRAY_COUNT(value); i++) {
                sum += isnan(value[i]) ? 0 : value[i];
                least = isnan(value[i]) || least < value[i] ? least : value[i];
            }
            struct show_sum found = show_sum_of(value + from, ARRAY_COUNT(value) - from);
            assert_int_equal(found.pixels, left);
            assert_int_equal(found.most_at, most_at - from);
            assert_true(found.sum == sum && found.mean == sum / (double)left);
            assert_true(found.least == least && found.most == 8);
        }
    }
    const double one[] = {-5};
    struct show_sum found = show_sum_of(one, 1);
    assert_true(found.pixels == 1 && found.most_at == 0 && found.sum == -5 && found.mean == -5);
    assert_true(found.least == -5 && found.most == -5);
}

static void values_have_texts(void **state)
{
    (void)state;
    static const struct {
        const char *show;
        double value;
        const char *text;
    } known[] = {
        {"boxes", 12, "12"},     {"t", 0.5, "0.5"},           {"t", (double)NAN, "-"},
        {"class", 0, "right"},   {"class", 9, "wrong"},       {"prim", 123456789, "123456789"},
        {"error", 0.25, "0.25"}, {"class", (double)NAN, "-"}, {"inflation", 1, "1"},
    };
    char text[64];
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        show_text(show_find(known[i].show), known[i].value, text, sizeof text);
        assert_string_equal(text, known[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_the_judges),
        cmocka_unit_test(an_unknown_formula_is_measured_by_its_displacement),
        cmocka_unit_test(differences_are_second_less_first),
        cmocka_unit_test(sums_leave_out_what_has_no_value),
        cmocka_unit_test(sums_do_not_depend_on_the_order),
        cmocka_unit_test(values_have_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Ticks: round numbers within the range, as many as asked for, told apart by their texts. */
#include "scenes/picture/ticks.h"

#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static void expect_linear(double lo, double hi, size_t wanted, const char *texts)
{
    double tick[TICKS_MOST], step;
    char all[600] = "", text[40];
    size_t count = ticks_linear(lo, hi, wanted, tick, &step);
    for (size_t i = 0; i < count; i++) {
        tick_text(tick[i], step, text, sizeof text);
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? " " : "", text);
    }
    assert_string_equal(all, texts);
}

static void linear_ticks_are_round_numbers(void **state)
{
    (void)state;
    expect_linear(0, 1, 5, "0 0.2 0.4 0.6 0.8 1");
    expect_linear(-13, 47, 6, "-10 0 10 20 30 40");
    expect_linear(0, 199, 8, "0 20 40 60 80 100 120 140 160 180");
    expect_linear(-1e-9, 1e-9, 4, "-1e-9 -5e-10 0 5e-10 1e-9");
    expect_linear(150000, 350000, 4, "1.5e5 2e5 2.5e5 3e5 3.5e5");
    expect_linear(1000000.25, 1000000.75, 5,
                  "1.0000003e6 1.0000004e6 1.0000005e6 1.0000006e6 1.0000007e6");
}

static void ticks_are_within_any_range(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 0);
    for (int i = 0; i < 20000; i++) {
        double size = pow(10.0, rng_range(&rng, -290, 290)), step = 0.0;
        double lo = size * rng_range(&rng, -1, 1), hi = i % 7 ? size * rng_range(&rng, -1, 1) : lo;
        double tick[TICKS_MOST];
        if (lo > hi) {
            double swap = lo;
            lo = hi;
            hi = swap;
        }
        ticks_range(&lo, &hi);
        size_t wanted = 2 + rng_below(&rng, 9);
        size_t count = ticks_linear(lo, hi, wanted, tick, &step);
        assert_true(count >= 1 && count <= 2 * wanted + 2);
        char last[40] = "", text[40];
        for (size_t k = 0; k < count; k++) {
            assert_true(tick[k] >= lo - 1e-8 * (hi - lo) && tick[k] <= hi + 1e-8 * (hi - lo));
            tick_text(tick[k], step, text, sizeof text);
            if (strcmp(text, last) == 0)
                fail_msg("%.17g to %.17g: '%s' twice", lo, hi, text);
            strcpy(last, text);
        }
    }
}

static void ranges_have_a_width(void **state)
{
    (void)state;
    const double end[][2] = {{5, 5},
                             {0, 0},
                             {-3, -3},
                             {NAN, NAN},
                             {INFINITY, -INFINITY},
                             {1e308, 1e308},
                             {-1e308, 1e308},
                             {-INFINITY, INFINITY},
                             {5e-324, 5e-324},
                             {1, 1 + 1e-15},
                             {2, 1}};
    for (size_t i = 0; i < sizeof end / sizeof end[0]; i++) {
        double lo = end[i][0], hi = end[i][1], tick[TICKS_MOST], step;
        ticks_range(&lo, &hi);
        assert_true(isfinite(lo) && isfinite(hi) && hi > lo && isfinite(hi - lo));
        assert_true(ticks_linear(lo, hi, 6, tick, &step) >= 2);
    }
    double lo = 2, hi = 3;
    ticks_range(&lo, &hi);
    assert_true(lo == 2 && hi == 3);
}

static void logarithmic_ticks_thin_out(void **state)
{
    (void)state;
    double tick[TICKS_MOST];
    assert_int_equal(ticks_log(1, 10, tick), 4);
    assert_true(tick[0] == 1 && tick[1] == 2 && tick[2] == 5 && tick[3] == 10);
    assert_int_equal(ticks_log(0.5, 1e5, tick), 6); /* 1 to 100000 */
    assert_int_equal(ticks_log(1, 1e8, tick), 5);
    assert_in_range(ticks_log(1e-300, 1e300, tick), 10, TICKS_MOST);
}

static void numbers_are_short(void **state)
{
    (void)state;
    static const struct {
        double value, step;
        const char *text;
    } known[] = {{0, 0, "0"},
                 {-0.0, 1, "0"},
                 {0.5, 0, "0.5"},
                 {2000, 0, "2000"},
                 {-2000, 0, "-2000"},
                 {1e6, 0, "1e6"},
                 {1.5e6, 0, "1.5e6"},
                 {1e-4, 0, "1e-4"},
                 {0.001, 0, "0.001"},
                 {20000, 0, "20000"},
                 {0.30000000000000004, 0.1, "0.3"},
                 {1.2345678, 0, "1.234568"},
                 {100, 50, "100"},
                 {1234, 1000, "1234"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        char text[40];
        tick_text(known[i].value, known[i].step, text, sizeof text);
        assert_string_equal(text, known[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_ticks_are_round_numbers),
        cmocka_unit_test(ticks_are_within_any_range),
        cmocka_unit_test(ranges_have_a_width),
        cmocka_unit_test(logarithmic_ticks_thin_out),
        cmocka_unit_test(numbers_are_short),
    };
    return cmocka_run_group_tests_name("ticks", tests, NULL, NULL) ? 1 : 0;
}

/* Figures that are made of many errors: ranks, and rates of what was not met. */
#include "bench/measure/error_measure.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

/* Ranks from 1, in another order; a NAN is no value. */
static void quantiles_are_nearest_ranks(void **state)
{
    (void)state;
    static const size_t known[][3] = {{2, 1, 2}, {99, 50, 99}, {101, 51, 100}, {200, 100, 198}};
    double value[201];
    for (size_t k = 0; k < ARRAY_COUNT(known); k++) {
        size_t count = known[k][0];
        for (size_t i = 0; i < count; i++)
            value[i] = (double)(i * 13 % count + 1); /* 13 divides no count */
        value[count] = NAN;
        struct quantiles q = quantiles_of(value, count + 1);
        assert_true(q.count == count && (size_t)q.most == count);
        assert_true((size_t)q.p50 == known[k][1] && (size_t)q.p99 == known[k][2]);
    }
    struct quantiles q = quantiles_of((double[]){NAN, 7}, 2);
    assert_true(fabs(q.p50 + q.p99 + q.most - (21)) <= 0);
    q = quantiles_of(value, 0);
    assert_true(q.count == 0 && isnan(q.p50) && isnan(q.p99) && isnan(q.most));
}

static void rates_of_nothing_have_an_upper_limit(void **state)
{
    (void)state;
    static const struct {
        size_t events, count;
        const char *text;
    } cases[] = {{0, 0, "-"},
                 {0, 1000000, "<3"},
                 {0, 65536, "<45.8"},
                 {1, 65536, "15.3"},
                 {3, 1000, "3000"},
                 {1000, 1000, "1000000"},
                 {1, 10000000, "0.1"},
                 {12345, 1000000, "12345"},
                 {9994, 10000000, "999"},
                 {9996, 10000000, "1000"},
                 {1234, 1000000, "1234"},
                 {19984, 10000000, "1998"}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char text[32];
        error_rate_text(cases[i].events, cases[i].count, text, sizeof text);
        assert_string_equal(text, cases[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_are_nearest_ranks),
        cmocka_unit_test(rates_of_nothing_have_an_upper_limit),
    };
    return cmocka_run_group_tests_name("error_ranks", tests, NULL, NULL);
}

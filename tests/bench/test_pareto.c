/* The front: what is on it, and which of it are worth using. */
#include "bench/chart/pareto.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

static void nothing_on_the_front_is_beaten(void **state)
{
    (void)state;
    const struct pareto_point point[] = {
        {10, 1.0, 0},        /* on: fastest of no error */
        {10, 1.1, 5},        /* on: faster, but loses */
        {5, 0.5, 0},         /* on */
        {5, 0.4, 0},         /* slower than the one before */
        {6, 0.5, 0},         /* larger */
        {4, 0.5, 1},         /* on: smaller, but loses */
        {5, 0.5, 0.5},       /* loses more, nothing better */
        {1, 0.1, 0},         /* on */
        {10, 1.0, 0},        /* equal to the first: on, too */
        {1, (double)NAN, 0}, /* not measured */
        {0, 2, 0},           /* not a size */
    };
    const bool expected[] = {1, 1, 1, 0, 0, 1, 0, 1, 1, 0, 0};
    bool on[ARRAY_COUNT(point)];
    assert_int_equal(pareto_front(point, ARRAY_COUNT(point), on), 6);
    for (size_t i = 0; i < ARRAY_COUNT(point); i++)
        assert_int_equal(on[i], expected[i]);
    assert_int_equal(pareto_front(point, 0, on), 0);
}

static void worth_are_three_of_no_error(void **state)
{
    (void)state;
    const struct pareto_point point[] = {
        {20, 2.0, 1e-6}, /* loses */
        {20, 1.5, 0},    /* fastest */
        {2, 0.1, 0},     /* smallest */
        {8, 0.6, 0},     /* 0.045 */
        {10, 1.0, 0},    /* 0.1: balanced */
        {4, 0.5, 0},     /* 0.0625, though most speed for its size */
        {11, 0.99, 0},   /* beaten by the one before */
    };
    size_t worth[PARETO_WORTH];
    pareto_worth(point, ARRAY_COUNT(point), worth);
    assert_int_equal(worth[WORTH_FASTEST], 1);
    assert_int_equal(worth[WORTH_SMALLEST], 2);
    assert_int_equal(worth[WORTH_BALANCED], 4);
    pareto_worth(point, 2, worth);
    assert_int_equal(worth[WORTH_FASTEST], 1);
    assert_int_equal(worth[WORTH_SMALLEST], 2); /* the count: none */
    assert_int_equal(worth[WORTH_BALANCED], 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_on_the_front_is_beaten),
        cmocka_unit_test(worth_are_three_of_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

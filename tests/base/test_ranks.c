/* Quantiles by nearest rank. */
#include "ref/base/base.h"

#include <setjmp.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* Ranks, from 1, of the median, 99 % and 99.9 %, by hand. */
static void ranks_by_value(void **state)
{
    (void)state;
    static const size_t known[][4] = {
        {1, 1, 1, 1},          {2, 1, 2, 2},          {3, 2, 3, 3},         {99, 50, 99, 99},
        {100, 50, 99, 100},    {101, 51, 100, 101},   {200, 100, 198, 200}, {201, 101, 199, 201},
        {1000, 500, 990, 999}, {1001, 501, 991, 1000}};
    static const size_t thousandths[] = {500, 990, 999};
    for (size_t i = 0; i < ARRAY_COUNT(known); i++)
        for (size_t p = 0; p < ARRAY_COUNT(thousandths); p++)
            assert_int_equal(rank_of(known[i][0], thousandths[p]) + 1, known[i][p + 1]);
}

/* So many values do not exceed it, and of the one before not as many. */
static void a_rank_is_the_smallest_that_is_enough(void **state)
{
    (void)state;
    for (size_t count = 1; count <= 2100; count++)
        for (size_t part = 0; part <= 1000; part += part < 10 || part >= 990 ? 1 : 10) {
            size_t at = rank_of(count, part);
            assert_true(at < count);
            assert_true(1000 * (at + 1) >= part * count);
            assert_true(at == 0 || 1000 * at < part * count);
        }
}

static void numbers_are_ordered(void **state)
{
    (void)state;
    static const uint64_t whole[] = {0,        1,          2,         INT32_MAX,
                                     1u << 31, UINT32_MAX, INT64_MAX, UINT64_MAX};
    static const double real[] = {-INFINITY, -1e300, -1,  -5e-324, 0,
                                  5e-324,    1,      1.5, 1e300,   INFINITY};
    for (int i = 0; i < (int)ARRAY_COUNT(whole); i++)
        for (int j = 0; j < (int)ARRAY_COUNT(whole); j++)
            assert_int_equal(order_numbers(whole[i], whole[j]), i < j ? -1 : i > j ? 1 : 0);
    for (int i = 0; i < (int)ARRAY_COUNT(real); i++)
        for (int j = 0; j < (int)ARRAY_COUNT(real); j++)
            assert_int_equal(order_doubles(real[i], real[j]), i < j ? -1 : i > j ? 1 : 0);
    assert_int_equal(order_doubles(0.0, -0.0), 0);
    for (int i = 0; i < (int)ARRAY_COUNT(real); i++)
        assert_true(order_doubles(real[i], NAN) == 0 && order_doubles(NAN, real[i]) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranks_by_value),
        cmocka_unit_test(numbers_are_ordered),
        cmocka_unit_test(a_rank_is_the_smallest_that_is_enough),
    };
    return cmocka_run_group_tests_name("ranks", tests, NULL, NULL) ? 1 : 0;
}

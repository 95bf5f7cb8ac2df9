#include "ref/base/decimal.h"
#include "ref/base/rng.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static float read_float(const char *text)
{
    float x;
    const char *end = decimal_read_float(text, &x);
    assert_non_null(end);
    assert_int_equal(*end, 0);
    return x;
}

static void decimal_reads_the_nearest_float(void **state)
{
    (void)state;
    assert_true(read_float("1") == 1.0f);
    assert_true(read_float("+2.5e1") == 25.0f);
    assert_true(read_float(".5") == 0.5f);
    assert_true(read_float("5.") == 5.0f);
    assert_true(read_float("0.1") == 0x1.99999ap-4f);
    assert_true(read_float("16777217") == 16777216.0f); /* a tie goes to even */
    assert_true(read_float("16777219") == 16777220.0f);
    assert_true(read_float("3.4028235e38") == FLT_MAX);
    assert_true(read_float("1e-45") == 0x1p-149f);
    assert_true(read_float("0.7e-45") == 0.0f);
    assert_true(read_float("0.000000000000000000000000000001e30") == 1.0f);
    assert_int_equal(float_bits(read_float("-0")), 0x80000000u);
    assert_int_equal(float_bits(read_float("-0.0e99999999999999999999")), 0x80000000u);
}

/* Just above the middle of 1 and its successor, by less than a double can show: by way of a double
 * it would tie and go to even, which is 1. */
static void decimal_rounds_once_and_not_by_way_of_a_double(void **state)
{
    (void)state;
    assert_true(read_float("1.00000005960464477539062500000001") == 1.0f + FLT_EPSILON);
    assert_true(read_float("1.000000059604644775390625") == 1.0f);
    assert_true(read_float("1.00000005960464477539062499999999") == 1.0f);
    /* 16 digits, whose double is such a middle exactly. */
    assert_true(read_float("7.621154487133026e-01") == 0x1.8633fep-1f);
    assert_true(read_float("5.526719391345978e-01") == 0x1.1af7d2p-1f);
}

static void decimal_beyond_the_range_is_infinite(void **state)
{
    (void)state;
    assert_true(isinf(read_float("3.4028236e38")));
    assert_true(read_float("-1e99999") == -INFINITY);
    assert_true(read_float("1e-99999") == 0.0f);
}

static void decimal_with_capped_exponents_keeps_its_size(void **state)
{
    (void)state;
    size_t zeros = 150000;
    char *text = malloc(zeros + 32);
    assert_non_null(text);
    memcpy(text, "0.", 2);
    memset(text + 2, '0', zeros);
    memcpy(text + 2 + zeros, "1e100003", 9);
    assert_true(read_float(text) == 0.0f);
    memcpy(text + 2 + zeros, "1e150003", 9);
    assert_true(read_float(text) == 100.0f);
    free(text);
}

static void decimal_refuses_what_is_no_number(void **state)
{
    (void)state;
    static const char *const bad[] = {"",    "-",  ".",   "e5",  "+.e1", "nan",
                                      "inf", "1e", "1e+", "--1", " 1",   "x"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        float x = 1;
        double d = 1;
        assert_null(decimal_read_float(bad[i], &x));
        assert_true(x == 0);
        assert_null(decimal_read_double(bad[i], &d));
    }
    float x;
    assert_string_equal(decimal_read_float("0x10", &x), "x10");
    assert_string_equal(decimal_read_float("1,5", &x), ",5");
}

static void decimal_reads_doubles(void **state)
{
    (void)state;
    double d;
    assert_non_null(decimal_read_double("0.1", &d));
    assert_true(d == 0.1);
    assert_non_null(decimal_read_double("123456789012345678901e-300", &d));
    assert_true(d == 123456789012345678901e-300);
}

static void decimal_writes_the_shortest_form(void **state)
{
    (void)state;
    static const struct {
        float x;
        const char *text;
    } golden[] = {
        {0.0f, "0.0"},
        {-0.0f, "-0.0"},
        {0.1f, "0.1"},
        {-20.0f, "-20.0"},
        {1425.0f, "1425.0"},
        {0.57735026f, "0.57735026"},
        {0x1p-44f, "5.684342e-14"},
        {6.6320736e-9f, "6.6320736e-9"},
        {-1.06939515e-8f, "-1.06939515e-8"},
        {1e-6f, "0.000001"},
        {1e-7f, "1e-7"},
        {1.5e-6f, "0.0000015"},
        {16777216.0f, "16777216.0"},
        {1e12f, "1000000000000.0"},
        {1e13f, "1e13"},
        {FLT_MAX, "3.4028235e38"},
        {0x1p-149f, "1e-45"},
        /* Powers of two whose shortest decimal is not the nearest of its length. */
        {0x1p87f, "1.5474251e26"},
        {0x1p90f, "1.2379401e27"},
        {0x1p-96f, "1.2621775e-29"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(golden); i++) {
        char text[DECIMAL_TEXT];
        assert_int_equal(decimal_write_float(golden[i].x, text), strlen(golden[i].text));
        assert_string_equal(text, golden[i].text);
    }
}

static void decimal_text_keeps_every_bit(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 0);
    for (uint32_t i = 0; i < 200000; i++) {
        uint32_t bits = i < 1024 ? i / 4 << 24 | i % 4 : (uint32_t)rng_u64(&rng);
        float x = float_from_bits(bits);
        if (!float_is_finite(x))
            continue;
        char text[DECIMAL_TEXT];
        size_t length = decimal_write_float(x, text);
        assert_int_equal(length, strlen(text));
        assert_int_equal(float_bits(read_float(text)), bits);
    }
}

static void decimal_is_the_same_in_every_locale(void **state)
{
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    const char *found = NULL;
    for (size_t i = 0; i < ARRAY_COUNT(commas) && !found; i++)
        found = setlocale(LC_NUMERIC, commas[i]);
    if (!found) {
        print_message("SKIP no locale with a decimal comma is installed\n");
        skip();
    }
    decimal_reads_the_nearest_float(state);
    decimal_rounds_once_and_not_by_way_of_a_double(state);
    decimal_writes_the_shortest_form(state);
    setlocale(LC_NUMERIC, "C");
}

static void a_decimal_lies_within(void **state)
{
    (void)state;
    static const struct {
        double lo, hi;
        const char *text;
    } rows[] = {
        {0.24999999999999994, 0.25000000000000006, "0.25"},
        {2047.9999999999943, 2048.0000000000057, "2048"},
        {0.999999999999997, 1.000000000000003, "1"},
        {-0.25, -0.25, "-0.25"},
        {0x1.999999999999ap-4, 0x1.999999999999ap-4, "0.1"},
        {1e-300, 2e-300, "2e-300"},
        {0, 0, "0"},
        {1.5, 0, "1.5"},
        {INFINITY, INFINITY, "inf"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++) {
        char text[DECIMAL_WITHIN_MOST];
        decimal_within(rows[i].lo, rows[i].hi, text);
        assert_string_equal(text, rows[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_decimal_lies_within),
        cmocka_unit_test(decimal_reads_the_nearest_float),
        cmocka_unit_test(decimal_rounds_once_and_not_by_way_of_a_double),
        cmocka_unit_test(decimal_beyond_the_range_is_infinite),
        cmocka_unit_test(decimal_with_capped_exponents_keeps_its_size),
        cmocka_unit_test(decimal_refuses_what_is_no_number),
        cmocka_unit_test(decimal_reads_doubles),
        cmocka_unit_test(decimal_writes_the_shortest_form),
        cmocka_unit_test(decimal_text_keeps_every_bit),
        cmocka_unit_test(decimal_is_the_same_in_every_locale),
    };
    return cmocka_run_group_tests_name("decimal", tests, NULL, NULL);
}

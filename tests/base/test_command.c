/* Laws of ref/base/command.h: exit codes, and numbers on the command line. */
#define _POSIX_C_SOURCE 200809L /* dup2, fileno */
#include "ref/base/command.h"
#include "ref/base/rng.h"
#include "ref/base/text.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void the_first_exit_code_of_the_list_wins(void **state)
{
    (void)state;
    static const int order[] = {4, 3, 2, 1, 77, 0};
    for (size_t a = 0; a < ARRAY_COUNT(order); a++)
        for (size_t b = 0; b < ARRAY_COUNT(order); b++)
            assert_int_equal(exit_worse(order[a], order[b]), order[a < b ? a : b]);
}

static void every_status_has_its_exit_code(void **state)
{
    (void)state;
    assert_int_equal(exit_of_status(STATUS_OK), EXIT_AGREE);
    assert_int_equal(exit_of_status(STATUS_INPUT), EXIT_USAGE);
    assert_int_equal(exit_of_status(STATUS_LIMIT), EXIT_USAGE);
    assert_int_equal(exit_of_status(STATUS_UNSUPPORTED), EXIT_SKIPPED);
    assert_int_equal(exit_of_status(STATUS_DEVICE), EXIT_ENGINE);
    assert_int_equal(exit_of_status(STATUS_MEMORY), EXIT_INTERNAL);
}

#define REFUSED (UINT64_MAX - 1)

/* The value, or REFUSED. */
static uint64_t count_of(const char *text, uint64_t least, uint64_t most)
{
    uint64_t value = 99;
    struct reason reason = {""};
    enum status status = parse_count("--count", text, least, most, &value, &reason);
    if (status == STATUS_OK)
        return value;
    assert_int_equal(status, STATUS_INPUT);
    assert_int_equal(value, 0);
    assert_non_null(strstr(reason.text, "--count: '"));
    assert_non_null(strstr(reason.text, "is not a whole number from "));
    return REFUSED;
}

static void counts_are_whole_decimal_numbers_or_powers(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint64_t value;
    } good[] = {{"0", 0},
                {"7", 7},
                {"007", 7},
                {"1e6", 1000000},
                {"2.5e3", 2500},
                {"3.0", 3},
                {"1E2", 100},
                {"9007199254740992", 9007199254740992},
                {"9007199254740993", 9007199254740993},
                {"18446744073709551615", UINT64_MAX}};
    for (size_t i = 0; i < ARRAY_COUNT(good); i++)
        assert_int_equal(count_of(good[i].text, 0, UINT64_MAX), good[i].value);
    static const char *const bad[] = {"",
                                      " ",
                                      "x",
                                      "1x",
                                      "1 ",
                                      " 1",
                                      "-1",
                                      "-1e-9",
                                      "1.5",
                                      "nan",
                                      "inf",
                                      "1e",
                                      "e3",
                                      "1e400",
                                      "0x10",
                                      "1e-3",
                                      "18446744073709551616",
                                      "--count",
                                      ".",
                                      "1e99",
                                      "1,000"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
        if (count_of(bad[i], 0, UINT64_MAX) != REFUSED)
            fail_msg("'%s' is taken for a count", bad[i]);
}

static void counts_keep_their_range(void **state)
{
    (void)state;
    assert_int_equal(count_of("1", 1, 10), 1);
    assert_int_equal(count_of("10", 1, 10), 10);
    assert_int_equal(count_of("0", 1, 10), REFUSED);
    assert_int_equal(count_of("11", 1, 10), REFUSED);
    assert_int_equal(count_of("1e1", 1, 10), 10);
    uint64_t value;
    struct reason reason;
    assert_int_equal(parse_count("--leaf", "0", 1, 8, &value, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "--leaf: '0' is not a whole number from 1 to 8");
}

static void floats_are_finite_and_whole_words(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        float value;
    } good[] = {{"0", 0},        {"-1.5", -1.5f}, {"1e-3", 1e-3f},      {".5", 0.5f},
                {"-10", -10.0f}, {"3e38", 3e38f}, {"0x1.8p1", 0x1.8p1f}};
    static const char *const bad[] = {"", "x", "1x", "1 ", "nan", "inf", "-inf", "1e39", "1,5"};
    struct reason reason;
    float value;
    for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
        assert_int_equal(parse_float("--eps", good[i].text, &value, &reason), STATUS_OK);
        assert_true(value == good[i].value);
    }
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        value = 99;
        assert_int_equal(parse_float("--eps", bad[i], &value, &reason), STATUS_INPUT);
        assert_true(value == 0);
    }
    assert_string_equal(reason.text, "--eps: '1,5' is not a finite number");
}

static void usage_errors_name_the_command_and_its_help(void **state)
{
    (void)state;
    FILE *file = tmpfile();
    char text[200] = "";
    assert_non_null(file);
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    assert_true(kept >= 0 && dup2(fileno(file), STDERR_FILENO) >= 0);
    int code = usage_error("check", "unknown flag '%s'", "--speed");
    fflush(stderr);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    close(kept);
    rewind(file);
    assert_true(fread(text, 1, sizeof text - 1, file) > 0);
    fclose(file);
    assert_int_equal(code, EXIT_USAGE);
    assert_string_equal(text, "raydiff check: unknown flag '--speed' (see raydiff check --help)\n");
}

static void one_thing_is_told_as_one(void **state)
{
    (void)state;
    static const struct {
        const char *one, *many;
    } nouns[] = {{"triangle", "triangles"},    {"ray", "rays"},
                 {"vertex", "vertices"},       {"leaf", "leaves"},
                 {"inner box", "inner boxes"}, {"mesh", "meshes"},
                 {"pass", "passes"},           {"branch", "branches"},
                 {"hard case", "hard cases"}};
    static const uint64_t counts[] = {0, 1, 2, 11, 21, 101, UINT64_MAX};
    char want[COUNTED_MOST];
    for (size_t n = 0; n < ARRAY_COUNT(nouns); n++)
        for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
            snprintf(want, sizeof want, "%llu %s", (unsigned long long)counts[c],
                     counts[c] == 1 ? nouns[n].one : nouns[n].many);
            assert_string_equal(COUNTED(counts[c], nouns[n].one), want);
        }
    /* Two of one call are two texts, and a long noun is cut. */
    snprintf(want, sizeof want, "%s, %s", COUNTED(1, "a"), COUNTED(2, "b"));
    assert_string_equal(want, "1 a, 2 bs");
    char noun[2 * COUNTED_MOST];
    memset(noun, 'n', sizeof noun - 1);
    noun[sizeof noun - 1] = '\0';
    assert_int_equal(strlen(COUNTED(5, noun)), COUNTED_MOST - 1);
}

/* A bound that is printed is one: not below the number, and less than a digit above it. */
static void bounds_are_rounded_up(void **state)
{
    (void)state;
    static const double exact[] = {0, 1, 0.5, 1234, 8.95e-05, 1e30, 0x1p-20};
    struct rng rng = rng_make(3, 1);
    for (size_t i = 0; i < ARRAY_COUNT(exact); i++) {
        char want[BOUND_TEXT];
        snprintf(want, sizeof want, "%.4g", exact[i]);
        if (strtod(want, NULL) == exact[i])
            assert_string_equal(BOUND(exact[i]), want);
    }
    for (int i = 0; i < 100000; i++) {
        const double part = 1 + (double)rng_below(&rng, 1u << 30) * 0x1p-30;
        const double bound = ldexp(part, (int)rng_below(&rng, 120) - 60);
        const double told = strtod(BOUND(bound), NULL), digit = pow(10, floor(log10(bound)) - 3);
        assert_true(told >= bound);
        assert_true(told < bound + digit * (1 + 1e-9));
    }
    char other[BOUND_TEXT];
    assert_string_equal(bound_text(other, INFINITY), "inf");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_exit_code_of_the_list_wins),
        cmocka_unit_test(every_status_has_its_exit_code),
        cmocka_unit_test(counts_are_whole_decimal_numbers_or_powers),
        cmocka_unit_test(counts_keep_their_range),
        cmocka_unit_test(floats_are_finite_and_whole_words),
        cmocka_unit_test(usage_errors_name_the_command_and_its_help),
        cmocka_unit_test(one_thing_is_told_as_one),
        cmocka_unit_test(bounds_are_rounded_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

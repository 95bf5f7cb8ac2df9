/* An exact t as people are told it (oracle_t_text), by integers: as a decimal where that takes at
 * most 17 digits and a double has it, as a fraction where that is short, else about; of fractions
 * n / m of all sizes, either sign, at the limits of all three. */
#include "ref/base/rng.h"
#include "ref/oracle/oracle.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define LEGIBLE 23 /* characters of a fraction that is told */

/* t = n / (m 2^r), m is odd. */
struct told_t {
    uint64_t n, m;
    int r;
    bool minus;
};

/* What oracle_t_text has for it: a ray straight at a triangle n away, whose direction is m 2^r. n
 * is a float and another. */
static void tell(const struct told_t *t, char text[ORACLE_T_TEXT])
{
    const float far = (float)t->n, near = (float)((int64_t)t->n - (int64_t)far);
    const float sign = t->minus ? -1 : 1;
    float vertex[9] = {-1, -1, far, 1, -1, far, 0, 1, far};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    const struct ray ray = {
        {0, 0, -near}, -0x1p127f, {0, 0, sign * ldexpf((float)t->m, t->r)}, INFINITY};
    struct oracle *oracle;
    struct reason reason = {""};
    assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
    assert_true((int64_t)far + (int64_t)near == (int64_t)t->n);
    oracle_t_text(oracle, &ray, 0, text);
    oracle_free(oracle);
}

static uint64_t greatest_common(uint64_t a, uint64_t b)
{
    while (b) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The digits of x; `bare`: without those that are 0 at its end. */
static const char *digits_of(unsigned __int128 x, bool bare, char out[48])
{
    char *at = out + 47;
    *at = 0;
    while (bare && x && x % 10 == 0)
        x /= 10;
    for (; x; x /= 10)
        *--at = (char)('0' + (int)(x % 10));
    return at;
}

/* The digits of a decimal that are neither 0 before its first nor behind its last. */
static void digits_in(const char *decimal, char out[48])
{
    size_t count = 0;
    for (; *decimal && *decimal != 'e'; decimal++)
        if (*decimal >= (count ? '0' : '1') && *decimal <= '9' && count < 47)
            out[count++] = *decimal;
    while (count && out[count - 1] == '0')
        count--;
    out[count] = 0;
}

/* How it is told. */
enum telling { DECIMAL, FRACTION, ABOUT, TELLINGS };

static enum telling expect(const struct told_t *given, const char *text)
{
    struct told_t t = *given;
    char fraction[99], digits[48], room[48], got[48];
    uint64_t common = greatest_common(t.n, t.m);
    t.n /= common;
    t.m /= common;
    for (; t.n % 2 == 0; t.n /= 2)
        t.r--;
    const unsigned __int128 num = (unsigned __int128)t.n << (t.r < 0 && t.r >= -60 ? -t.r : 0);
    const unsigned __int128 den = (unsigned __int128)t.m << (t.r > 0 && t.r <= 60 ? t.r : 0);
    bool tail = abs(t.r) > 60;
    snprintf(fraction, sizeof fraction, "%s%s/", t.minus ? "-" : "", digits_of(num, false, room));
    strcat(fraction, digits_of(den, false, room));
    if (tail)
        snprintf(fraction + strlen(fraction), 16, "*2^%d", -t.r);
    bool decimal = !tail && t.m == 1 && num <= 1ull << 53;
    unsigned __int128 shown = num;
    for (int i = 0; i < t.r && shown < (unsigned __int128)1 << 120; i++)
        shown *= 5;
    strcpy(digits, digits_of(shown, true, room));
    const double value = ldexp((double)t.n / (double)t.m, -t.r) * (t.minus ? -1 : 1);
    if (strlen(fraction) > LEGIBLE) {
        assert_memory_equal(text, "about ", 6);
        assert_true(fabs(strtod(text + 6, NULL) / value - 1) < 1e-9);
        return ABOUT;
    }
    assert_memory_equal(text, "= ", 2);
    if (!decimal || strlen(digits) > 17) {
        assert_memory_equal(text + 2, fraction, strlen(fraction));
        assert_memory_equal(text + 2 + strlen(fraction), ", about ", 8);
        assert_true(fabs(strtod(text + 10 + strlen(fraction), NULL) / value - 1) < 1e-9);
        return FRACTION;
    }
    char *end;
    assert_true(strtod(text + 2, &end) == value);
    assert_int_equal(*end, 0);
    digits_in(text + 2, got);
    assert_string_equal(got, digits);
    if (strchr(text, '.')) /* no needless 0 */
        assert_int_equal(text[strcspn(text, "e") - 1] == '0', false);
    return DECIMAL;
}

static void t_is_told_as_well_as_it_can_be(void **state)
{
    (void)state;
    static const uint64_t known[] = {1,
                                     2,
                                     3,
                                     5,
                                     7,
                                     10,
                                     99,
                                     1000,
                                     (1ull << 52) - 1,
                                     (1ull << 52) + 1,
                                     (1ull << 53) - 1,
                                     1ull << 53,
                                     (1ull << 53) + 1,
                                     (1ull << 53) + 2,
                                     (1ull << 53) + 4096,
                                     1ull << 54,
                                     (1ull << 55) + 2048};
    uint32_t seen[TELLINGS] = {0};
    struct rng rng = rng_make(7, 0);
    char text[ORACLE_T_TEXT];
    for (int r = -90; r <= 90; r++)
        for (size_t i = 0; i < ARRAY_COUNT(known) + 24; i++)
            for (int k = 0; k < 6; k++) {
                struct told_t t = {.r = r, .m = k < 3 ? 1 : 2 * rng_below(&rng, 99) + 1};
                t.n =
                    i < ARRAY_COUNT(known) ? known[i] : rng_u64(&rng) >> (16 + rng_below(&rng, 48));
                t.n = t.n ? t.n : 1;
                t.minus = k % 2;
                tell(&t, text);
                seen[expect(&t, text)]++;
            }
    for (int i = 0; i < TELLINGS; i++)
        assert_true(seen[i] > 1000);
}

/* Of 0, and where there is no hit. */
static void none_and_nothing_are_told_apart(void **state)
{
    (void)state;
    float vertex[9] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct oracle *oracle;
    struct reason reason = {""};
    char text[ORACLE_T_TEXT];
    assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
    oracle_t_text(oracle, &(struct ray){{0, 0, 0}, 0, {0, 0, 3}, 1}, 0, text);
    assert_string_equal(text, "= 0");
    oracle_t_text(oracle, &(struct ray){{9, 0, 0}, 0, {0, 0, 3}, 1}, 0, text);
    assert_string_equal(text, "is none");
    oracle_free(oracle);
}

/* What a person is told: the exact decimal or fraction where it is short, and never more digits
 * than are known. */
static void t_is_told_exactly(void **state)
{
    (void)state;
    static const struct {
        float height, dir, x;
        const char *text;
    } rows[] = {
        {0.25f, 1, 0.25f, "= 0.25"},
        {0.25f, 3, 0.25f, "= 1/12, about 0.083333333333"},
        {1, 3, 0.25f, "= 1/3, about 0.3333333333333"},
        {0.1f, 1, 0.25f, "= 13421773/134217728, about 0.1000000014901"},
        {2048, 1, 0.25f, "= 2048"},
        {0x1.8p-20f, 1, 0.25f, "= 1.430511474609375e-06"},
        {0x1p-24f, 1, 0.25f, "= 5.9604644775390625e-08"}, /* 17 digits, and 18 */
        {0x1p-25f, 1, 0.25f, "= 1/33554432, about 2.980232238769"},
        {0x1.fffffep+30f, 0x1.234567p-3f, 0.25f, "about 15"},
        {1, 1, 7, "is none"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++) {
        float z = rows[i].height, vertex[9] = {-1, -1, z, 1, -1, z, 0, 1, z};
        uint32_t index[3] = {0, 1, 2};
        struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
        const struct ray ray = {{rows[i].x, 0.125f, 0}, 0, {0, 0, rows[i].dir}, INFINITY};
        struct oracle *oracle;
        struct reason reason;
        char text[ORACLE_T_TEXT];
        assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
        oracle_t_text(oracle, &ray, 0, text);
        if (strncmp(text, rows[i].text, strlen(rows[i].text)) != 0 ||
            (text[0] == '=' && !strchr(text, ',') && strcmp(text, rows[i].text) != 0))
            fail_msg("row %zu: '%s', not '%s'", i, text, rows[i].text);
        oracle_free(oracle);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(t_is_told_as_well_as_it_can_be),
        cmocka_unit_test(t_is_told_exactly),
        cmocka_unit_test(none_and_nothing_are_told_apart),
    };
    return cmocka_run_group_tests_name("oracle_told", tests, NULL, NULL);
}

/* Floats as the text files of findings have them: to the bit there and back. */
#include "ref/base/float_word.h"
#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static void floats_have_a_text_each(void **state)
{
    (void)state;
    static const struct {
        uint32_t bits;
        const char *text;
    } known[] = {{0, "0x0p+0"},
                 {0x80000000, "-0x0p+0"},
                 {1, "0x1p-149"},
                 {3, "0x1.8p-148"},
                 {0x007FFFFF, "0x1.fffffcp-127"},
                 {0x00800000, "0x1p-126"},
                 {0x7F7FFFFF, "0x1.fffffep+127"},
                 {0x3FC00000, "0x1.8p+0"},
                 {0xBF800001, "-0x1.000002p+0"},
                 {0x7F800000, "inf"},
                 {0xFF800000, "-inf"},
                 {0x7FC00000, "nan:0x7fc00000"},
                 {0xFF800001, "nan:0xff800001"}};
    char text[FLOAT_WORD_MOST];
    const char *rule;
    float x;
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        size_t length = float_word_write(float_from_bits(known[i].bits), text);
        assert_string_equal(text, known[i].text);
        assert_int_equal(length, strlen(text));
    }
    struct rng rng = rng_make(1, 0);
    for (uint32_t i = 0; i < 300000; i++) {
        uint32_t bits = i < 70000 ? i * 61357u : (uint32_t)rng_u64(&rng);
        float_word_write(float_from_bits(bits), text);
        const char *end = float_word_read(text, &x, &rule);
        if (!end || *end || float_bits(x) != bits)
            fail_msg("0x%08x: %s: 0x%08x", bits, text, float_bits(x));
    }
}

static void floats_are_read_as_people_write_them(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        float x;
    } good[] = {{"1.5", 1.5f},
                {"-0.1", -0.1f},
                {"1e-45", 0x1p-149f},
                {"+0x10p-4", 1.0f},
                {"0X1.8P1", 3.0f},
                {"0x.8p1", 1.0f},
                {"0x0.0p9999", 0.0f},
                {"0x100000000p+0", 0x1p32f},
                {"0x0.00001p-129", 0x1p-149f},
                {"+inf", INFINITY}};
    static const char *const bad[] = {"",
                                      "x",
                                      "0x",
                                      "0x1",
                                      "0x1p",
                                      "0x1p+",
                                      "0x1p128",
                                      "0x1p-150",
                                      "0x1.000001p+0",
                                      "0x3p-150",
                                      "1e39",
                                      "nan",
                                      "nan:0x7f800000",
                                      "nan:0x7fc0000",
                                      "nan:0x00000001",
                                      "0x1p99999",
                                      "0x1111111111111111p+0",
                                      "0x.p+0",
                                      "--1",
                                      "0x1.ffffffp+127"};
    const char *rule, *end;
    float x;
    for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
        end = float_word_read(good[i].text, &x, &rule);
        if (!end || *end || float_bits(x) != float_bits(good[i].x))
            fail_msg("%s: %a", good[i].text, (double)x);
    }
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        rule = NULL;
        end = float_word_read(bad[i], &x, &rule);
        if (end || !rule)
            fail_msg("%s: %a", bad[i], (double)x);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_have_a_text_each),
        cmocka_unit_test(floats_are_read_as_people_write_them),
    };
    return cmocka_run_group_tests_name("fuzz_numbers", tests, NULL, NULL);
}

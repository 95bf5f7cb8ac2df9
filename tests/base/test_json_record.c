/* Objects of named values (ref/base/json_record.h). */
#include "ref/base/json_record.h"
#include "ref/base/rng.h"
#include "ref/base/text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_text(json_t *object, const char *text)
{
    char *dumped = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(9));
    assert_non_null(dumped);
    assert_string_equal(dumped, text);
    free(dumped);
    json_decref(object);
}

static void test_every_conversion_in_its_order(void **state)
{
    (void)state;
    assert_text(json_record("z=%s a=%d b=%u c=%zu d=%g e=%i f=%p", "text", -1, UINT32_MAX,
                            (size_t)1 << 40, 0.5, true, json_array()),
                "{\"z\":\"text\",\"a\":-1,\"b\":4294967295,\"c\":1099511627776,\"d\":0.5,"
                "\"e\":true,\"f\":[]}");
}

static void test_what_json_cannot_hold_is_null(void **state)
{
    (void)state;
    assert_text(json_record("a=%g b=%g c=%p d=%p", (double)NAN, -(double)INFINITY, json_text(NULL),
                            json_text("x")),
                "{\"a\":null,\"b\":null,\"c\":null,\"d\":\"x\"}");
}

static void test_names_hold_texts(void **state)
{
    (void)state;
    json_t *object = json_record("a=%d", 1);
    json_add(object, "%s_ns=%g to_%s=%s", "prim", 2.5, "rand", "c");
    assert_text(object, "{\"a\":1,\"prim_ns\":2.5,\"to_rand\":\"c\"}");
}

/* The array is freed; leaks are seen by the sanitizers. */
static void test_without_memory_there_is_no_object(void **state)
{
    (void)state;
    assert_null(json_record("a=%p b=%p", json_array(), (void *)NULL));
    json_add(NULL, "a=%p b=%d", json_array(), 1);
}

/* What Jansson takes, which knows UTF-8, too. */
static bool is_told(const char *text)
{
    json_t *value = json_string(text);
    json_decref(value);
    return value != NULL;
}

/* Bytes at and beside the ends of what can begin and continue a character. */
static char drawn_byte(struct rng *rng)
{
    static const unsigned char ends[] = {0x01, 0x41, 0x7F, 0x80, 0x8F, 0x90, 0x9F, 0xA0, 0xBF, 0xC0,
                                         0xC1, 0xC2, 0xDF, 0xE0, 0xE1, 0xEC, 0xED, 0xEE, 0xEF, 0xF0,
                                         0xF1, 0xF3, 0xF4, 0xF5, 0xF7, 0xF8, 0xFC, 0xFE, 0xFF};
    return (char)ends[rng_below(rng, ARRAY_COUNT(ends))];
}

static void test_utf8_is_what_json_takes(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 0);
    char text[5] = "";
    unsigned taken = 0;
    for (unsigned word = 0; word < 0x10000; word++) {
        text[0] = (char)(word & 0xFF), text[1] = (char)(word >> 8), text[2] = '\0';
        assert_int_equal(utf8_is_text(text), is_told(text));
    }
    for (int i = 0; i < 400000; i++) {
        for (int k = 0; k < 4; k++)
            text[k] = drawn_byte(&rng);
        text[i % 2 ? 3 : 4] = '\0';
        taken += is_told(text);
        assert_int_equal(utf8_is_text(text), is_told(text));
    }
    assert_true(taken > 1000);
    assert_int_equal(utf8_bytes(""), 0);
    assert_int_equal(utf8_bytes("a\xE9"), 1);
    assert_int_equal(utf8_bytes("\xC3\xA9z"), 2);
    assert_int_equal(utf8_bytes("\xE2\x82\xACz"), 3);
    assert_int_equal(utf8_bytes("\xF0\x9F\x98\x80z"), 4);
}

/* No text takes its record away: what is UTF-8 stays, a byte that is not becomes U+FFFD. */
static void test_any_bytes_are_told(void **state)
{
    (void)state;
    assert_text(json_record("a=%s b=%p", "\xE9t\xC3\xA9\xC3", json_text("\xFF")),
                "{\"a\":\"\xEF\xBF\xBDt\xC3\xA9\xEF\xBF\xBD\",\"b\":\"\xEF\xBF\xBD\"}");
    struct rng rng = rng_make(2, 0);
    for (int i = 0; i < 20000; i++) {
        char text[9] = "", want[25] = "";
        for (uint32_t k = 0, bytes = rng_below(&rng, 9); k < bytes; k++)
            text[k] = drawn_byte(&rng);
        for (const char *at = text; *at;) {
            const size_t bytes = utf8_bytes(at);
            strncat(want, bytes ? at : "\xEF\xBF\xBD", bytes ? bytes : 3);
            at += bytes ? bytes : 1;
        }
        json_t *value = json_text(text);
        assert_non_null(value);
        assert_string_equal(json_string_value(value), want);
        json_decref(value);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_conversion_in_its_order),
        cmocka_unit_test(test_what_json_cannot_hold_is_null),
        cmocka_unit_test(test_names_hold_texts),
        cmocka_unit_test(test_utf8_is_what_json_takes),
        cmocka_unit_test(test_any_bytes_are_told),
        cmocka_unit_test(test_without_memory_there_is_no_object),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

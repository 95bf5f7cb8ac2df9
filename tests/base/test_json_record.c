/* Objects of named values (ref/base/json_record.h). */
#include "ref/base/json_record.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_conversion_in_its_order),
        cmocka_unit_test(test_what_json_cannot_hold_is_null),
        cmocka_unit_test(test_names_hold_texts),
        cmocka_unit_test(test_without_memory_there_is_no_object),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

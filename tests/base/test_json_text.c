/* Laws of ref/base/json_text.h: texts of ours fit, one of empty objects does not, and readers of
 * JSON ask before they parse. */
#include "ref/base/json_text.h"
#include "ref/tree/bvh_json.h"
#include "scenes/read/formats.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* HEAD, so many times "ONE", TAIL; the caller frees it. */
static char *many(const char *head, const char *one, size_t count, const char *tail)
{
    size_t length = strlen(head) + strlen(one) * count + strlen(tail);
    char *text = malloc(length + 1), *at = text;
    assert_non_null(text);
    at = strcpy(at, head) + strlen(head);
    for (size_t i = 0; i < count; i++)
        at = strcpy(at, one) + strlen(one);
    strcpy(at, tail);
    return text;
}

static bool fits(const char *one, size_t count)
{
    char *text = many("", one, count, "");
    bool fit = json_text_fits(text, strlen(text));
    free(text);
    return fit;
}

static void an_object_needs_sixteen_bytes(void **state)
{
    (void)state;
    assert_true(json_text_fits("", 0));
    assert_true(fits("{}", 200)); /* few are no harm */
    assert_false(fits("{},", 100000));
    assert_false(fits("{{{", 100000));
    assert_true(fits("{\"letter\":1234},", 100000));
    assert_false(fits("{\"letter\":123},", 100000));
    assert_true(fits("[],", 100000));
    assert_true(fits("{\"pos\":[0,0,0],\"normal\":[0,0,1]},", 100000));
}

/* The bytes end where they are said to. */
static void nothing_is_read_beyond_the_end(void **state)
{
    (void)state;
    char *text = many("", "{", 300, "");
    assert_true(json_text_fits(text, 256));
    assert_true(json_text_fits(text, 273));
    assert_false(json_text_fits(text, 274));
    free(text);
}

static void readers_ask_first(void **state)
{
    (void)state;
    struct scene scene, out;
    struct bvh bvh;
    struct reason reason = {""};
    char *text = many("{\"unknown\":[{}", ",{}", 10000, "],\"camera\":1}");
    assert_int_equal(read_rtrs("x.json", text, strlen(text), &out, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "x.json: " JSON_TEXT_RULE);
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    assert_int_equal(bvh_json_read("x.json", text, strlen(text), &scene, &bvh, &reason),
                     STATUS_INPUT);
    assert_string_equal(reason.text, "x.json: " JSON_TEXT_RULE);
    scene_free(&scene);
    free(text);
}

/* Reasons quote files; a terminal must not obey them. */
static void a_reason_is_one_printable_line(void **state)
{
    (void)state;
    struct reason reason;
    assert_int_equal((fail)(&reason, STATUS_INPUT, "a\nb\033[2J\177c \303\244"), STATUS_INPUT);
    assert_string_equal(reason.text, "a?b?[2J?c \303\244");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_object_needs_sixteen_bytes),
        cmocka_unit_test(nothing_is_read_beyond_the_end),
        cmocka_unit_test(readers_ask_first),
        cmocka_unit_test(a_reason_is_one_printable_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

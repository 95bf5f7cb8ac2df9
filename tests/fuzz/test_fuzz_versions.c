/* The versions that a finding's file has: a line for each engine that is not the program's own,
 * whole lines alone, and what two engines run on once. */
#include "fuzz/findings/versions.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

static void describe_first(const struct engine *engine, const struct engine_options *options,
                           char *text, size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, " \n\tDriver 1.5 (a card)\nand more about it");
}

static void describe_threads(const struct engine *engine, const struct engine_options *options,
                             char *text, size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, "Library 3.1, kernel x, 16 threads");
}

static void describe_comma(const struct engine *engine, const struct engine_options *options,
                           char *text, size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, "Tracer 2, of threads, and cloth");
}

static const struct engine own = {.name = "own", .reference = true, .describe = describe_comma};
static const struct engine first = {.name = "first", .describe = describe_first};
static const struct engine twin = {.name = "twin", .describe = describe_first};
static const struct engine threads = {.name = "threads", .describe = describe_threads};
static const struct engine comma = {.name = "comma", .describe = describe_comma};

static const struct engine *const all[] = {&own, &first, &twin, &threads, &comma};

#define OWN_LINE "raydiff " RAYDIFF_VERSION
static const char *const lines[] = {OWN_LINE, "\nfirst: Driver 1.5 (a card)",
                                    "\nthreads: Library 3.1, kernel x",
                                    "\ncomma: Tracer 2, of threads, and cloth"};

/* In any number of bytes it is as many of the lines, from the first, as fit with their end. */
static void as_many_whole_lines_as_fit(void **state)
{
    (void)state;
    char text[400];
    size_t seen = 0;
    for (size_t bytes = strlen(lines[0]) + 1; bytes < 200; bytes++) {
        char wanted[400] = "";
        for (size_t i = 0; i < ARRAY_COUNT(lines); i++) {
            if (strlen(wanted) + strlen(lines[i]) + 1 > bytes)
                break;
            strcat(wanted, lines[i]);
            seen = i > seen ? i : seen;
        }
        memset(text, 'x', sizeof text);
        fuzz_versions(all, ARRAY_COUNT(all), NULL, text, bytes);
        assert_string_equal(text, wanted);
        for (size_t i = bytes; i < sizeof text; i++)
            assert_int_equal(text[i], 'x');
    }
    assert_int_equal(seen, ARRAY_COUNT(lines) - 1);
}

static void no_engine_has_no_line(void **state)
{
    (void)state;
    char text[100];
    for (size_t count = 0; count < 2; count++) {
        fuzz_versions(all, count, NULL, text, sizeof text);
        assert_string_equal(text, lines[0]);
    }
    fuzz_versions(all + 2, 1, NULL, text, sizeof text);
    assert_string_equal(text, "raydiff " RAYDIFF_VERSION "\ntwin: Driver 1.5 (a card)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_many_whole_lines_as_fit),
        cmocka_unit_test(no_engine_has_no_line),
    };
    return cmocka_run_group_tests_name("fuzz_versions", tests, NULL, NULL) ? 1 : 0;
}

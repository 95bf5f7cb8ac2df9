/* Programs that are run once, by bytes in and out (ref/outside/tool.h). */
#define _POSIX_C_SOURCE 200809L
#include "ref/outside/tool.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

static enum status shell(const char *script, const void *in, size_t size, uint32_t ms,
                         struct tool_answer *out, struct reason *reason)
{
    const char *const argv[] = {"sh", "-c", script, NULL};
    const struct tool_order order = {
        .argv = argv, .in = in, .in_size = size, .most = 1 << 20, .ms = ms};
    return tool_run(&order, out, reason);
}

static void a_tool_has_its_input_and_output(void **state)
{
    enum { SIZE = 1 << 19 };
    (void)state;
    char *in = malloc(SIZE);
    struct tool_answer out;
    struct reason reason;
    assert_non_null(in);
    for (size_t i = 0; i < SIZE; i++)
        in[i] = (char)(i * 31 >> 3);
    assert_int_equal(shell("cat; echo said >&2", in, SIZE, 10000, &out, &reason), STATUS_OK);
    assert_int_equal(out.size, SIZE);
    assert_memory_equal(out.out, in, SIZE);
    assert_string_equal(out.said, "said");
    tool_free(&out);
    assert_int_equal(shell("head -c 5", in, SIZE, 10000, &out, &reason), STATUS_OK); /* reads few */
    assert_int_equal(out.size, 5);
    tool_free(&out);
    free(in);
}

static void a_tool_that_fails_is_told_of(void **state)
{
    static const struct {
        const char *script, *why;
        uint32_t ms;
    } cases[] = {{"echo bad >&2; exit 3", "sh ended with exit code 3: bad", 10000},
                 {"echo worse; exit 1", "sh ended with exit code 1: worse", 10000},
                 {"kill -9 $$", "sh was ended by signal 9", 10000},
                 {"sleep 60", "sh: not done after 0.3 s", 300},
                 {"exec >&-; sleep 60", "sh: not done after 0.3 s", 300},
                 {"yes", "sh: its output is longer than 1048576 bytes", 10000}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tool_answer out;
        struct reason reason = {""};
        assert_int_equal(shell(cases[i].script, "", 0, cases[i].ms, &out, &reason), STATUS_DEVICE);
        assert_string_equal(reason.text, cases[i].why);
        tool_free(&out);
    }
    const char *const argv[] = {"./no/such", NULL};
    const struct tool_order order = {.argv = argv, .most = 1, .ms = 100};
    struct tool_answer out;
    struct reason reason;
    assert_int_equal(tool_run(&order, &out, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "there is no program ./no/such");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tool_has_its_input_and_output),
        cmocka_unit_test(a_tool_that_fails_is_told_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

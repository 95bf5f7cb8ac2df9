/* The self-test's own parts: its table, and what it makes of how a program ends. The programs are
 * scripts here. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/selftest/selftest.h"

#include "fuzz/findings/findings.h"
#include "ref/base/command.h"
#include "ref/base/rng.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/campaigns.h"

static void a_table_is_read(void **state)
{
    (void)state;
    struct selftest_bug *bug;
    size_t count;
    char name[SELFTEST_NAME_MOST];
    const char *text = "# a comment\n\n"
                       "A ref/base/half.c  cpu f32 rounding\n"
                       "\tA trace_f32 cpu,vulkan f32,rf16 padding  \n"
                       "B_2 gpu/x/y.c spirv f32 stack";
    if (selftest_parse("it", text, &bug, &count, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(count, 3);
    assert_string_equal(bug[1].bug, "A");
    assert_string_equal(bug[1].unit, "trace_f32");
    assert_string_equal(bug[1].engines, "cpu,vulkan");
    assert_string_equal(bug[1].layouts, "f32,rf16");
    assert_string_equal(bug[1].kind, "padding");
    selftest_name(&bug[0], name);
    assert_string_equal(name, "A.half");
    selftest_name(&bug[1], name);
    assert_string_equal(name, "A.trace_f32");
    selftest_name(&bug[2], name);
    assert_string_equal(name, "B_2.y");
    assert_true(selftest_chosen(&bug[0], "A") && selftest_chosen(&bug[0], "A.half") &&
                selftest_chosen(&bug[0], "rounding") && selftest_chosen(&bug[0], "cpu"));
    assert_false(selftest_chosen(&bug[0], "A.trace_f32") || selftest_chosen(&bug[0], "B_2") ||
                 selftest_chosen(&bug[0], "half"));
    free(bug);
}

static void what_is_no_table_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"", "it: it lists no bug"},
        {"# only\n\n", "it: it lists no bug"},
        {"A u e l k\nB u e l\n", "it:2: a line is"},
        {"\nA u e l k more\n", "it:2: a line is"},
        {"A0123456789012345678901234567890123 u e l k\n", "it:1: a line is"},
        {"A d/u.c e l k\nB u e l k\nA u.x e2 l2 k\n", "it:3: A is planted there twice"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct selftest_bug *bug;
        size_t count;
        assert_int_equal(selftest_parse("it", bad[i].text, &bug, &count, &reason), STATUS_INPUT);
        if (strncmp(reason.text, bad[i].said, strlen(bad[i].said)) != 0)
            fail_msg("%zu: %s", i, reason.text);
        assert_null(bug);
        assert_int_equal(count, 0);
    }
}

/* Each word may be as long as its field with the 0 at its end, and no longer. */
static void a_word_is_as_long_as_its_field(void **state)
{
    (void)state;
    static const struct selftest_bug none;
    const size_t most[] = {sizeof none.bug, sizeof none.unit, sizeof none.engines,
                           sizeof none.layouts, sizeof none.kind};
    for (size_t i = 0; i < 5; i++)
        for (int over = 0; over < 2; over++) {
            struct selftest_bug *bug;
            size_t count;
            char word[5][64] = {"A", "u", "e", "l", "k"}, line[400];
            memset(word[i], 'x', most[i] - 1 + (size_t)over);
            snprintf(line, sizeof line, "%s %s %s %s %s\n", word[0], word[1], word[2], word[3],
                     word[4]);
            assert_int_equal(selftest_parse("it", line, &bug, &count, &reason),
                             over ? STATUS_INPUT : STATUS_OK);
            if (over)
                continue;
            const char *const read[] = {bug->bug, bug->unit, bug->engines, bug->layouts, bug->kind};
            for (size_t k = 0; k < 5; k++)
                assert_string_equal(read[k], word[k]);
            free(bug);
        }
}

/* What must be among the planted bugs, and where none may be. */
static void the_table_of_the_sources_is_whole(void **state)
{
    (void)state;
    static const char *const kinds[] = {"rounding", "comparison",  "padding",    "slots",
                                        "sentinel", "indices",     "truncation", "child-order",
                                        "stack",    "best-hit",    "range",      "any-hit",
                                        "sign",     "contraction", "bounds",     "packing"};
    struct selftest_bug *bug;
    size_t count, shaders = 0, units = 0;
    if (access("fuzz/selftest.txt", R_OK) != 0) {
        printf("SKIP: the sources are not the current folder\n");
        skip();
    }
    if (selftest_read("fuzz/selftest.txt", &bug, &count, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < count; i++) {
        if (strstr(bug[i].unit, "oracle") || strstr(bug[i].unit, "judge") ||
            strncmp(bug[i].unit, "fuzz/", 5) == 0)
            fail_msg("%s is in who judges: %s", bug[i].bug, bug[i].unit);
        shaders += strncmp(bug[i].unit, "trace_", 6) == 0 || strncmp(bug[i].unit, "world_", 6) == 0;
        units += strstr(bug[i].unit, ".c") != NULL;
    }
    assert_true(count >= 40);
    assert_int_equal(shaders + units, count);
    assert_true(shaders >= 20 && units >= 20);
    for (size_t k = 0; k < ARRAY_COUNT(kinds); k++) {
        bool there = false;
        for (size_t i = 0; i < count; i++)
            there = there || strcmp(bug[i].kind, kinds[k]) == 0;
        if (!there)
            fail_msg("no bug of kind %s", kinds[k]);
    }
    free(bug);
}

/* Runs a script as the program of a bug. */
static struct selftest_result run(const char *name, const char *engines, uint64_t trials,
                                  const char *script)
{
    struct selftest_job job = {.program = in_root("program"),
                               .folder = in_root(name),
                               .engines = engines,
                               .layouts = "f32",
                               .seed = 7,
                               .trials = trials,
                               .seconds = 5};
    struct selftest_job *one = &job;
    enum status status = STATUS_OK;
    FILE *file = fopen(job.program, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", script);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(job.program, 0700), 0);
    if (selftest_start(&job, &reason))
        fail_msg("%s", reason.text);
    while (!selftest_ended(&job, &status, &reason))
        selftest_wait(&one, 1, 1000);
    assert_int_equal(status, STATUS_OK);
    assert_true(job.result.seconds > 0 && job.result.seconds < 60);
    return job.result;
}

/* A script that copies a folder of findings made here and reports them as `state`. */
static struct selftest_result run_finder(const char *name, const char *state, uint64_t trials,
                                         int code)
{
    char script[2000];
    snprintf(
        script, sizeof script,
        "echo \"$@\"\ncp -r '%s' '%s/found'\n"
        "echo '{\"findings\": [{\"state\": \"known\"}, {\"state\": \"%s\"}]}' >'%s/report.json'\n"
        "exit %d",
        in_root("made"), in_root(name), state, in_root(name), code);
    return run(name, "cpu,vulkan", trials, script);
}

static void a_program_that_finds_something_has_found_its_bug(void **state)
{
    (void)state;
    assert_campaign(in_root("made"), 20, 1, 30);
    for (int again = 0; again < 2; again++) { /* what the first run left is removed */
        struct selftest_result result = run_finder("finds", "new", 0, 1);
        assert_int_equal(result.end, SELFTEST_FOUND);
        assert_int_equal(result.trials, 21); /* the lowest: trial 20 is the 21st */
        struct finding_file lowest = made(20);
        char signature[FUZZ_SIGNATURE_MOST];
        fuzz_signature_print(&lowest.signature, signature);
        assert_string_equal(result.said, signature);
        finding_file_free(&lowest);
    }
    /* What never shows again finds no bug, but is too much for a program without one. */
    assert_int_equal(run_finder("finds_flaky", "flaky", 0, 0).end, SELFTEST_CLEAN);
    assert_int_equal(run_finder("control", "flaky", 100, 0).end, SELFTEST_FOUND);
    char *log;
    size_t size;
    if (file_read(in_root("finds/log"), &log, &size, &reason))
        fail_msg("%s", reason.text);
    assert_non_null(
        strstr(log, "fuzz --no-shrink --seed 7 --engine cpu,vulkan --layout f32 --dir "));
    assert_non_null(strstr(log, " --until 1"));
    free(log);
}

static void a_program_that_finds_nothing_is_clean(void **state)
{
    (void)state;
    char script[1200];
    struct findings *findings;
    assert_int_equal(findings_open(in_root("empty"), &findings, &reason), STATUS_OK);
    findings_close(findings);
    snprintf(script, sizeof script, "echo \"$@\"; cp -r '%s' '%s/found'; exit 0", in_root("empty"),
             in_root("clean"));
    struct selftest_result result = run("clean", "cpu", 900, script);
    assert_int_equal(result.end, SELFTEST_CLEAN);
    assert_int_equal(result.trials, 900);
    char *log;
    size_t size;
    if (file_read(in_root("clean/log"), &log, &size, &reason))
        fail_msg("%s", reason.text);
    assert_non_null(strstr(log, " --trials 900"));
    assert_null(strstr(log, "--until"));
    free(log);
}

/* A program that says "1" but shows nothing has not found its bug. */
static void who_cannot_show_a_finding_has_none(void **state)
{
    (void)state;
    struct selftest_result result = run("liar", "cpu", 0, "exit 1");
    assert_int_equal(result.end, SELFTEST_FAILED);
    result = run("sick", "cpu", 0, "echo one; echo two; exit 4");
    assert_int_equal(result.end, SELFTEST_FAILED);
    assert_string_equal(result.said, "ended itself with code 4: two");
    result = run("dead", "cpu", 0, "kill -9 $$");
    assert_int_equal(result.end, SELFTEST_FAILED);
    assert_non_null(strstr(result.said, "signal 9"));
    result = run("away", "vulkan", 0, "echo no device; exit 77");
    assert_int_equal(result.end, SELFTEST_SKIPPED);
    assert_string_equal(result.said, "no device");
}

static void the_check_of_shaders_is_asked_and_heard(void **state)
{
    (void)state;
    struct selftest_result result = run("bare", "spirv", 0,
                                        "[ \"$*\" = 'fuzz --self-test --shaders' ] || exit 2\n"
                                        "echo 'shader x: 1 bare'; exit 1");
    assert_int_equal(result.end, SELFTEST_FOUND);
    assert_string_equal(result.said, "shader x: 1 bare");
    assert_int_equal(result.trials, 0);
    result = run("pinned", "spirv", 0, "echo fine");
    assert_int_equal(result.end, SELFTEST_CLEAN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_is_read),
        cmocka_unit_test(what_is_no_table_is_refused_with_its_line),
        cmocka_unit_test(a_word_is_as_long_as_its_field),
        cmocka_unit_test(the_table_of_the_sources_is_whole),
        cmocka_unit_test(a_program_that_finds_something_has_found_its_bug),
        cmocka_unit_test(a_program_that_finds_nothing_is_clean),
        cmocka_unit_test(who_cannot_show_a_finding_has_none),
        cmocka_unit_test(the_check_of_shaders_is_asked_and_heard),
    };
    return cmocka_run_group_tests_name("fuzz_selftest", tests, make_root, remove_root);
}

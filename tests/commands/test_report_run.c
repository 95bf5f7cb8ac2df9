/* What raydiff report makes of a child: its code, state, words and result, whatever it does. */
#define _GNU_SOURCE /* kill */
#include "cmd/report/cmd_report.h"
#include "ref/base/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What the child does: argv is WAY END CODE SAID --json FILE. */
enum { WAY, END, CODE, SAID, FILE_AT = 5 };

/* A child whose result is absent, no JSON, JSON of another command, or what is read. */
static const char *const ways[] = {"nothing", "{\"rows\": [", "{\"rows\": 1}", "{\"rows\": []}"};
static const char *const ends[] = {"returns", "exits", "dies"};

static int child(int argc, char **argv)
{
    if (argc != FILE_AT + 1)
        abort();
    fprintf(stderr, "%s\n", argv[SAID]);
    if (strcmp(argv[WAY], ways[0]) != 0) {
        FILE *file = fopen(argv[FILE_AT], "w");
        if (!file || fputs(argv[WAY], file) < 0 || fclose(file) != 0)
            abort();
    }
    fflush(NULL);
    if (strcmp(argv[END], "dies") == 0)
        kill(getpid(), SIGKILL);
    if (strcmp(argv[END], "exits") == 0)
        _exit(atoi(argv[CODE]));
    return atoi(argv[CODE]);
}

static void make(struct runner *runner, const char *way, const char *end, int code, struct run *run,
                 struct report_part *part)
{
    static const char said[] = "raydiff bench: it was so";
    struct reason reason = {""};
    struct line line;
    char number[12];
    snprintf(number, sizeof number, "%d", code);
    line_begin(&line, way);
    line_word(&line, end);
    line_word(&line, number);
    line_word(&line, said);
    *part = (struct report_part){.kind = REPORT_BENCH};
    assert_int_equal(runner_make(runner, child, &line, "r.json", run, part, &reason), STATUS_OK);
    assert_int_equal(line.argc, 0);
    assert_false(run->stopped);
    assert_true(part->seconds >= 0 && part->seconds < 60);
}

/* A result counts if it can be read, whatever the code. If the child ended of itself with a code
 * that promises a result and there is none to read, that is why; else what it said. */
static void a_part_is_what_its_child_did(void **state)
{
    static const int codes[] = {EXIT_AGREE,  EXIT_MISMATCH, EXIT_USAGE,
                                EXIT_ENGINE, EXIT_INTERNAL, EXIT_SKIPPED};
    for (size_t w = 0; w < ARRAY_COUNT(ways); w++)
        for (size_t e = 0; e < ARRAY_COUNT(ends); e++)
            for (size_t c = 0; c < ARRAY_COUNT(codes); c++) {
                struct run run;
                struct report_part part;
                const bool dead = e > 0, read = w == 3;
                const int code = dead ? EXIT_ENGINE : codes[c];
                make(*state, ways[w], ends[e], codes[c], &run, &part);
                assert_int_equal(run.dead, dead);
                assert_int_equal(part.code, code);
                assert_int_equal(part.json != NULL, read);
                assert_int_equal(part.state, !dead && read          ? REPORT_RAN
                                             : code == EXIT_SKIPPED ? REPORT_SKIPPED
                                                                    : REPORT_FAILED);
                if (dead)
                    assert_non_null(strstr(part.why, e == 2 ? "it was killed by signal 9 "
                                                            : "it ended itself with code "));
                else if (!read && (code == EXIT_AGREE || code == EXIT_MISMATCH))
                    assert_non_null(strstr(part.why, w == 0   ? "No such file"
                                                     : w == 1 ? "r.json:1:"
                                                              : "is no JSON of raydiff bench"));
                else
                    assert_string_equal(part.why, "raydiff bench: it was so");
                json_decref(part.json);
            }
}

/* The result of a child before it is not taken for that of one that writes none. */
static void an_older_result_is_not_read(void **state)
{
    struct run run;
    struct report_part part;
    make(*state, ways[3], "returns", 0, &run, &part);
    assert_non_null(part.json);
    json_decref(part.json);
    make(*state, ways[0], "returns", 0, &run, &part);
    assert_null(part.json);
    assert_int_equal(part.state, REPORT_FAILED);
}

int main(void)
{
    static struct runner runner = {.seconds = 60};
    struct reason reason = {""};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(a_part_is_what_its_child_did, &runner),
        cmocka_unit_test_prestate(an_older_result_is_not_read, &runner),
    };
    runner.progress = progress_make("report");
    if (runner_open(&runner, &reason)) {
        fprintf(stderr, "%s\n", reason.text);
        return 4;
    }
    int failed = cmocka_run_group_tests_name("report_run", tests, NULL, NULL);
    runner_close(&runner);
    return failed;
}

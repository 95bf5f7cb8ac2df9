/* A report says what its parts say, and nothing else: whatever they hold the page is well-formed
 * and asks for nothing, what is wrong stands out, what failed is in it and in the exit code. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

static void every_section_is_there(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
    add(&report, REPORT_BENCH, json_of(error_text, NULL, 0), 0);
    add(&report, REPORT_BENCH, json_of(frames_text, NULL, 0), 0);
    add(&report, REPORT_PICTURES, json_of(diff_text, NULL, 0), 0);
    add(&report, REPORT_MACHINE, json_of(doctor_text, NULL, 0), EXIT_SKIPPED);
    add(&report, REPORT_FINDING, json_of(replay_text, NULL, 0), 0);
    char *page = page_of(&report);
    static const char *const wanted[] = {"id=\"summary\"",
                                         "id=\"agreement\"",
                                         "id=\"speed\"",
                                         "id=\"pictures\"",
                                         "id=\"findings\"",
                                         "id=\"machine\"",
                                         "id=\"commands\"",
                                         "<h3>S&lt;1&gt;</h3>",
                                         "agrees",
                                         "7 allowed",
                                         "Speed against error",
                                         "Size against speed",
                                         "Memory against speed",
                                         "other&lt;",
                                         "Frames: S&lt;1&gt;",
                                         "cpu&lt;f32&gt;",
                                         "2 of 9 differ, by at most 1 ulp",
                                         "e&lt;1&gt; against cpu",
                                         "<td class=\"n bad\">2</td>",
                                         "<td class=\"bad\">NOT so",
                                         "Driver hardware does not run: none &lt;here&gt;",
                                         "still fails",
                                         "why &lt;b&gt;",
                                         "raydiff command 'a&lt;b'",
                                         "raydiff explain &lt;x&gt;",
                                         "title &lt;&amp;&gt;"};
    for (size_t i = 0; i < ARRAY_COUNT(wanted); i++)
        has(page, wanted[i]);
    assert_int_equal(report_sum(&report).figures, 4); /* error, size, memory, frames */
    assert_int_equal(report_code(&report), EXIT_AGREE);
    free(page);
    report_free(&report);
}

static void what_is_missing_is_said(void **state)
{
    (void)state;
    struct report report = empty();
    char *page = page_of(&report);
    assert_int_equal(occurrences(page, "Not part of this report."), 5);
    has(page, "No part was requested");
    free(page);
    report_free(&report);
}

/* Only what is judged wrong is red; as published is marked another way. */
static void what_is_wrong_stands_out(void **state)
{
    (void)state;
    static const struct {
        const char *wrong, *bits, *judged, *differences, *status, *cell, *word;
    } rows[] = {{"0", "0", "true", "0", "ok", "<td class=\"good\"", "agrees"},
                {"3", "0", "true", "3", "ok", "<td class=\"bad\"", "3 WRONG"},
                {"0", "4", "true", "4", "ok", "<td class=\"bad\"", "4 other bits"},
                {"0", "0", "true", "0", "vacuous", "<td class=\"bad\"", "proves nothing"},
                {"3", "0", "false", "0", "ok", "<td class=\"pub\"", "3 wrong"},
                {"0", "0", "true", "0", "failed", "<td class=\"bad\"", "failed"},
                {"0", "0", "true", "0", "skipped", "<td class=\"none\"", "skipped"}};
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++) {
        struct report report = empty();
        add(&report, REPORT_CHECK,
            check_of(rows[i].wrong, rows[i].bits, rows[i].judged, rows[i].differences,
                     rows[i].status),
            0);
        char *page = page_of(&report), cell[80];
        const char *matrix = strstr(page, "class=\"matrix\"");
        assert_non_null(matrix);
        snprintf(cell, sizeof cell, "%s title=\"why &amp; how\">%s", rows[i].cell, rows[i].word);
        has(matrix, cell);
        free(page);
        report_free(&report);
    }
}

static void what_is_wrong_is_counted(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_CHECK, check_of("3", "2", "true", "3", "ok"), EXIT_MISMATCH);
    add(&report, REPORT_CHECK, check_of("5", "0", "false", "0", "ok"), 0);
    const struct report_sum sum = report_sum(&report);
    assert_int_equal(sum.rows, 2);
    assert_int_equal(sum.wrong, 3);
    assert_int_equal(sum.published, 5);
    assert_int_equal(sum.bits, 2);
    report_free(&report);
}

static void a_finding_can_be_played_again(void **state)
{
    (void)state;
    struct report report = empty();
    add(&report, REPORT_FINDING, json_of(replay_text, NULL, 0), EXIT_MISMATCH);
    char *page = page_of(&report);
    const char *section = strstr(page, "id=\"findings\"");
    assert_non_null(section);
    assert_in_range(strstr(section, "raydiff command 'a&lt;b'") - section, 0,
                    strstr(section, "id=\"machine\"") - section);
    has(page, ">1 finding is still there (exit code 1)<");
    assert_int_equal(report_code(&report), EXIT_MISMATCH);
    free(page);
    report_free(&report);
}

static void the_exit_code_is_of_all_parts(void **state)
{
    (void)state;
    static const struct {
        struct report_part part;
        int code;
    } cases[] = {
        {{.kind = REPORT_CHECK, .state = REPORT_RAN, .code = EXIT_MISMATCH}, EXIT_MISMATCH},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_AGREE}, EXIT_INTERNAL},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_MISMATCH}, EXIT_INTERNAL},
        {{.kind = REPORT_CHECK, .state = REPORT_FAILED, .code = EXIT_USAGE}, EXIT_USAGE},
        {{.kind = REPORT_BENCH, .state = REPORT_SKIPPED, .code = EXIT_AGREE}, EXIT_SKIPPED},
        {{.kind = REPORT_BENCH, .state = REPORT_GIVEN, .code = EXIT_ENGINE}, EXIT_ENGINE},
        {{.kind = REPORT_MACHINE, .state = REPORT_FAILED, .code = EXIT_SKIPPED}, EXIT_SKIPPED}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct report report = empty();
        struct reason reason;
        add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
        assert_int_equal(report_add(&report, &cases[i].part, &reason), STATUS_OK);
        assert_int_equal(report_code(&report), cases[i].code);
        free(page_of(&report));
        /* Nor does a part behind it that is well excuse anything. */
        add(&report, REPORT_CHECK, check_of("0", "0", "true", "0", "ok"), 0);
        assert_int_equal(report_code(&report), cases[i].code);
        report_free(&report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_section_is_there),
        cmocka_unit_test(what_is_missing_is_said),
        cmocka_unit_test(what_is_wrong_stands_out),
        cmocka_unit_test(what_is_wrong_is_counted),
        cmocka_unit_test(a_finding_can_be_played_again),
        cmocka_unit_test(the_exit_code_is_of_all_parts),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}

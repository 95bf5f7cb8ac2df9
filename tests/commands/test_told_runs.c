/* Numbers that raydiff bench frames and conform tell at the end of a run: no two are the same. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/bench/cmd_bench_frames.h"
#include "cmd/conform/cmd_conform_report.h"

#include "tests/commands/told.h"

/* Of four frames the median is the mean of the two in the middle; ratios are a frame's. */
static void what_measured_frames_tell(void **state)
{
    (void)state;
    static struct frames_run run;
    double first[] = {10, 20, 40, 30}, second[] = {5, 40, 20, 60}, scratch[4];
    const struct screen screen = {.width = 4000, .wide = true};
    const struct frames_about about = {.title = "t", .base = 0};
    const struct reason reason = {""};
    run = (struct frames_run){.settings = {.frames = 9, .turns = 7, .warm_up = 8},
                              .contestant = {{.handler = "a", .bytes = 101, .ms = first},
                                             {.handler = "b", .bytes = 102, .ms = second}},
                              .count = 2,
                              .done = 4,
                              .dropped = 3,
                              .scratch = scratch};
    const char *const lines[] = {
        "4 frames over 7 turns, handlers by turns; 3 frames to warm up, dropped",
        "handler bytes average least most median ratio least-most clock",
        "a 101 25.000 10.000 40.000 25.000 1.000 1.000-1.000",
        "b 102 31.250 5.000 60.000 30.000 1.250 0.500-2.000",
    };
    told_begin(&stdout);
    assert_int_equal(frames_finish("bench", &run, &about, NULL, &screen, STATUS_OK, &reason), 0);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
}

/* Sums are of what was put in; the time is not looked at. */
static void what_a_conformance_run_tells(void **state)
{
    (void)state;
    static const struct list named[TABLE_COUNT];
    static const struct conform_options options;
    static struct conform_report report;
    static struct row row;
    struct reason reason = {""};
    assert_int_equal(conform_report_open(&report, &options, 0, false, named, &reason), STATUS_OK);
    report.screen = (struct screen){.width = 4000, .wide = true};
    row = (struct row){.engine = engine_find("cpu"),
                       .layout = layout_find("f32"),
                       .options = {.tri = tri_tests[0]},
                       .rays = 11,
                       .hits = 12,
                       .compared = 13,
                       .bit_differences = 14,
                       .worst_over = 15.5,
                       .judged = true};
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        row.count[v] = 100 + v;
    char line[600];
    int at = snprintf(line, sizeof line, "FAILED x: 11 rays, 12 hits;");
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        at += snprintf(line + at, sizeof line - (size_t)at, " %s %zu",
                       verdict_name((enum verdict)v), 100 + v);
    snprintf(line + at, sizeof line - (size_t)at, "; err/E 15.50; bits 14");
    char sums[600];
    at = snprintf(sums, sizeof sums, "%d rays judged:", 5 * 13);
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        at += snprintf(sums + at, sizeof sums - (size_t)at, " %s %zu",
                       verdict_name((enum verdict)v), (v == VERDICT_WRONG ? 4 : 5) * (100 + v));
    snprintf(sums + at, sizeof sums - (size_t)at, "; as published, counted: %d",
             100 + VERDICT_WRONG);
    told_begin(&stdout);
    for (int i = 0; i < 5; i++) { /* two fail, the last is of a member as published */
        row.differences = i < 2;
        row.judged = i < 4;
        conform_report_add(&report, i ? "y" : "x", STATUS_OK, &row, &reason, false, 1);
    }
    row.status = ROW_SKIPPED;
    row.compared = 0;
    memset(row.count, 0, sizeof row.count);
    conform_report_add(&report, "z", STATUS_OK, &row, &reason, false, 1);
    report.excused = 16;
    report.vacuous = 17;
    assert_int_equal(conform_report_close(&report), 1);
    char *text = told_end(), *time = strstr(text, "6 trials in ");
    assert_non_null(time);
    memset(time + strlen("6 trials in "), ' ', strcspn(time + strlen("6 trials in "), "s"));
    char other[600];
    snprintf(other, sizeof other, "FAILED y%s", line + strlen("FAILED x"));
    const char *const lines[] = {line,
                                 other,
                                 sums,
                                 "17 trials failed for want of hits alone",
                                 "16 rays more in trials that are waived",
                                 "6 trials in s, 0 waived",
                                 "3 passed, 2 failed, 1 skipped"};
    told_text(text, lines, ARRAY_COUNT(lines));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_measured_frames_tell),
        cmocka_unit_test(what_a_conformance_run_tells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

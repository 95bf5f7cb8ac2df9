/* Cells of a report by value: the parts of the summary, and frames, of which table and chart have
 * all numbers of the JSON. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

#include <math.h>

#include "bench/chart/chart.h"

struct part_case {
    enum report_kind kind;
    enum report_state state;
    int code;
    const char *known;
    double seconds;
};

/* A finding that fails although it is in the baseline is excused; in no other state or kind. */
static bool excused(const struct part_case *c)
{
    return c->kind == REPORT_FINDING && c->state == REPORT_RAN && c->code == EXIT_MISMATCH &&
           c->known && c->known[0];
}

static const char *meaning(const struct part_case *c)
{
    if (excused(c))
        return "still fails, as is known";
    if (c->kind == REPORT_FINDING && c->code == EXIT_AGREE)
        return "does not fail any more";
    if (c->kind == REPORT_FINDING && c->code == EXIT_MISMATCH)
        return "still fails";
    switch (c->code) {
    case EXIT_AGREE:
        return "agrees";
    case EXIT_MISMATCH:
        return "mismatch, or it proves nothing";
    case EXIT_USAGE:
        return "bad input";
    case EXIT_ENGINE:
        return "an engine crashed, hung or could not finish";
    case EXIT_INTERNAL:
        return "internal error";
    case EXIT_SKIPPED:
        return "something cannot run here";
    default:
        return "ended by a signal";
    }
}

static const char *look(const struct part_case *c)
{
    bool bad = c->state == REPORT_FAILED || c->code == EXIT_ENGINE || c->code == EXIT_INTERNAL ||
               (c->code == EXIT_MISMATCH && !excused(c));
    return bad ? "bad" : c->state == REPORT_SKIPPED ? "none" : "good";
}

static const enum report_kind kinds[] = {REPORT_CHECK, REPORT_BENCH, REPORT_PICTURES,
                                         REPORT_FINDING, REPORT_MACHINE};
static const int codes[] = {EXIT_AGREE,    EXIT_MISMATCH, EXIT_USAGE, EXIT_ENGINE,
                            EXIT_INTERNAL, EXIT_SKIPPED,  139};
static const char *const known[] = {NULL, "", "excused <by>"};

#define CASES (ARRAY_COUNT(kinds) * ARRAY_COUNT(codes) * ARRAY_COUNT(known) * (REPORT_FAILED + 1u))

static struct part_case case_of(size_t i)
{
    return (struct part_case){.kind = kinds[i % 5],
                              .state = (enum report_state)(i / 5 % (REPORT_FAILED + 1u)),
                              .code = codes[i / 20 % ARRAY_COUNT(codes)],
                              .known = known[i / 140],
                              .seconds = i % 2 ? (double)i + 0.25 : 0};
}

static void every_part_has_its_state_code_and_meaning(void **state)
{
    (void)state;
    static const char *const states[] = {"done", "from a file", "skipped", "FAILED"};
    struct report report = empty();
    struct reason reason;
    for (size_t i = 0; i < CASES; i++) {
        struct part_case c = case_of(i);
        char name[20], why[20], old[20];
        snprintf(name, sizeof name, "part %zu", i);
        snprintf(why, sizeof why, "why %zu", i);
        snprintf(old, sizeof old, "%s", c.known ? c.known : "");
        const struct report_part part = {.kind = c.kind,
                                         .state = c.state,
                                         .name = name,
                                         .command = name,
                                         .why = why,
                                         .known = c.known ? old : NULL,
                                         .code = c.code,
                                         .seconds = c.seconds};
        assert_int_equal(report_add(&report, &part, &reason), STATUS_OK);
    }
    char *page = page_of(&report);
    for (size_t i = 0; i < CASES; i++) {
        struct part_case c = case_of(i);
        char row[400], seconds[20];
        snprintf(seconds, sizeof seconds, "%.1f", c.seconds);
        if (c.seconds <= 0)
            seconds[0] = '\0';
        snprintf(row, sizeof row,
                 "<tr>\n<th scope=\"row\">part %zu</th>\n<td class=\"%s\">%s</td>\n"
                 "<td class=\"n\">%d</td>\n<td>%s</td>\n<td class=\"n\">%s</td>\n"
                 "<td class=\"wrap\">why %zu</td>\n</tr>",
                 i, look(&c), states[c.state], c.code, meaning(&c), seconds, i);
        has(page, row);
    }
    has(page, ">of 420 parts 105 failed and 105 were skipped<");
    free(page);
    report_free(&report);
}

/* Four runs whose numbers all differ; one frame of the second has no time. */
static const char many_frames[] =
    "{'title': 'S', 'frames': 4, 'warm_up_dropped': 2, 'stopped': true, 'handlers': ["
    "{'handler': 'a', 'bytes': 112, 'clock': 'host', 'average_ms': 2.5, 'min_ms': 1.25,"
    " 'max_ms': 4.75, 'median_ms': 2.125, 'samples_ms': [1.25, 4.75, 2.0, 2.25],"
    " 'ratio': {'to': 'a', 'median': 1.0, 'min': 0.5, 'max': 2.0}},"
    "{'handler': 'b', 'bytes': 48, 'clock': 'device', 'average_ms': 20.5, 'min_ms': 11.0,"
    " 'max_ms': 44.5, 'median_ms': 22.25, 'samples_ms': [11.0, null, 44.5, 22.25],"
    " 'ratio': {'to': 'a', 'median': 10.5, 'min': 8.5, 'max': 12.25}},"
    "{'handler': 'c', 'bytes': 656, 'clock': 'host', 'average_ms': 7.0, 'min_ms': 6.0,"
    " 'max_ms': 8.0, 'median_ms': 7.5, 'samples_ms': [6.0, 7.5, 8.0]}]}";

static void all_numbers_of_frames_are_in_table_and_chart(void **state)
{
    (void)state;
    static const double value[3][4] = {{1.25, 4.75, 2, 2.25}, {11, NAN, 44.5, 22.25}, {6, 7.5, 8}};
    static const struct chart_series series[] = {{"a", 112, 2.5, 1.25, 4.75, value[0], 4},
                                                 {"b", 48, 20.5, 11, 44.5, value[1], 4},
                                                 {"c", 656, 7, 6, 8, value[2], 3}};
    static const char *const rows[] = {
        "<th>a</th>\n<td class=\"n\">112</td>\n<td class=\"n\">2.500</td>\n"
        "<td class=\"n\">1.250</td>\n<td class=\"n\">4.750</td>\n<td class=\"n\">2.125</td>\n"
        "<td class=\"n\">1.000</td>\n<td class=\"n\">0.500</td>\n<td class=\"n\">2.000</td>\n"
        "<td>a</td>\n<td>host</td>\n",
        "<th>b</th>\n<td class=\"n\">48</td>\n<td class=\"n\">20.500</td>\n"
        "<td class=\"n\">11.000</td>\n<td class=\"n\">44.500</td>\n<td class=\"n\">22.250</td>\n"
        "<td class=\"n\">10.500</td>\n<td class=\"n\">8.500</td>\n<td class=\"n\">12.250</td>\n"
        "<td>a</td>\n<td>device</td>\n",
        "<th>c</th>\n<td class=\"n\">656</td>\n<td class=\"n\">7.000</td>\n"
        "<td class=\"n\">6.000</td>\n<td class=\"n\">8.000</td>\n<td class=\"n\">7.500</td>\n"
        "<td class=\"n\"></td>\n<td class=\"n\"></td>\n<td class=\"n\"></td>\n"
        "<td></td>\n<td>host</td>\n",
        ">4 frames measured, 2 before them dropped; the run was ended early<"};
    const struct chart chart = {.title = "S",
                                .x_label = "frame",
                                .y_label = CHART_DURATION,
                                .unit = "ms",
                                .series = series,
                                .series_count = 3};
    struct report report = empty();
    char *drawn = NULL;
    size_t size = 0;
    add(&report, REPORT_BENCH, json_of(many_frames, NULL, 0), 0);
    char *page = page_of(&report);
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++)
        has(page, rows[i]);
    FILE *stream = open_memstream(&drawn, &size);
    assert_non_null(stream);
    chart_svg(stream, &chart);
    assert_int_equal(fclose(stream), 0);
    has(page, drawn);
    free(drawn);
    free(page);
    report_free(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_part_has_its_state_code_and_meaning),
        cmocka_unit_test(all_numbers_of_frames_are_in_table_and_chart),
    };
    return cmocka_run_group_tests_name("report_cells", tests, make_root, remove_root) ? 1 : 0;
}

#include "tests/cmd_conform_report.h"

#include "ref/command.h"

#include <ctype.h>
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

enum outcome { PASSED, FAILED, SKIPPED, WAIVED };

static enum status read_waiver_line(struct conform_report *report, char *line, size_t number,
                                    struct reason *reason)
{
    char *text = line + strspn(line, " \t\r");
    if (*text == '\0' || *text == '#')
        return STATUS_OK;
    size_t length = strcspn(text, " \t");
    char *why = text + length + strspn(text + length, " \t");
    if (*why == '\0')
        return fail(reason, STATUS_INPUT, "%s:%zu: a waiver needs a reason after its pattern",
                    report->waiver_path, number);
    if (report->waiver_count == WAIVER_MOST || length >= 256 || strlen(why) >= 256)
        return fail(reason, STATUS_INPUT, "%s:%zu: at most %d waivers of 255 characters",
                    report->waiver_path, number, WAIVER_MOST);
    struct waiver *waiver = &report->waiver[report->waiver_count++];
    memcpy(waiver->pattern, text, length);
    strcpy(waiver->reason, why);
    return STATUS_OK;
}

static enum status read_waivers(struct conform_report *report, struct reason *reason)
{
    char *bytes = NULL;
    size_t size = 0, number = 0;
    enum status status = file_read(report->waiver_path, &bytes, &size, reason);
    if (status)
        return status;
    for (char *line = bytes; status == STATUS_OK && line < bytes + size;) {
        char *end = line + strcspn(line, "\n");
        bool last = *end == '\0';
        *end = '\0';
        status = read_waiver_line(report, line, ++number, reason);
        line = last ? bytes + size : end + 1;
    }
    free(bytes);
    return status;
}

enum status conform_report_open(struct conform_report *report, size_t expected, bool verbose,
                                bool tap, const char *waivers, const char *junit,
                                struct reason *reason)
{
    *report = (struct conform_report){.expected = expected,
                                      .verbose = verbose,
                                      .tap = tap,
                                      .waiver_path = waivers,
                                      .start_ns = time_ns()};
    enum status status = waivers ? read_waivers(report, reason) : STATUS_OK;
    if (status == STATUS_OK && junit)
        status = file_out_open(junit, &report->junit, reason);
    if (status)
        return status;
    if (report->junit.stream)
        fprintf(report->junit.stream,
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
                "<testsuite name=\"raydiff conform\" tests=\"%zu\">\n",
                expected);
    if (tap)
        printf("TAP version 13\n1..%zu\n", expected);
    return STATUS_OK;
}

static void print_xml(FILE *to, const char *text)
{
    for (; *text; text++) {
        if (*text == '<')
            fputs("&lt;", to);
        else if (*text == '>')
            fputs("&gt;", to);
        else if (*text == '&')
            fputs("&amp;", to);
        else if (*text == '"')
            fputs("&quot;", to);
        else
            fputc(isprint((unsigned char)*text) ? *text : ' ', to);
    }
}

static void add_junit(FILE *to, const char *name, enum outcome outcome, const char *why,
                      double seconds)
{
    fprintf(to, "<testcase classname=\"conform\" name=\"");
    print_xml(to, name);
    fprintf(to, "\" time=\"%.3f\"", seconds);
    if (outcome == PASSED) {
        fputs("/>\n", to);
        return;
    }
    fputs(outcome == FAILED ? "><failure message=\"" : "><skipped message=\"", to);
    print_xml(to, why);
    fputs("\"/></testcase>\n", to);
}

static void print_outcome(const struct conform_report *report, const char *name,
                          enum outcome outcome, const char *why, const struct row *row)
{
    if (report->tap) {
        printf("%s %zu - %s%s%s\n", outcome == FAILED ? "not ok" : "ok", report->done, name,
               outcome == PASSED   ? ""
               : outcome == FAILED ? " # "
                                   : " # SKIP ",
               outcome == PASSED ? "" : why);
        return;
    }
    static const char *const words[] = {"PASSED", "FAILED", "SKIPPED", "WAIVED"};
    if (outcome == FAILED || outcome == WAIVED || report->verbose)
        printf("%-7s %s: %s\n", words[outcome], name, why);
    for (size_t i = 0; i < row->finding_count && outcome == FAILED; i++) {
        const struct finding *f = &row->finding[i];
        char line[512];
        if (f->bits)
            judge_bits_line(&f->ray, &f->expected, &f->got, line, sizeof line);
        else
            judge_line(&f->ray, &f->judgement, &f->got, line, sizeof line);
        printf("        ray %zu (%s) %s\n", f->ray_index,
               f->bits ? "not cpu's bits" : wrong_name(f->judgement.wrong), line);
    }
}

/* What became of the trial, and one line that says why. */
static enum outcome decide(enum status status, const struct row *row, const struct reason *reason,
                           bool required, char *why, size_t why_bytes)
{
    if (status || row->status == ROW_FAILED) {
        snprintf(why, why_bytes, "%s", status ? reason->text : row->reason.text);
        return FAILED;
    }
    if (row->status == ROW_REFUSED || row->status == ROW_SKIPPED) {
        snprintf(why, why_bytes, "%s", row->reason.text);
        return required && row->status == ROW_SKIPPED ? FAILED : SKIPPED;
    }
    if (row->status == ROW_VACUOUS) {
        snprintf(why, why_bytes, "%s", row->reason.text);
        return FAILED;
    }
    int length = snprintf(why, why_bytes, "%zu rays, %zu hits;", row->rays, row->hits);
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        length += snprintf(why + length, why_bytes - (size_t)length, " %s %zu", verdict_name(v),
                           row->count[v]);
    snprintf(why + length, why_bytes - (size_t)length, "%s; err/E %.2f; bits %zu",
             row->judged ? "" : " (as published, counted)", row->worst_over, row->bit_differences);
    return row->differences ? FAILED : PASSED;
}

static struct waiver *waiver_of(struct conform_report *report, const char *name)
{
    for (size_t i = 0; i < report->waiver_count; i++)
        if (fnmatch(report->waiver[i].pattern, name, 0) == 0)
            return &report->waiver[i];
    return NULL;
}

void conform_report_add(struct conform_report *report, const char *name, enum status status,
                        const struct row *row, const struct reason *reason, bool required,
                        double seconds)
{
    char why[512];
    enum outcome outcome = decide(status, row, reason, required, why, sizeof why);
    struct waiver *waiver = outcome == FAILED ? waiver_of(report, name) : NULL;
    if (waiver) {
        waiver->used++;
        outcome = WAIVED;
        snprintf(why, sizeof why, "%s", waiver->reason);
    }
    report->done++;
    report->passed += outcome == PASSED;
    report->failed += outcome == FAILED;
    report->skipped += outcome == SKIPPED;
    report->waived += outcome == WAIVED;
    report->rays += row->compared;
    for (int v = 0; v < VERDICT_COUNT; v++)
        report->count[v] += row->count[v];
    if (outcome == FAILED) {
        bool engine_failed = status == STATUS_OK && row->status == ROW_FAILED;
        int code = status ? exit_of_status(status) : engine_failed ? EXIT_ENGINE : EXIT_MISMATCH;
        report->code = exit_worse(report->code, code);
    }
    print_outcome(report, name, outcome, why, row);
    if (report->junit.stream)
        add_junit(report->junit.stream, name, outcome, why, seconds);
}

int conform_report_close(struct conform_report *report)
{
    struct reason reason = {""};
    for (size_t i = 0; i < report->waiver_count; i++)
        if (report->waiver[i].used == 0) {
            printf("FAILED  waiver '%s' matched no failing trial: remove it\n",
                   report->waiver[i].pattern);
            report->failed++;
            report->code = exit_worse(report->code, EXIT_MISMATCH);
        }
    if (report->junit.stream) {
        fputs("</testsuite>\n</testsuites>\n", report->junit.stream);
        if (file_out_commit(&report->junit, &reason)) {
            fprintf(stderr, "raydiff conform: %s\n", reason.text);
            report->code = exit_worse(report->code, EXIT_USAGE);
        }
    }
    if (report->passed == 0 && report->failed == 0 && report->code == EXIT_AGREE)
        report->code = EXIT_SKIPPED;
    if (report->tap)
        return report->code;
    printf("%zu rays compared:", report->rays);
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        printf(" %s %zu", verdict_name(v), report->count[v]);
    printf("\n%zu trials in %.1f s, %zu waived\n%zu passed, %zu failed, %zu skipped\n",
           report->done, (double)(time_ns() - report->start_ns) * 1e-9, report->waived,
           report->passed, report->failed, report->skipped);
    return report->code;
}

/* JSON files that a report is put together from: whatever they hold, the page is well-formed. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "bench/report/report.h"
#include "tests/readers/reader_entry.h"
#include "tests/readers/well_formed.h"

#include <stdlib.h>
#include <unistd.h>

static void write_page(const struct report *report)
{
    struct reason reason = {""};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    READER_MUST(out);
    READER_MUST(report_write(report, out, &reason) == STATUS_OK);
    READER_MUST(fclose(out) == 0);
    READER_MUST(occurrences(text, "<figure>") == report_sum(report).figures);
    READER_MUST(occurrences(text, "<script") == 0);
    READER_MUST(well_formed(text + sizeof "<!DOCTYPE html>"));
    free(text);
}

static bool play_as(const char *path, enum report_kind kind)
{
    struct reason reason = {""};
    struct report report = {.title = "fuzz", .command = "raydiff report", .when = "now"};
    struct report_part part = {.kind = kind, .state = REPORT_GIVEN, .name = (char[]){"part"}};
    enum status status = report_read(path, kind, &part.json, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status) {
        READER_MUST(!part.json);
        reader_must_be_reason(&reason);
        return false;
    }
    READER_MUST(report_add(&report, &part, &reason) == STATUS_OK);
    write_page(&report);
    report_free(&report);
    return true;
}

static bool play(const char *bytes, size_t size)
{
    char path[READER_PATH_MOST];
    bool taken = false;
    int file = reader_file(bytes, size, path);
    for (enum report_kind kind = 0; kind < REPORT_KINDS; kind++)
        taken = play_as(path, kind) || taken;
    close(file);
    return taken;
}

/* Figures have room for ROW_PLOT_ROWS rows, charts for frames; both are bounded. */
const struct reader_entry reader_entry = {"page", 1 << 24, play};

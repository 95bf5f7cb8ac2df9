/* The results of the self-test, as text and as JSON. */
#include "cmd/fuzz/cmd_selftest.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "ref/base/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *end_name(const struct selftest_row *row)
{
    switch (row->job.result.end) {
    case SELFTEST_FOUND:
        return row->control ? "NOT CLEAN" : "found";
    case SELFTEST_CLEAN:
        return row->control ? "clean" : "NOT FOUND";
    case SELFTEST_SKIPPED:
        return "skipped";
    default:
        return "FAILED";
    }
}

struct selftest_sum selftest_sum(const struct selftest_command *c)
{
    struct selftest_sum sum = {.seconds = (double)(time_ns() - c->start_ns) * 1e-9};
    double *seconds = alloc_zeroed(c->rows, sizeof *seconds);
    for (size_t i = 0; i < c->rows; i++) {
        const struct selftest_row *row = &c->row[i];
        const struct selftest_result *result = &row->job.result;
        if (result->end == SELFTEST_SKIPPED) {
            sum.skipped++;
        } else if (row->control) {
            sum.controls++;
            sum.clean += result->end == SELFTEST_CLEAN;
        } else {
            sum.planted++;
            if (result->end != SELFTEST_FOUND)
                continue;
            if (seconds)
                seconds[sum.found] = result->seconds;
            sum.found++;
        }
    }
    if (seconds && sum.found) {
        sort_doubles(seconds, sum.found);
        sum.median_s = 0.5 * (seconds[(sum.found - 1) / 2] + seconds[sum.found / 2]);
        sum.slowest_s = seconds[sum.found - 1];
    }
    free(seconds);
    return sum;
}

bool selftest_passed(const struct selftest_sum *sum)
{
    return sum->found == sum->planted && sum->clean == sum->controls;
}

void selftest_print_head(void)
{
    printf("%-19s %-13s %-11s %7s %7s  %s\n", "bug", "planted in", "kind", "trials", "seconds",
           "found as");
    fflush(stdout);
}

static void print_row(const struct selftest_row *row)
{
    const struct selftest_result *result = &row->job.result;
    char name[SELFTEST_NAME_MOST], found[SELFTEST_SAID_MOST + 16];
    selftest_name(row->bug, name);
    const char *unit = strchr(name, '.') + 1;
    if (result->end == SELFTEST_FOUND && !row->control)
        (void)snprintf(found, sizeof found, "%s", result->said);
    else
        (void)snprintf(found, sizeof found, "%s%s%s", end_name(row), result->said[0] ? ": " : "",
                       result->said);
    if (row->control)
        printf("%-19s %-13s %-11s", "no bug", row->bug->engines, row->bug->layouts);
    else
        printf("%-19s %-13s %-11s", row->bug->bug, unit, row->bug->kind);
    printf(" %7llu %7.2f  %s\n", (unsigned long long)result->trials, result->seconds, found);
}

void selftest_print_rows(struct selftest_command *c)
{
    for (size_t i = 0; i < c->rows && c->row[i].ended; i++) {
        if (c->row[i].printed)
            continue;
        if (i == c->planted)
            putchar('\n');
        print_row(&c->row[i]);
        c->row[i].printed = true;
    }
    fflush(stdout);
}

void selftest_print_sum(const struct selftest_sum *sum)
{
    printf("\n%.0f s in all; a bug's median %.2f s, the slowest %.2f s\n", sum->seconds,
           sum->median_s, sum->slowest_s);
    if (sum->skipped)
        printf("%zu skipped\n", sum->skipped);
    printf("without a bug %zu of %zu clean\n", sum->clean, sum->controls);
    printf("found %zu of %zu\n", sum->found, sum->planted);
}

static json_t *json_row(const struct selftest_row *row)
{
    const struct selftest_result *result = &row->job.result;
    return json_record(
        "bug=%s unit=%s kind=%s engines=%s layouts=%s end=%s trials=%zu seconds=%g said=%s",
        row->control ? "" : row->bug->bug, row->control ? "" : row->bug->unit,
        row->control ? "" : row->bug->kind, row->bug->engines, row->bug->layouts, end_name(row),
        result->trials, result->seconds, result->said);
}

enum status selftest_json(const struct selftest_command *c, const struct selftest_sum *sum,
                          struct reason *reason)
{
    json_t *planted = json_array(), *controls = json_array();
    for (size_t i = 0; i < c->rows; i++)
        (void)json_array_append_new(c->row[i].control ? controls : planted, json_row(&c->row[i]));
    json_t *root =
        json_record("version=%s seed=%zu passed=%i found=%zu of=%zu skipped=%zu median_s=%g "
                    "slowest_s=%g seconds=%g bugs=%p controls=%p",
                    RAYDIFF_VERSION, c->seed, selftest_passed(sum), sum->found, sum->planted,
                    sum->skipped, sum->median_s, sum->slowest_s, sum->seconds, planted, controls);
    return json_write(c->json, root, 6, reason);
}

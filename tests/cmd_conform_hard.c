#include "tests/cmd_conform_hard.h"

#include "ref/command.h"
#include "tests/cmd_conform_report.h"
#include "tests/hard/members.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WAIVERS_HERE "tests/waivers.txt"

struct one {
    const struct hard_case *hard;
    struct hard_member member;
};

struct suite {
    struct one *one;
    size_t count, capacity;
    const char *pattern; /* NULL: take all */
    bool failed;         /* no memory */
};

static void suite_add(void *user, const struct hard_case *hard, const struct hard_member *member)
{
    struct suite *suite = user;
    char name[HARD_NAME_MOST];
    hard_name_print(hard, member, name);
    if (suite->pattern && fnmatch(suite->pattern, name, 0) != 0)
        return;
    void *array = suite->one;
    if (array_reserve(&array, &suite->capacity, suite->count + 1, sizeof *suite->one)) {
        suite->failed = true;
        return;
    }
    suite->one = array;
    suite->one[suite->count++] = (struct one){hard, *member};
}

static enum status suite_make(struct suite *suite, struct reason *reason)
{
    for (size_t i = 0; hard_cases[i]; i++)
        hard_each_member(hard_cases[i], suite_add, suite);
    if (suite->failed)
        return fail(reason, STATUS_MEMORY, "no memory for the list of hard cases");
    if (suite->count == 0)
        return fail(reason, STATUS_INPUT, "no hard case matches '%s'", suite->pattern);
    return STATUS_OK;
}

static bool required(const struct conform_hard_options *o, const struct engine *engine)
{
    for (size_t i = 0; i < o->require.count; i++)
        if (engines[o->require.index[i]] == engine)
            return true;
    return false;
}

/* What a result means for a member that is to show a defect, or for any other. */
static enum outcome outcome_of(const struct hard_result *result, const struct hard_defect *defect,
                               bool is_required, char *why, size_t why_bytes)
{
    hard_result_print(result, why, why_bytes);
    switch (result->outcome) {
    case HARD_REFUSED:
        return OUTCOME_REFUSED;
    case HARD_SKIPPED:
        return is_required ? OUTCOME_FAILED : OUTCOME_SKIPPED;
    case HARD_PASSED:
        if (!defect)
            return OUTCOME_PASSED;
        snprintf(why, why_bytes, "the defect %s shows no more", defect->fault);
        return OUTCOME_FAILED;
    case HARD_FAILED:
        if (!defect || result->unfinished)
            return OUTCOME_FAILED;
        snprintf(why, why_bytes, "%s%s%s", defect->fault, defect->cause ? ": " : "",
                 defect->cause ? defect->cause : "");
        return OUTCOME_KNOWN;
    }
    return OUTCOME_FAILED;
}

/* Adds one result to the report and the matrix. */
static enum status add_result(const struct conform_hard_options *o, const struct one *one,
                              const struct hard_result *result, double seconds,
                              struct conform_report *report, struct matrix *matrix,
                              struct reason *reason)
{
    char name[HARD_NAME_MOST], why[900];
    const struct waiver *waiver = NULL;
    const struct hard_defect *defect = hard_defect_of(one->hard, &one->member);
    hard_name_print(one->hard, &one->member, name);
    struct conform_entry entry = {.name = name, .why = why, .seconds = seconds};
    entry.outcome = outcome_of(result, defect, required(o, one->member.engine), why, sizeof why);
    entry.code = result->unfinished ? EXIT_ENGINE : EXIT_MISMATCH;
    enum outcome outcome = conform_report_put(report, &entry, &waiver);
    if (waiver)
        snprintf(why, sizeof why, "%s %s", waiver->reason, waiver->link);
    bool excused = outcome == OUTCOME_WAIVED || outcome == OUTCOME_KNOWN;
    *(excused ? &report->excused : &report->rays) += result->rays;
    for (int v = 0; v < VERDICT_COUNT && !excused; v++)
        report->count[v] += result->count[v];
    return matrix_add(matrix, one->hard, &one->member, outcome, result->rays, why, reason);
}

static enum status run_suite(const struct conform_hard_options *o, const struct suite *suite,
                             struct conform_report *report, struct matrix *matrix,
                             struct reason *reason)
{
    struct hard_stage stage = hard_stage_make(&o->engines);
    struct progress progress = progress_make("conform");
    enum status status = STATUS_OK;
    for (size_t i = 0; i < suite->count && status == STATUS_OK; i++) {
        const struct one *one = &suite->one[i];
        struct hard_result result;
        if (!o->tap)
            progress_step(&progress, "%zu of %zu: %02u-%s", i + 1, suite->count, one->hard->number,
                          one->hard->name);
        uint64_t start = time_ns();
        status = hard_run(&stage, one->hard, &one->member, &result, reason);
        if (status == STATUS_OK)
            status = add_result(o, one, &result, (double)(time_ns() - start) * 1e-9, report, matrix,
                                reason);
    }
    if (!o->tap)
        progress_end(&progress);
    hard_stage_free(&stage);
    return status;
}

typedef void write_fn(const struct matrix *matrix, const char *versions, FILE *out);

/* Writes a document whole or not at all. */
static enum status write_file(const char *path, write_fn *write, const struct matrix *matrix,
                              const char *versions, struct reason *reason)
{
    struct file_out file;
    if (!path)
        return STATUS_OK;
    enum status status = file_out_open(path, &file, reason);
    if (status)
        return status;
    write(matrix, versions, file.stream);
    return file_out_commit(&file, reason);
}

static enum status write_documents(const struct conform_hard_options *o,
                                   const struct matrix *matrix, struct reason *reason)
{
    char versions[8192] = "";
    if (o->summary && !o->tap)
        matrix_text(matrix, stdout);
    if (o->markdown || o->html)
        conform_versions(&o->engines, versions, sizeof versions);
    enum status status = write_file(o->markdown, matrix_markdown, matrix, versions, reason);
    return status ? status : write_file(o->html, matrix_html, matrix, versions, reason);
}

static int play(const struct conform_hard_options *o, const struct suite *suite)
{
    struct conform_report report;
    struct matrix matrix = {.row_count = 0};
    struct reason reason = {""};
    const char *waivers = o->waivers ? o->waivers : NULL;
    if (!waivers && access(WAIVERS_HERE, R_OK) == 0)
        waivers = WAIVERS_HERE;
    enum status status =
        conform_report_open(&report, suite->count, o->pattern == NULL, waivers, o->junit, &reason);
    if (status) {
        fprintf(stderr, "raydiff conform: %s\n", reason.text);
        return exit_of_status(status);
    }
    report.verbose = o->verbose;
    report.tap = o->tap;
    report.quiet = true;
    report.options = o->engines;
    status = run_suite(o, suite, &report, &matrix, &reason);
    if (status == STATUS_OK)
        status = write_documents(o, &matrix, &reason);
    int code = conform_report_close(&report);
    matrix_free(&matrix);
    if (status)
        fprintf(stderr, "raydiff conform: %s\n", reason.text);
    return status ? exit_worse(code, exit_of_status(status)) : code;
}

int conform_hard(const struct conform_hard_options *o)
{
    struct suite suite = {.pattern = o->pattern};
    struct reason reason = {""};
    enum status status = suite_make(&suite, &reason);
    int code = EXIT_AGREE;
    if (status) {
        fprintf(stderr, "raydiff conform: %s\n", reason.text);
        code = exit_of_status(status);
    } else if (o->list) {
        for (size_t i = 0; i < suite.count; i++) {
            char name[HARD_NAME_MOST];
            hard_name_print(suite.one[i].hard, &suite.one[i].member, name);
            puts(name);
        }
    } else {
        code = play(o, &suite);
    }
    free(suite.one);
    return code;
}

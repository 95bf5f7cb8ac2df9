#include "cmd/conform/cmd_conform_worlds.h"

#include "cmd/common/cmd_progress.h"
#include "cmd/conform/cmd_world_suite.h"
#include "ref/base/command.h"

#include <stdlib.h>
#include <string.h>

/* Runs the trials of the suite from `first` on and adds them to the report. ran[i] is set if trial
 * i was judged. */
static void run_suite(const struct conform_options *o, const struct world_suite *suite,
                      size_t first, struct conform_report *report, bool *ran)
{
    struct world_stage stage = {
        .pool = {.options = o->engines}, .ray_count = (size_t)o->count, .brute_budget = o->brute};
    struct progress progress = progress_make("conform");
    for (size_t i = first; i < suite->count; i++) {
        char name[WORLD_NAME_MOST];
        struct row row;
        struct reason reason = {""};
        world_trial_print(&suite->trial[i], name);
        progress_done(&progress, i - first, suite->count - first, NULL);
        if (!o->tap)
            progress_step(&progress, "%zu of %zu: %s", i + 1, suite->count, name);
        uint64_t start = time_ns();
        enum status status = world_stage_run(&stage, &suite->trial[i], &row, &reason);
        ran[i] = !status && row.status != ROW_REFUSED && row.status != ROW_SKIPPED;
        if (!o->tap)
            progress_end(&progress);
        conform_report_add(report, name, status, &row, &reason,
                           list_names(&o->require, suite->trial[i].engine),
                           (double)(time_ns() - start) * 1e-9);
    }
    world_stage_free(&stage);
}

static void print_pairs(const struct conform_options *o, const struct conform_report *report,
                        size_t pairs, size_t unmet, const char *example)
{
    static const char only[] = "of them only in trials that were refused or skipped";
    const char *before = unmet ? ": " : "";
    if (o->tap)
        fprintf(stderr, "%zu pairs of worlds and members met, %zu %s%s%s\n", pairs, unmet, only,
                before, example);
    else
        screen_record(&report->screen, PAINT_PLAIN,
                      "%zu pairs of worlds and members met, %zu %s%s%s\n", pairs, unmet, only,
                      before, example);
}

/* Pairs that met only in trials that did not run get another trial; those left then cannot meet. */
static enum status fill_and_print(const struct conform_options *o, struct world_suite *suite,
                                  struct conform_report *report, bool **ran)
{
    char example[2 * WORLD_FIELD_MOST + 10];
    size_t pairs, unmet, first = suite->count;
    struct world_suite more = {.trial = NULL};
    bool any = false; /* else its engines do not run here, and no other trial changes that */
    for (size_t i = 0; i < suite->count; i++)
        any = any || (*ran)[i];
    enum status status =
        world_suite_pairs(suite, *ran, &pairs, &unmet, example, sizeof example, any ? &more : NULL);
    if (!status)
        status = world_suite_append(suite, ran, &more);
    world_suite_free(&more);
    if (status)
        return status;
    run_suite(o, suite, first, report, *ran);
    status = world_suite_pairs(suite, *ran, &pairs, &unmet, example, sizeof example, NULL);
    if (!status)
        print_pairs(o, report, pairs, unmet, example);
    return status;
}

static int play(const struct conform_options *o, const struct list named[TABLE_COUNT],
                struct world_suite *suite)
{
    struct conform_report report;
    struct reason reason = {""};
    const bool covering = suite->pattern == NULL;
    const bool whole = covering && o->list[TABLE_ENGINES].count == 0;
    bool *ran = alloc_zeroed(suite->count, sizeof *ran);
    enum status status =
        ran ? conform_report_open(&report, o, covering ? 0 : suite->count, whole, named, &reason)
            : fail(&reason, STATUS_MEMORY, "no memory for %zu trials", suite->count);
    int code = exit_with_reason("conform", status, &reason);
    if (!status) {
        run_suite(o, suite, 0, &report, ran);
        if (covering && fill_and_print(o, suite, &report, &ran))
            fprintf(stderr, "raydiff conform: no memory to count pairs\n");
        code = conform_report_close(&report);
    }
    free(ran);
    return code;
}

int conform_worlds(const struct conform_options *o, const struct list named[TABLE_COUNT])
{
    struct world_suite suite = {.pattern = o->pattern};
    struct reason reason = {""};
    memcpy(suite.list, o->list, sizeof suite.list);
    enum status status = world_suite_make(&suite, &reason);
    int code = exit_with_reason("conform", status, &reason);
    for (size_t i = 0; !status && o->list_only && i < suite.count; i++) {
        char name[WORLD_NAME_MOST];
        world_trial_print(&suite.trial[i], name);
        puts(name);
    }
    if (!status && !o->list_only)
        code = play(o, named, &suite);
    world_suite_free(&suite);
    return code;
}

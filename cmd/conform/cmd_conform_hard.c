#include "cmd/conform/cmd_conform_hard.h"
#include "cmd/common/cmd_progress.h"

#include "ref/base/command.h"
#include "ref/files/file.h"
#include "cmd/conform/cmd_conform_report.h"
#include "tests/hard/causes.h"
#include "tests/hard/members.h"
#include "ref/base/text.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

struct one {
    const struct hard_case *hard;
    struct hard_member member;
};

struct hard_suite {
    struct one *one;
    size_t count, capacity;
    const char *pattern; /* NULL: take all */
    struct list engine;  /* empty: take all */
    struct hard_tables tables;
    bool tri_named; /* --tri was given: not only core tests */
    bool quick;     /* skip members with two or more parts as published */
    bool failed;    /* out of memory */
};

static void suite_add(void *user, const struct hard_case *hard, const struct hard_member *member)
{
    struct hard_suite *suite = user;
    char name[HARD_NAME_MOST];
    if (suite->engine.count && !list_names(&suite->engine, member->engine))
        return;
    if (!suite->pattern && !suite->tri_named && !member->tri->core)
        return;
    if (suite->quick && hard_member_published(member) > 1 && !hard_defect_of(hard, member))
        return;
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

static enum status suite_make(struct hard_suite *suite, struct reason *reason)
{
    for (size_t i = 0; hard_case_at(i); i++)
        hard_each_member(hard_case_at(i), &suite->tables, suite_add, suite);
    if (suite->failed)
        return fail(reason, STATUS_MEMORY, "no memory for the list of hard cases");
    if (suite->count == 0)
        return fail(reason, STATUS_INPUT, "no hard case matches '%s'",
                    suite->pattern ? suite->pattern : "hard.*");
    return STATUS_OK;
}

/* Context of count_name, which counts the members that waivers may excuse. */
struct hard_counting {
    struct waivers *waivers;
    bool core; /* count core members only */
    bool more; /* whether there are waivers of which more names may say something else */
};

static void count_name(void *user, const struct hard_case *hard, const struct hard_member *member)
{
    struct hard_counting *counting = user;
    char name[HARD_NAME_MOST];
    if (!counting->more || (counting->core && !member->tri->core))
        return;
    hard_name_print(hard, member, name);
    counting->more = waivers_count(counting->waivers, name);
}

/* Counts the names that the suite would have as a whole, for the waivers of those that ran. */
static void count_names(struct waivers *waivers, bool core)
{
    const struct hard_tables everything = hard_tables_all();
    struct hard_counting counting = {waivers, core, waivers_count(waivers, NULL)};
    for (size_t i = 0; counting.more && hard_case_at(i); i++)
        hard_each_member(hard_case_at(i), &everything, count_name, &counting);
}

/* State of a run. */
struct hard_run {
    const struct conform_options *options;
    struct hard_stage stage;
    struct conform_report *report;
    struct hard_matrix *matrix;
    const char *driver;  /* the driver that `versions` belongs to */
    char versions[8192]; /* from conform_versions; "": not read yet */
};

/* True if the defect is known for the versions here. */
static bool is_expected(struct hard_run *run, const struct hard_defect *defect)
{
    const struct engine_options *options = &run->stage.pool.options;
    if (!defect->version)
        return true;
    if (run->versions[0] == '\0' || run->driver != options->driver)
        conform_versions(options, run->versions, sizeof run->versions);
    run->driver = options->driver;
    return version_told(run->versions, defect->version);
}

/* True if the member is expected to show a defect here. No waiver excuses such a member. */
static bool is_defect(struct hard_run *run, const struct one *one)
{
    const struct hard_defect *defect = hard_defect_of(one->hard, &one->member);
    return defect && is_expected(run, defect);
}

/* Handles a member that showed its defect. The outcome is OUTCOME_KNOWN if the explained cause is
 * the known one, else OUTCOME_FAILED. */
static enum status confirm(struct hard_run *run, const struct one *one,
                           const struct hard_result *result, const struct hard_defect *defect,
                           enum matrix_outcome *outcome, char *why, size_t why_bytes,
                           struct reason *reason)
{
    struct hard_causes causes;
    *outcome = OUTCOME_KNOWN;
    snprintf(why, why_bytes, "%s%s%s", defect->fault, result->reason.text[0] ? ": " : "",
             result->reason.text);
    if (defect->cause == CAUSE_NONE)
        return STATUS_OK;
    enum status status = hard_explain(&run->stage, &one->member, result, &causes, reason);
    if (status)
        return status;
    if (causes.most != defect->cause) {
        char found[300];
        hard_causes_print(&causes, found, sizeof found);
        *outcome = OUTCOME_FAILED;
        snprintf(why, why_bytes, "%s: explained as %s, not %s", defect->fault, found,
                 cause_name(defect->cause));
    } else {
        snprintf(why, why_bytes, "%s: %s, %s%s%s", defect->fault, cause_name(causes.most),
                 cause_text(causes.most), causes.hint[0] ? "; some rays are lost too by " : "",
                 causes.hint);
    }
    return STATUS_OK;
}

static bool shows(const struct hard_result *result, const struct hard_defect *defect)
{
    if (defect->refuses)
        return result->outcome == HARD_REFUSED &&
               strstr(result->reason.text, defect->refuses) != NULL;
    return result->outcome == HARD_FAILED &&
           (!result->unfinished || defect->cause == CAUSE_LOOP_CAP);
}

/* Decides the outcome of a result, for members with and without an expected defect. */
static enum status outcome_of(struct hard_run *run, const struct one *one,
                              const struct hard_result *result, enum matrix_outcome *outcome,
                              char *why, size_t why_bytes, struct reason *reason)
{
    static const enum matrix_outcome plain[] = {[HARD_PASSED] = OUTCOME_PASSED,
                                                [HARD_FAILED] = OUTCOME_FAILED,
                                                [HARD_REFUSED] = OUTCOME_REFUSED,
                                                [HARD_SKIPPED] = OUTCOME_SKIPPED};
    const struct hard_defect *defect = hard_defect_of(one->hard, &one->member);
    hard_result_print(result, why, why_bytes);
    *outcome = plain[result->outcome];
    if (result->outcome == HARD_SKIPPED && list_names(&run->options->require, one->member.engine))
        *outcome = OUTCOME_FAILED;
    if (!defect || result->outcome == HARD_SKIPPED || !is_expected(run, defect))
        return STATUS_OK;
    if (shows(result, defect))
        return confirm(run, one, result, defect, outcome, why, why_bytes, reason);
    if (result->outcome != HARD_FAILED && !defect->rare) {
        *outcome = OUTCOME_FAILED;
        snprintf(why, why_bytes, "the defect %s no longer occurs", defect->fault);
    }
    return STATUS_OK;
}

/* Counts the parts of a case for the named members. */
static void count_turnout(struct turnout *turnout, const struct hard_member *member,
                          const struct hard_result *result)
{
    const char *why = result->reason.text;
    const size_t refused = result->refused - result->declined;
    const struct {
        const char *kind, *name;
    } who[] = {{"engine", member->engine->name},
               {"layout", member->layout ? member->layout->name : NULL},
               {"builder", member->layout ? member->builder->name : NULL},
               {"box", member->layout ? member->box->name : NULL},
               {"tri", member->tri->name}};
    for (size_t i = 0; i < ARRAY_COUNT(who); i++) {
        const bool engine = i == 0;
        if (!who[i].name)
            continue;
        turnout_add(turnout, who[i].kind, who[i].name, TURNOUT_ANSWERED, result->played, why);
        turnout_add(turnout, who[i].kind, who[i].name, engine ? TURNOUT_REFUSED : TURNOUT_SKIPPED,
                    result->declined, why);
        if (!engine) /* the engine played nothing of these */
            turnout_add(turnout, who[i].kind, who[i].name, TURNOUT_REFUSED, refused, why);
        if (result->outcome == HARD_SKIPPED)
            turnout_add(turnout, who[i].kind, who[i].name,
                        result->absent ? TURNOUT_ABSENT : TURNOUT_SKIPPED, 1, why);
        if (result->unfinished)
            turnout_add(turnout, who[i].kind, who[i].name, TURNOUT_FAILED, 1, why);
    }
}

/* Adds one result to the report and the matrix. */
static enum status add_result(struct hard_run *run, const struct one *one,
                              const struct hard_result *result, double seconds,
                              struct reason *reason)
{
    char name[HARD_NAME_MOST], why[900];
    const struct waiver *waiver = NULL;
    struct conform_report *report = run->report;
    hard_name_print(one->hard, &one->member, name);
    struct conform_entry entry = {.name = name, .why = why, .seconds = seconds};
    enum status status = outcome_of(run, one, result, &entry.outcome, why, sizeof why, reason);
    if (status)
        return status;
    entry.code = result->unfinished ? EXIT_ENGINE : EXIT_MISMATCH;
    entry.plain =
        entry.outcome == OUTCOME_FAILED && result->outcome != HARD_SKIPPED && is_defect(run, one);
    enum matrix_outcome outcome = conform_report_put(report, &entry, &waiver);
    report->absent += outcome == OUTCOME_SKIPPED && result->absent;
    count_turnout(&report->turnout, &one->member, result);
    if (waiver)
        snprintf(why, sizeof why, "%s %s", waiver->reason, waiver->link);
    bool excused = outcome == OUTCOME_WAIVED || outcome == OUTCOME_KNOWN;
    *(excused ? &report->excused : &report->rays) += result->rays;
    for (int v = 0; v < VERDICT_COUNT && !excused; v++)
        report->count[v] += result->count[v];
    return matrix_add(run->matrix, one->hard, &one->member, outcome, result->rays, why, reason);
}

static enum status run_suite(struct hard_run *run, const struct hard_suite *suite,
                             struct reason *reason)
{
    struct progress progress = progress_make("conform");
    enum status status = STATUS_OK;
    bool tap = run->options->tap;
    for (size_t i = 0; i < suite->count && status == STATUS_OK; i++) {
        const struct one *one = &suite->one[i];
        struct hard_result result;
        progress_done(&progress, i, suite->count, NULL);
        if (!tap)
            progress_step(&progress, "%zu of %zu: %02u-%s", i + 1, suite->count, one->hard->number,
                          one->hard->name);
        uint64_t start = time_ns();
        status = hard_run(&run->stage, one->hard, &one->member, &result, reason);
        if (status == STATUS_OK)
            status = add_result(run, one, &result, (double)(time_ns() - start) * 1e-9, reason);
    }
    if (!tap)
        progress_end(&progress);
    return status;
}

typedef void write_fn(const struct hard_matrix *matrix, const char *versions, FILE *out);

/* Writes a document completely or not at all. */
static enum status write_file(const char *path, write_fn *write, const struct hard_matrix *matrix,
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

static enum status write_documents(const struct conform_options *o,
                                   const struct hard_matrix *matrix, struct reason *reason)
{
    char versions[8192] = "";
    if (o->summary && !o->tap)
        matrix_text(matrix, stdout);
    if (o->markdown || o->html)
        conform_versions(&o->engines, versions, sizeof versions);
    enum status status = write_file(o->markdown, matrix_markdown, matrix, versions, reason);
    return status ? status : write_file(o->html, matrix_html, matrix, versions, reason);
}

static int play(const struct conform_options *o, const struct list named[TABLE_COUNT],
                const struct hard_suite *suite)
{
    struct conform_report report;
    struct hard_matrix matrix = {.apart = suite->tables.chosen};
    struct reason reason = {""};
    bool complete = o->pattern == NULL && !o->quick && o->list[TABLE_ENGINES].count == 0 &&
                    !suite->tables.chosen;
    enum status status = conform_report_open(&report, o, suite->count, complete, named, &reason);
    if (!status && !o->waivers)
        status = waivers_shipped_read(&report.waivers, &reason);
    if (status)
        return exit_with_reason("conform", status, &reason);
    report.quiet = true;
    struct hard_run run = {
        .options = o, .stage = hard_stage_make(&o->engines), .report = &report, .matrix = &matrix};
    status = run_suite(&run, suite, &reason);
    hard_stage_free(&run.stage);
    if (!complete)
        count_names(&report.waivers, o->pattern == NULL);
    if (status == STATUS_OK)
        status = write_documents(o, &matrix, &reason);
    int code = conform_report_close(&report);
    matrix_free(&matrix);
    return exit_worse(code, exit_with_reason("conform", status, &reason));
}

/* The members chosen by the user, in the form that hard cases take. */
struct chosen {
    const struct layout *layout[LIST_MOST + 1];
    const struct builder *builder[LIST_MOST + 1];
    const struct box_test *box[LIST_MOST + 1];
    const struct tri_test *tri[LIST_MOST + 1];
};

static struct hard_tables choose(const struct conform_options *o, struct chosen *chosen)
{
    const struct list *layout = &o->list[TABLE_LAYOUTS], *builder = &o->list[TABLE_BUILDERS];
    const struct list *box = &o->list[TABLE_BOX_TESTS], *tri = &o->list[TABLE_TRI_TESTS];
    struct hard_tables tables = hard_tables_all();
    list_layouts(layout, chosen->layout);
    for (size_t i = 0; i < builder->count; i++)
        chosen->builder[i] = builders_all[builder->index[i]];
    for (size_t i = 0; i < box->count; i++)
        chosen->box[i] = box_tests[box->index[i]];
    for (size_t i = 0; i < tri->count; i++)
        chosen->tri[i] = tri_tests[tri->index[i]];
    tables.layout = layout->count ? chosen->layout : tables.layout;
    tables.builder = builder->count ? chosen->builder : tables.builder;
    tables.box = box->count ? chosen->box : tables.box;
    tables.tri = tri->count ? chosen->tri : tables.tri;
    tables.chosen = layout->count + builder->count + box->count + tri->count > 0;
    return tables;
}

/* Returns whether a member of the suite has this layout and this builder; NULL: any. */
static bool is_met(const struct hard_suite *suite, const struct layout *layout,
                   const struct builder *builder)
{
    for (size_t i = 0; i < suite->count; i++) {
        const struct hard_member *m = &suite->one[i].member;
        if ((!layout || m->layout == layout) && (!builder || m->builder == builder))
            return true;
    }
    return false;
}

/* Prints the names to standard output, and how much of the tables they cover to standard error. */
static void list_suite(const struct hard_suite *suite)
{
    size_t cases = 0, l, b, of_layouts = 0, of_builders = 0;
    for (size_t i = 0; i < suite->count; i++) {
        char name[HARD_NAME_MOST];
        hard_name_print(suite->one[i].hard, &suite->one[i].member, name);
        puts(name);
        cases += i == 0 || suite->one[i].hard != suite->one[i - 1].hard;
    }
    for (l = 0; layouts_all[l]; l++)
        of_layouts += is_met(suite, layouts_all[l], NULL);
    for (b = 0; builders_all[b]; b++)
        of_builders += is_met(suite, NULL, builders_all[b]);
    fprintf(stderr, "%s of %s: %zu of %zu layouts, %zu of %zu builders\n",
            COUNTED(suite->count, "trial"), COUNTED(cases, "hard case"), of_layouts, l, of_builders,
            b);
}

int conform_hard(const struct conform_options *o, const struct list named[TABLE_COUNT])
{
    static struct chosen chosen;
    struct hard_suite suite = {.pattern = o->pattern,
                               .quick = o->quick,
                               .engine = o->list[TABLE_ENGINES],
                               .tables = choose(o, &chosen),
                               .tri_named = o->list[TABLE_TRI_TESTS].count > 0};
    struct reason reason = {""};
    enum status status = suite_make(&suite, &reason);
    int code = exit_with_reason("conform", status, &reason);
    if (!status && o->list_only)
        list_suite(&suite);
    else if (!status)
        code = play(o, named, &suite);
    free(suite.one);
    return code;
}

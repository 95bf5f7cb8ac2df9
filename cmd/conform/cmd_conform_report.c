#include "cmd/conform/cmd_conform_report.h"

#include "cmd/common/cmd_finding.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <string.h>

void conform_versions(const struct engine_options *options, char *text, size_t text_bytes)
{
    text[0] = '\0';
    for (size_t e = 0; engines[e]; e++) {
        char one[1024] = "";
        engine_describe(engines[e], options, one, sizeof one);
        text_append(text, text_bytes, "%s: %s%s", engines[e]->name, one,
                    one[0] && one[strlen(one) - 1] == '\n' ? "" : "\n");
    }
}

/* Registers the named members: each must answer something. */
static void expect(struct conform_report *report, const struct list list[TABLE_COUNT])
{
    static const enum table tables[] = {TABLE_ENGINES,  TABLE_LAYOUTS,   TABLE_STORES,
                                        TABLE_BUILDERS, TABLE_BOX_TESTS, TABLE_TRI_TESTS};
    const struct list *engine = &list[TABLE_ENGINES];
    const bool trees = engine->count == 0 || list_needs_trees(engine);
    for (size_t t = 0; t < ARRAY_COUNT(tables); t++)
        if (tables[t] == TABLE_ENGINES || tables[t] == TABLE_TRI_TESTS || trees)
            list_expect(tables[t], &list[tables[t]], &report->turnout);
    report->expected += report->expected ? report->turnout.count : 0;
}

enum status conform_report_open(struct conform_report *report, const struct conform_options *o,
                                size_t expected, bool complete,
                                const struct list named[TABLE_COUNT], struct reason *reason)
{
    *report = (struct conform_report){.expected = expected,
                                      .complete = complete,
                                      .verbose = o->verbose,
                                      .tap = o->tap,
                                      .screen = screen_make(&o->screen),
                                      .options = o->engines,
                                      .start_ns = time_ns()};
    enum status status =
        o->waivers ? waivers_read(o->waivers, &report->waivers, reason) : STATUS_OK;
    if (!status && o->junit)
        status = ci_junit_open(o->junit, &report->junit, reason);
    if (status)
        waivers_free(&report->waivers);
    else
        expect(report, named);
    return status;
}

static bool counts_as_passed(enum matrix_outcome outcome)
{
    return outcome == OUTCOME_PASSED || outcome == OUTCOME_KNOWN;
}

/* The entry as a case, for TAP and JUnit. */
static struct ci_case case_of(const struct conform_entry *entry, enum matrix_outcome outcome,
                              const char *why)
{
    bool plain = counts_as_passed(outcome);
    return (struct ci_case){.group = "conform",
                            .name = entry->name,
                            .state = plain                       ? CI_PASSED
                                     : outcome == OUTCOME_FAILED ? CI_FAILED
                                     : outcome == OUTCOME_WAIVED ? CI_KNOWN
                                                                 : CI_SKIPPED,
                            .why = plain ? NULL : why,
                            .seconds = entry->seconds};
}

static void print_entry(const struct conform_report *report, const struct ci_case *one,
                        enum matrix_outcome outcome, const char *why)
{
    static const char *const words[OUTCOME_COUNT] = {"SKIPPED", "REFUSED", "PASSED",
                                                     "KNOWN",   "WAIVED",  "FAILED"};
    if (report->tap) {
        if (report->done == 1 && report->expected > 0)
            ci_tap_head(stdout, report->expected);
        else if (report->done == 1)
            ci_tap_version(stdout);
        ci_tap_case(stdout, report->done, one);
    } else if (outcome == OUTCOME_FAILED || report->verbose ||
               (outcome == OUTCOME_WAIVED && !report->quiet)) {
        screen_record(&report->screen, outcome == OUTCOME_FAILED ? PAINT_BAD : PAINT_DIM,
                      "%-7s %s: %s\n", words[outcome], one->name, why);
    }
}

static enum waiver_event event_of(enum matrix_outcome outcome)
{
    if (outcome == OUTCOME_FAILED)
        return WAIVER_FAILED;
    return outcome == OUTCOME_SKIPPED ? WAIVER_SKIPPED : WAIVER_PASSED;
}

/* Called only when a waiver needs the versions, since it opens every driver. */
static void ask_versions(struct conform_report *report)
{
    if (report->versions[0] == '\0')
        conform_versions(&report->options, report->versions, sizeof report->versions);
}

enum matrix_outcome conform_report_put(struct conform_report *report,
                                       const struct conform_entry *entry,
                                       const struct waiver **waiver)
{
    enum matrix_outcome outcome = entry->outcome;
    char why[512];
    if (outcome == OUTCOME_FAILED && waivers_name_version(&report->waivers, entry->name))
        ask_versions(report);
    const struct waiver *excuse =
        waivers_note(&report->waivers, entry->name, event_of(outcome), report->versions);
    if (entry->plain)
        excuse = NULL;
    snprintf(why, sizeof why, "%s", entry->why);
    if (excuse) {
        outcome = OUTCOME_WAIVED;
        snprintf(why, sizeof why, "%s %s", excuse->reason, excuse->link);
    }
    if (waiver)
        *waiver = excuse;
    report->done++;
    report->outcomes[outcome]++;
    if (outcome == OUTCOME_FAILED)
        report->code = exit_worse(report->code, entry->code);
    const struct ci_case one = case_of(entry, outcome, why);
    print_entry(report, &one, outcome, why);
    if (report->junit.body)
        ci_junit_add(&report->junit, &one);
    return outcome;
}

/* Decides the outcome of a trial and writes one line of reasons to `why`. */
static enum matrix_outcome decide(enum status status, const struct row *row,
                                  const struct reason *reason, bool required, char *why,
                                  size_t why_bytes)
{
    if (status || row->status != ROW_OK) {
        snprintf(why, why_bytes, "%s", status ? reason->text : row->reason.text);
        if (!status && row->status == ROW_REFUSED)
            return OUTCOME_REFUSED;
        return !status && row->status == ROW_SKIPPED && !required ? OUTCOME_SKIPPED
                                                                  : OUTCOME_FAILED;
    }
    snprintf(why, why_bytes, "%s, %s;", COUNTED(row->rays, "ray"), COUNTED(row->hits, "hit"));
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        text_append(why, why_bytes, " %s %zu", verdict_name(v), row->count[v]);
    text_append(why, why_bytes, "%s; err/E %.2f; bits %zu",
                row->judged ? "" : " (as published, counted)", row->worst_over,
                row->bit_differences);
    if (row->compiled.words > 0)
        text_append(why, why_bytes, " against %s", row->compiled.raw->name);
    if (row->moved)
        text_append(why, why_bytes, "; other bits, free, %zu", row->moved);
    if (engine_compiled_lost(&row->compiled))
        text_append(why, why_bytes,
                    "; %u of %u float operations without NoContraction, %u of open rounding",
                    row->compiled.ops - row->compiled.kept, row->compiled.ops,
                    row->compiled.foreign);
    if (row->fans_lost)
        text_append(why, why_bytes, "; lost in closed fans %zu", row->fans_lost);
    return row->differences ? OUTCOME_FAILED : OUTCOME_PASSED;
}

static void print_findings(const struct screen *screen, const struct row *row)
{
    for (size_t i = 0; i < row->finding_count; i++) {
        const struct finding *f = &row->finding[i];
        char line[512], bits[320];
        finding_line(f, line, sizeof line);
        snprintf(bits, sizeof bits, "not %s's bits", f->bits ? row->against->name : "");
        screen_record(screen, PAINT_PLAIN, "        ray %zu (%s) %s\n", f->ray_index,
                      f->bits ? bits : wrong_name(f->judgement.wrong), line);
    }
}

static void add_member(struct turnout *turnout, const char *kind, const char *name,
                       const struct row *row)
{
    if (name)
        turnout_add(turnout, kind, name, turnout_of_member(row), 1, row->reason.text);
}

static void count_turnout(struct turnout *turnout, const struct row *row)
{
    const struct match_options *o = &row->options;
    turnout_row(turnout, row);
    add_member(turnout, "tri", o->tri ? o->tri->name : NULL, row);
    if (!row->layout)
        return;
    add_member(turnout, "store", o->store ? o->store->name : tri_stores[0]->name, row);
    add_member(turnout, "builder", o->builder ? o->builder->name : NULL, row);
    add_member(turnout, "box", o->box ? o->box->name : NULL, row);
}

void conform_report_add(struct conform_report *report, const char *name, enum status status,
                        const struct row *row, const struct reason *reason, bool required,
                        double seconds)
{
    char why[512];
    struct conform_entry entry = {.name = name, .why = why, .seconds = seconds};
    bool engine_failed = status == STATUS_OK && row->status == ROW_FAILED;
    entry.outcome = decide(status, row, reason, required, why, sizeof why);
    entry.code = status ? exit_of_status(status) : engine_failed ? EXIT_ENGINE : EXIT_MISMATCH;
    enum matrix_outcome outcome = conform_report_put(report, &entry, NULL);
    report->vacuous += outcome == OUTCOME_FAILED && !status && row->status == ROW_VACUOUS;
    report->absent += outcome == OUTCOME_SKIPPED && row->absent;
    if (status == STATUS_OK)
        count_turnout(&report->turnout, row);
    report->rays += row->compared;
    for (int v = 0; v < VERDICT_WRONG; v++)
        report->count[v] += row->count[v];
    *(row->judged ? &report->count[VERDICT_WRONG] : &report->published) +=
        row->count[VERDICT_WRONG];
    if (outcome == OUTCOME_FAILED && !report->tap)
        print_findings(&report->screen, row);
}

static void judge_waivers(struct conform_report *report)
{
    for (size_t i = 0; i < report->waivers.count; i++) {
        const struct waiver *w = &report->waivers.waiver[i];
        if (w->version && w->ran > 0 && w->failed == 0)
            ask_versions(report);
        enum waiver_fault fault = waiver_judge(w, report->complete, report->versions);
        if (fault == WAIVER_FINE)
            continue;
        if (fault == WAIVER_GONE) {
            if (!report->tap && report->verbose)
                screen_record(&report->screen, PAINT_PLAIN,
                              "NOTE    %s:%zu: '%s' no longer occurs in a version other than %s\n",
                              report->waivers.path, w->line, w->pattern, w->version);
            continue;
        }
        screen_record(&report->screen, PAINT_BAD, "%s%s:%zu: waiver '%s' %s\n",
                      report->tap ? "# " : "FAILED  ", report->waivers.path, w->line, w->pattern,
                      fault == WAIVER_NOTHING ? "matches nothing: correct or remove it"
                                              : "excused no failing trial: remove it");
        report->outcomes[OUTCOME_FAILED]++;
        report->code = exit_worse(report->code, EXIT_MISMATCH);
    }
}

/* Adds one case for each named member. */
static void judge_turnout(struct conform_report *report)
{
    static const enum ci_state state[] = {[EXIT_AGREE] = CI_PASSED, [EXIT_MISMATCH] = CI_FAILED};
    if (!report->tap)
        turnout_print(&report->turnout, &report->screen);
    for (size_t i = 0; i < report->turnout.count; i++) {
        const struct turnout_one *one = &report->turnout.one[i];
        char name[TURNOUT_NAME_MOST + 40], line[512];
        int code = turnout_code(one);
        snprintf(name, sizeof name, "%s.%s.answered", one->kind, one->name);
        turnout_line(one, line, sizeof line);
        const struct ci_case is = {.group = "conform",
                                   .name = name,
                                   .state = code == EXIT_SKIPPED ? CI_SKIPPED : state[code],
                                   .type = "vacuous",
                                   .why = code == EXIT_AGREE ? NULL : line,
                                   .detail = code == EXIT_AGREE ? line : NULL};
        report->done++;
        report->outcomes[OUTCOME_FAILED] += code == EXIT_MISMATCH;
        if (report->tap)
            ci_tap_case(stdout, report->done, &is);
        if (report->junit.body)
            ci_junit_add(&report->junit, &is);
        report->code = exit_worse(report->code, code);
    }
}

/* If nothing ran, nothing is tested: skipped if the engines cannot run here, else vacuous. */
static void judge_ran(struct conform_report *report)
{
    const size_t *n = report->outcomes;
    const size_t ran = n[OUTCOME_PASSED] + n[OUTCOME_KNOWN] + n[OUTCOME_WAIVED] + n[OUTCOME_FAILED];
    if (ran > 0 || report->code != EXIT_AGREE)
        return;
    report->code = EXIT_SKIPPED;
    if (n[OUTCOME_SKIPPED] + n[OUTCOME_REFUSED] == report->absent)
        return;
    report->code = EXIT_MISMATCH;
    printf("%svacuous: nothing ran, so nothing is tested\n", report->tap ? "# " : "");
}

static void print_sums(const struct conform_report *report)
{
    const struct screen *screen = &report->screen;
    char line[512];
    snprintf(line, sizeof line, "%s judged:", COUNTED(report->rays, "ray"));
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        text_append(line, sizeof line, " %s %zu", verdict_name(v), report->count[v]);
    if (report->published)
        text_append(line, sizeof line, "; as published, counted: %zu", report->published);
    screen_record(screen, PAINT_PLAIN, "%s\n", line);
    if (report->vacuous)
        screen_record(screen, PAINT_PLAIN,
                      "%s failed for want of hits alone: --count is too small\n",
                      COUNTED(report->vacuous, "trial"));
    if (report->excused)
        screen_record(screen, PAINT_PLAIN,
                      "%s more in trials that are waived or show a known defect\n",
                      COUNTED(report->excused, "ray"));
    printf("%s in %.1f s, %zu waived", COUNTED(report->done - report->turnout.count, "trial"),
           (double)(time_ns() - report->start_ns) * 1e-9, report->outcomes[OUTCOME_WAIVED]);
    if (report->outcomes[OUTCOME_KNOWN])
        printf(", %zu show a known defect", report->outcomes[OUTCOME_KNOWN]);
    putchar('\n');
    screen_paint(screen, report->code == EXIT_AGREE     ? PAINT_GOOD
                         : report->code == EXIT_SKIPPED ? PAINT_DIM
                                                        : PAINT_BAD);
    printf("%zu passed, %zu failed, %zu skipped",
           report->outcomes[OUTCOME_PASSED] + report->outcomes[OUTCOME_KNOWN],
           report->outcomes[OUTCOME_FAILED],
           report->outcomes[OUTCOME_SKIPPED] + report->outcomes[OUTCOME_REFUSED]);
    screen_paint(screen, PAINT_PLAIN);
    putchar('\n');
}

int conform_report_close(struct conform_report *report)
{
    struct reason reason = {""};
    judge_waivers(report);
    judge_turnout(report);
    double seconds = (double)(time_ns() - report->start_ns) * 1e-9;
    if (report->junit.body) {
        enum status status = ci_junit_close(&report->junit, "raydiff conform", seconds, &reason);
        report->code = exit_worse(report->code, exit_with_reason("conform", status, &reason));
    }
    judge_ran(report);
    if (!report->tap)
        print_sums(report);
    else if (report->expected == 0)
        ci_tap_plan(stdout, report->done);
    waivers_free(&report->waivers);
    return report->code;
}

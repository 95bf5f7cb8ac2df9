/* The results of a campaign: the table, JSON, and the files for CI systems. */
#include "cmd/fuzz/cmd_fuzz_report.h"

#include "cmd/fuzz/cmd_replay.h"
#include "fuzz/play/coverage.h"
#include "fuzz/campaign/worker.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/base/json_record.h"

#include <stdio.h>

/* Classifies a finding as new, known, expired or flaky; *answer: why. */
static enum findings_report_state state_of(const struct fuzz_command *c,
                                           const struct campaign_view *view, size_t i,
                                           struct baseline_answer *answer)
{
    const struct findings_entry *entry = findings_entry(view->findings, i);
    struct baseline baseline = c->baseline; /* baseline_ask counts uses here; the list is shared */
    baseline_ask(&baseline, &entry->signature, entry->versions, c->today, answer);
    if (answer->state == BASELINE_KNOWN)
        return REPORT_KNOWN;
    if (campaign_is_flaky(&view->mark[i])) {
        snprintf(answer->text, sizeof answer->text, "did not recur in %u plays alone",
                 view->mark[i].played_again);
        return REPORT_FLAKY;
    }
    return answer->state == BASELINE_EXPIRED ? REPORT_EXPIRED : REPORT_NEW;
}

double fuzz_seconds(uint64_t ns)
{
    return (double)ns * 1e-9;
}

static double rate(uint64_t count, uint64_t ns)
{
    return ns ? (double)count / fuzz_seconds(ns) : 0;
}

bool fuzz_unused_line(const struct fuzz_command *c, const struct campaign_view *view, size_t *at,
                      char line[UNUSED_MOST])
{
    const char *path;
    const struct waiver *waiver =
        baseline_unused(&c->baseline, &view->options->rules.field, view->versions, at, &path);
    if (waiver)
        snprintf(line, UNUSED_MOST, "%.200s:%zu: '%.160s' excused nothing here", path, waiver->line,
                 waiver->pattern);
    return waiver != NULL;
}

void fuzz_describe(const struct fuzz_command *c, const struct campaign_view *view, size_t i,
                   struct finding_words *out)
{
    const struct fuzz_signature *signature = &findings_entry(view->findings, i)->signature;
    const struct fuzz_field *field = &view->options->rules.field;
    const size_t who = work_contestant(field, signature);
    out->state = state_of(c, view, i, &out->answer);
    fuzz_signature_print(signature, out->signature);
    findings_path(view->findings, signature, "first.trial", out->first, sizeof out->first);
    findings_path(view->findings, signature, "smallest.trial", out->smallest, sizeof out->smallest);
    replay_command(out->smallest, who < field->count ? field->who[who].engine : NULL,
                   signature->layout, out->replay, sizeof out->replay);
}

void fuzz_contestant_name(const struct campaign_view *view, size_t i, char name[NAME_MOST])
{
    const struct fuzz_contestant *who = &view->options->rules.field.who[i];
    snprintf(name, NAME_MOST, "%.40s%s%s", who->engine->name, who->layout ? "." : "",
             who->layout ? who->layout->name : "");
}

/* --- JSON ------------------------------------------------------------------------------------ */

static json_t *finding_json(const struct fuzz_command *c, const struct campaign_view *view,
                            size_t i, bool whole)
{
    const struct findings_entry *entry = findings_entry(view->findings, i);
    struct finding_words words;
    fuzz_describe(c, view, i, &words);
    json_t *row = json_record("signature=%s count=%zu", words.signature, entry->count);
    if (!whole)
        return row;
    json_add(row,
             "state=%s known=%i flaky=%i reason=%s cause=%s first=%s smallest=%s triangles=%u "
             "rays=%u replay=%s",
             report_state_name(words.state), words.state == REPORT_KNOWN,
             words.state == REPORT_FLAKY, words.answer.text, cause_text(entry->signature.cause),
             words.first, words.smallest, entry->smallest.triangles, entry->smallest.rays,
             words.replay);
    return row;
}

static void add_times(json_t *root, const struct campaign_view *view)
{
    const struct fuzz_field *field = &view->options->rules.field;
    const struct fuzz_time *time = &view->time;
    double ratio, share = campaign_harness_share(view, &ratio);
    json_add(root, "harness_share=%g harness_to_engines=%g", share, ratio);
    json_t *parts = json_record("generate=%g build=%g truth=%g judge=%g explain=%g",
                                fuzz_seconds(time->generate), fuzz_seconds(time->build),
                                fuzz_seconds(time->truth), fuzz_seconds(time->judge),
                                fuzz_seconds(view->explain_ns));
    for (size_t i = 0; i < field->count; i++) {
        char name[NAME_MOST];
        fuzz_contestant_name(view, i, name);
        json_add(parts, "%s=%g", name, fuzz_seconds(time->engine[i]));
    }
    json_add(root, "core_seconds=%p", parts);
}

static json_t *contestants_json(const struct campaign_view *view)
{
    json_t *out = json_array();
    for (size_t i = 0; i < view->options->rules.field.count; i++) {
        const struct campaign_turnout *turnout = &view->turnout[i];
        char name[NAME_MOST];
        fuzz_contestant_name(view, i, name);
        json_array_append_new(out,
                              json_record("name=%s answered=%zu refused=%zu with_a_right_hit=%zu "
                                          "refused_in_this_run=%zu unasked_in_this_run=%zu "
                                          "vacuous=%p",
                                          name, turnout->played, turnout->declined, turnout->proved,
                                          view->refused[i], view->unasked[i],
                                          json_text(campaign_vacuous(view, i))));
        if (campaign_loses(view, i))
            json_add(json_array_get(out, i), "loses=%s", campaign_loses(view, i));
    }
    return out;
}

static void add_coverage(json_t *root, const struct campaign_view *view)
{
    json_t *missing = json_array();
    char name[COVERAGE_NAME_MOST];
    for (uint32_t bit = 0; bit < coverage_reachable(view->options->rules.gen.worlds); bit++)
        if (coverage_name(bit, name) && !(view->coverage[bit / 64] >> bit % 64 & 1))
            json_array_append_new(missing, json_string(name));
    json_add(root, "coverage=%p",
             json_record("reached=%u known=%u never=%p", coverage_count(view->coverage),
                         coverage_reachable(view->options->rules.gen.worlds), missing));
}

static json_t *make_json(const struct fuzz_command *c, const struct campaign_view *view, bool whole)
{
    json_t *verdicts = json_object(), *findings = json_array();
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        json_add(verdicts, "%s=%zu", verdict_name((enum verdict)v), view->count[v]);
    for (size_t i = 0; i < findings_count(view->findings); i++)
        json_array_append_new(findings, finding_json(c, view, i, whole));
    json_t *root =
        json_record("raydiff=%s seed=%zu seconds=%g play_seconds=%g versions=%s dir=%s trials=%zu "
                    "trials_before=%zu corpus=%zu mutants=%zu rays=%zu judged=%zu at_fault=%zu "
                    "trials_per_s=%g judged_rays_per_s=%g triangles_mean=%g triangles_median=%u",
                    RAYDIFF_VERSION, c->seed, fuzz_seconds(view->ns), fuzz_seconds(view->play_ns),
                    view->versions, c->folder, view->trials, view->before, view->corpus,
                    view->mutants, view->rays, view->judged, view->wrong,
                    rate(view->trials, view->play_ns), rate(view->judged, view->play_ns),
                    view->trials ? (double)view->triangles / (double)view->trials : 0,
                    campaign_triangles_median(view));
    add_times(root, view);
    json_add(root, "verdicts=%p", verdicts);
    add_coverage(root, view);
    json_add(root, "pairs=%p turns=%i workers=%u restarts=%u renewed=%u contestants=%p findings=%p",
             fuzz_pairs_json(c, view), c->turns, view->options->jobs, view->restarts, view->renewed,
             contestants_json(view), findings);
    if (whole)
        json_add(root, "exit=%d", c->code);
    return root;
}

enum status fuzz_stats(const struct fuzz_command *c, const struct campaign_view *view,
                       struct reason *reason)
{
    struct file_out out;
    enum status status = folder_put(findings_folder(view->findings), "stats.json", &out, reason);
    return status ? status : json_write_out(&out, make_json(c, view, false), 6, reason);
}

/* --- the table ------------------------------------------------------------------------------- */

static void print_finding(const struct fuzz_command *c, const struct campaign_view *view, size_t i)
{
    const struct findings_entry *entry = findings_entry(view->findings, i);
    struct finding_words words;
    fuzz_describe(c, view, i, &words);
    screen_line(9, "%-7s  %s  %llu time%s, smallest: %u triangle%s, %u ray%s\n",
                report_state_name(words.state), words.signature, (unsigned long long)entry->count,
                plural(entry->count), entry->smallest.triangles, plural(entry->smallest.triangles),
                entry->smallest.rays, plural(entry->smallest.rays));
    screen_line(9, "         %s\n", cause_text(entry->signature.cause));
    if (words.answer.text[0])
        screen_line(9, "         %s\n", words.answer.text);
    printf("         %s\n", words.replay);
}

static void print_unused(const struct fuzz_command *c, const struct campaign_view *view)
{
    char line[UNUSED_MOST];
    size_t at = c->baseline.list[0].count; /* skip the shipped list: it may excuse nothing here */
    while (fuzz_unused_line(c, view, &at, line))
        screen_line(11, "unused     %s\n", line);
}

/* True if no run played a trial. */
static bool is_vacuous(const struct campaign_view *view)
{
    return view->trials + view->before == 0;
}

static size_t failed_count(const struct campaign_view *view)
{
    size_t count = 0;
    for (size_t i = 0; i < view->options->rules.field.count; i++)
        count += campaign_vacuous(view, i) || campaign_loses(view, i);
    return count;
}

/* Prints how often each contestant answered in the whole campaign. */
static void print_turnout(const struct campaign_view *view)
{
    char name[NAME_MOST];
    for (size_t i = 0; i < view->options->rules.field.count; i++) {
        const struct campaign_turnout *turnout = &view->turnout[i];
        const char *vacuous = campaign_vacuous(view, i), *loses = campaign_loses(view, i);
        char lost[MATCH_EDGES_TEXT];
        char line[1024];
        fuzz_contestant_name(view, i, name);
        snprintf(line, sizeof line, "%-10s %s answered %s, refused %llu", i ? "" : "contestant",
                 name, COUNTED(turnout->played, "trial"), (unsigned long long)turnout->declined);
        if (view->refused[i] > 0 && view->options->rules.field.who[i].layout)
            text_append(line, sizeof line, "; its layout refused %llu of this run",
                        (unsigned long long)view->refused[i]);
        if (view->options->rules.field.turn[i].of > 0 && view->unasked[i] > 0)
            text_append(line, sizeof line, "; in %s of this run it was another's turn",
                        COUNTED(view->unasked[i], "trial"));
        match_edges_text(turnout->edges, lost);
        screen_line(11, "%s%s%s%s%s\n", line, vacuous ? "; vacuous: " : "", vacuous ? vacuous : "",
                    loses ? "; lost beside edges " : "", loses ? lost : "");
    }
}

static void print_trials(const struct campaign_view *view)
{
    char line[300];
    snprintf(line, sizeof line, "trials     %llu (%.0f/s), of %.1f triangles (median %u)",
             (unsigned long long)view->trials, rate(view->trials, view->play_ns),
             view->trials ? (double)view->triangles / (double)view->trials : 0,
             campaign_triangles_median(view));
    if (view->corpus > 0)
        text_append(line, sizeof line, ", %llu of the corpus", (unsigned long long)view->corpus);
    if (view->mutants > 0)
        text_append(line, sizeof line, ", %llu mutants", (unsigned long long)view->mutants);
    if (view->before > 0)
        text_append(line, sizeof line, ", after %llu generated ones of earlier runs",
                    (unsigned long long)view->before);
    screen_line(11, "%s\n", line);
}

static void print_summary(const struct fuzz_command *c, const struct campaign_view *view)
{
    size_t flaky, news = campaign_news(view, &flaky), count = findings_count(view->findings);
    size_t left = 0;
    for (size_t i = 0; i < count; i++)
        left += !view->mark[i].shrunk && !view->mark[i].known;
    if (c->left_out[0])
        screen_line(11, "left out   %s\n", c->left_out);
    print_trials(view);
    printf("judged     %s (%.0f/s); harness %.0f %% of the time\n", COUNTED(view->judged, "ray"),
           rate(view->judged, view->play_ns), 100 * campaign_harness_share(view, NULL));
    printf("coverage   %u of %u states\n", coverage_count(view->coverage),
           coverage_reachable(view->options->rules.gen.worlds));
    fuzz_pairs_print(c, view);
    if (view->restarts > 0)
        screen_line(11, "restarts   %u; the last: %s\n", view->restarts, view->said);
    if (view->renewed > 0)
        printf("renewed    %s that held half of --memory\n", COUNTED(view->renewed, "worker"));
    if (flaky > 0)
        printf("flaky      %zu: did not recur in %u plays alone\n", flaky, CAMPAIGN_AGAIN);
    if (left > 0 && news > 0 && !view->unplayed && !view->unshrunk) {
        char command[FUZZ_PATH_MOST] = "raydiff min";
        command_word(command, sizeof command, c->folder);
        replay_plugins(view->findings, command, sizeof command);
        printf("to shrink  %zu: %s\n", left, command);
    }
    print_turnout(view);
    print_unused(c, view);
    if (view->unplayed)
        printf("unplayed   trials are left: run again to continue\n");
    else if (view->unshrunk)
        printf("unshrunk   findings are left: run again to shrink them\n");
    if (is_vacuous(view))
        printf("vacuous    no trial was played: nothing is tested\n");
    screen_line(11, "findings   %zu distinct, %zu outside the baseline, in %s\n", count, news,
                c->folder);
}

void fuzz_report(void *user, const struct campaign_view *view)
{
    struct fuzz_command *c = user;
    fuzz_show_end(c);
    c->code = campaign_news(view, NULL) > 0 || is_vacuous(view) || failed_count(view) > 0 ||
                      fuzz_pairs_short(c) > 0
                  ? EXIT_MISMATCH
                  : EXIT_AGREE;
    if ((view->unplayed || view->unshrunk) &&
        *c->signalled) /* tells a script that waits for a shard */
        c->code = 128 + *c->signalled;
    for (size_t i = 0; i < findings_count(view->findings); i++)
        print_finding(c, view, i);
    print_summary(c, view);
    fflush(stdout);
    enum status status = fuzz_stats(c, view, &c->failed);
    if (!status && c->json)
        status = json_write(c->json, make_json(c, view, true), 9, &c->failed);
    if (!status && (c->junit || c->tap || c->jsonl))
        status = fuzz_write_ci(c, view, &c->failed);
    c->failed_status = c->failed_status ? c->failed_status : status;
}

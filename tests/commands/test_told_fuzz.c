/* Numbers that raydiff fuzz tells of a campaign: no two are the same, and each is looked for beside
 * its own name, in the text, the JSON and the files for CI systems. */
#define _GNU_SOURCE /* mkdtemp, open_memstream */
#include "cmd/fuzz/cmd_fuzz.h"
#include "cmd/fuzz/cmd_fuzz_report.h"
#include "fuzz/play/coverage.h"
#include "ref/base/text.h"

#include "tests/commands/told.h"
#include "tests/support/root.h"

#include <sys/stat.h>

#define AGAIN 3

static volatile sig_atomic_t no_signal;

/* Adds a finding `times` times, on a ray more than triangles. */
static void add_findings(struct findings *findings, enum cause cause, uint32_t triangles, int times)
{
    struct finding_file file = {
        .has_signature = true,
        .signature = {.engine = "cpu",
                      .layout = layout_find("f32"),
                      .kind = (enum fuzz_kind)(FUZZ_KIND_WRONG + WRONG_MISSED),
                      .cause = cause}};
    struct findings_news news;
    struct reason reason = {""};
    assert_int_equal(fuzz_trial_make(3, triangles, triangles + 1, &file.trial, &reason), STATUS_OK);
    for (int i = 0; i < times; i++) {
        file.trial.origin = (struct fuzz_origin){.seed = 1, .index = (uint64_t)i, .version = 1};
        if (findings_add(findings, &file, 1, "", &news, &reason))
            fail_msg("%s", reason.text);
    }
    fuzz_trial_free(&file.trial);
}

static void fill_view(struct campaign_view *view)
{
    view->ns = 40000000000u;
    view->play_ns = 20000000000u;
    view->trials = 1000;
    view->corpus = 11;
    view->mutants = 12;
    view->before = 13;
    view->rays = 14;
    view->judged = 3000;
    view->wrong = 15;
    view->refitted = 16;
    view->rebuilt = 17;
    view->triangles = 18500;
    view->histogram[19] = 499;
    view->histogram[20] = 2;
    view->histogram[21] = 499;
    view->explain_ns = 22000000000u;
    view->workers = 23;
    view->restarts = 24;
    view->renewed = 25;
    view->said = "s";
    view->versions = "v";
    view->coverage[0] = 7; /* three states */
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        view->count[v] = 101 + v;
    for (size_t i = 0; i < 2; i++) {
        view->refused[i] = 201 + 10 * i;
        view->unasked[i] = 202 + 10 * i;
        view->turnout[i] = (struct campaign_turnout){
            .played = 9000 + i, .declined = 204 + 10 * i, .proved = 205 + 10 * i};
        view->time.engine[i] = (31 + i) * 1000000000u;
    }
    view->time.generate = 33000000000u;
    view->time.build = 34000000000u;
    view->time.truth = 35000000000u;
    view->time.judge = 36000000000u;
}

/* A campaign of two contestants, with findings new and flaky. */
struct told_campaign {
    struct fuzz_command command;
    struct campaign_options options;
    struct campaign_view view;
    struct campaign_mark mark[2];
};

static struct told_campaign *campaign_made(void)
{
    static struct told_campaign c;
    struct reason reason = {""};
    static int made;
    char *folder = NULL;
    c = (struct told_campaign){.command = {.seed = 41, .shards = 1, .folder = "d", .turns = true},
                               .options = {.shards = 1, .jobs = 42}};
    assert_true(asprintf(&folder, "%s/d%d", root, made++) > 0);
    struct fuzz_field *field = &c.options.rules.field;
    field->who[0] = (struct fuzz_contestant){engine_find("cpu"), layout_find("f32")};
    field->who[1] = (struct fuzz_contestant){engine_find("cpu"), layout_find("rf16")};
    field->turn[0].of = field->turn[1].of = 2;
    field->count = 2;
    c.command.campaign.rules = c.options.rules;
    c.command.signalled = &no_signal;
    for (size_t i = 0; i < 2; i++)
        list_add(&c.command.layout, TABLE_LAYOUTS, field->who[i].layout);
    c.view.options = &c.options;
    assert_int_equal(fuzz_pairs_make(&c.command, &reason), STATUS_OK);
    if (baseline_add(&c.command.baseline, "b", "", 0, &reason))
        fail_msg("%s", reason.text);
    if (findings_open(folder, &c.command.findings, &reason))
        fail_msg("%s", reason.text);
    add_findings(c.command.findings, CAUSE_SENTINEL, 7, 43);
    add_findings(c.command.findings, CAUSE_SLOT_NOT_READ, 9, 44);
    c.mark[1] = (struct campaign_mark){.played_again = AGAIN};
    c.view.findings = c.command.findings;
    c.view.mark = c.mark;
    fill_view(&c.view);
    free(folder);
    return &c;
}

static void end_campaign(struct told_campaign *c)
{
    findings_close(c->command.findings);
    baseline_close(&c->command.baseline);
    pair_coverage_close(c->command.pair_coverage);
}

static const struct told_number numbers[] = {
    {"seed", 41},
    {"seconds", 40},
    {"play_seconds", 20},
    {"trials", 1000},
    {"trials_before", 13},
    {"corpus", 11},
    {"mutants", 12},
    {"rays", 14},
    {"judged", 3000},
    {"at_fault", 15},
    {"trials_per_s", 1000 / 20.0},
    {"judged_rays_per_s", 3000 / 20.0},
    {"triangles_mean", 18500 / 1000.0},
    {"triangles_median", 20},
    {"harness_share", (33 + 34 + 35 + 36) / (33.0 + 34 + 35 + 36 + 31 + 32)},
    {"harness_to_engines", (33 + 34 + 35 + 36) / (31.0 + 32)},
    {"core_seconds.generate", 33},
    {"core_seconds.build", 34},
    {"core_seconds.truth", 35},
    {"core_seconds.judge", 36},
    {"core_seconds.explain", 22},
    {"core_seconds.cpu.f32", 31},
    {"core_seconds.cpu.rf16", 32},
    {"verdicts.right", 101},
    {"verdicts.tie", 102},
    {"verdicts.near_tie", 103},
    {"verdicts.boundary", 104},
    {"verdicts.border", 105},
    {"verdicts.in_plane", 106},
    {"verdicts.slab", 107},
    {"verdicts.noise", 108},
    {"verdicts.out_of_contract", 109},
    {"verdicts.wrong", 110},
    {"coverage.reached", 3},
    {"turns", 1},
    {"workers", 42},
    {"restarts", 24},
    {"renewed", 25},
    {"contestants.0.answered", 9000},
    {"contestants.0.refused", 204},
    {"contestants.0.with_a_right_hit", 205},
    {"contestants.0.refused_in_this_run", 201},
    {"contestants.0.unasked_in_this_run", 202},
    {"contestants.1.answered", 9001},
    {"contestants.1.refused", 214},
    {"contestants.1.with_a_right_hit", 215},
    {"contestants.1.refused_in_this_run", 211},
    {"contestants.1.unasked_in_this_run", 212},
    {"findings.0.count", 43},
    {"findings.0.known", 0},
    {"findings.0.flaky", 0},
    {"findings.0.triangles", 7},
    {"findings.0.rays", 8},
    {"findings.1.count", 44},
    {"findings.1.known", 0},
    {"findings.1.flaky", 1},
    {"findings.1.triangles", 9},
    {"findings.1.rays", 10},
    {"exit", 1},
};

static char *reported(struct told_campaign *c)
{
    told_begin(&stdout);
    fuzz_report(&c->command, &c->view);
    assert_int_equal(c->command.failed_status, STATUS_OK);
    return told_end();
}

/* Without what the pairs and the states are, which depends on the members of the program. */
static void the_json_of_a_campaign(void **state)
{
    (void)state;
    struct told_campaign *c = campaign_made();
    c->command.json = told_file();
    free(reported(c));
    json_t *json = told_file_json();
    assert_true(number_at(json, "coverage.known") == coverage_reachable(false));
    json_object_del(json_object_get(json, "coverage"), "known");
    assert_true(number_at(json, "pairs.refitted") == 16);
    assert_true(number_at(json, "pairs.rebuilt") == 17);
    json_object_del(json, "pairs");
    told_json(json, numbers, ARRAY_COUNT(numbers));
    end_campaign(c);
}

static void the_text_of_a_campaign(void **state)
{
    (void)state;
    struct told_campaign *c = campaign_made();
    char *text = reported(c), states[60];
    char *pairs = strstr(text, "pairs "), *moved = strstr(text, "moved ");
    assert_true(pairs && moved > pairs);
    memset(pairs, ' ', (size_t)(moved - pairs));
    snprintf(states, sizeof states, "coverage 3 of %u states", coverage_reachable(false));
    const char *const lines[] = {
        "triangle 0 or a stored 0 is taken",
        "cpu.f32.missed.sentinel 43 times, smallest: 7 triangles, 8 rays",
        "cpu.f32.missed.slot_not_read 44 times, smallest: 9 triangles, 10 rays",
        "did not recur in 3 plays alone",
        "trials 1000 (50/s), of 18.5 triangles (median 20), 11 of the corpus, 12 mutants, after 13 "
        "generated ones of earlier runs",
        "judged 3000 rays (150/s); harness 69 % of the time",
        states,
        "moved 16 trees refitted, 17 rebuilt",
        "restarts 24; the last: s",
        "renewed 25 workers that",
        "flaky 1: did not recur in 5 plays alone",
        "to shrink 2: ",
        "cpu.f32 answered 9000 trials, refused 204; its layout refused 201 of this run; in 202 "
        "trials of this run it was another's turn",
        "cpu.rf16 answered 9001 trials, refused 214; its layout refused 211 of this run; in 212 "
        "trials of this run it was another's turn",
        "findings 2 distinct, 1 outside the baseline, in d",
    };
    told_text(text, lines, ARRAY_COUNT(lines));
    end_campaign(c);
}

static const struct told_number line_numbers[] = {
    {"0.version", 1},
    {"0.trials", 1013},
    {"0.trials_before", 13},
    {"0.judged_rays", 3000},
    {"0.seconds", 40},
    {"0.trials_per_s", 1000 / 40.0},
    {"0.judged_rays_per_s", 3000 / 40.0},
    {"0.harness_share", 138 / 201.0},
    {"0.failures", 1},
    {"1.played", 9000},
    {"1.refused", 204},
    {"1.refused_in_this_run", 201},
    {"1.seconds", 31},
    {"2.played", 9001},
    {"2.refused", 214},
    {"2.refused_in_this_run", 211},
    {"2.seconds", 32},
    {"3.counts", 1},
    {"3.count", 43},
    {"3.triangles", 7},
    {"3.rays", 8},
    {"3.vertices", 3},
    {"4.counts", 0},
    {"4.count", 44},
    {"4.triangles", 9},
    {"4.rays", 10},
    {"4.vertices", 3},
};

static void the_lines_of_a_campaign(void **state)
{
    (void)state;
    struct told_campaign *c = campaign_made();
    char line[4000];
    c->command.jsonl = told_file();
    free(reported(c));
    json_t *lines = json_array();
    FILE *file = fopen(told_file(), "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file))
        json_array_append_new(lines, json_loads(line, 0, NULL));
    fclose(file);
    unlink(told_file());
    told_json(lines, line_numbers, ARRAY_COUNT(line_numbers));
    end_campaign(c);
}

/* What the list of known findings says comes first, then whether a finding shows again, then that a
 * line of the list has expired. */
static void the_state_of_a_finding(void **state)
{
    (void)state;
    static const char *const until[] = {NULL, "2001-01-01", "2099-12-31"};
    for (int turn = 0; turn < 36; turn++) {
        struct told_campaign *c = campaign_made();
        struct reason reason = {""};
        char list[400] = "";
        const int line[] = {turn % 3, turn / 3 % 3}, flaky[] = {turn / 9 % 2, turn / 18};
        static const char *const cause[] = {"sentinel", "slot_not_read"};
        for (size_t i = 0; i < 2; i++) {
            if (until[line[i]])
                text_append(list, sizeof list, "cpu.f32.missed.%s until %s because https://x.org\n",
                            cause[i], until[line[i]]);
            c->mark[i] = (struct campaign_mark){.played_again = AGAIN, .shown = !flaky[i]};
        }
        strcpy(c->command.today, "2030-01-01");
        if (baseline_add(&c->command.baseline, "l", list, strlen(list), &reason))
            fail_msg("%s", reason.text);
        for (size_t i = 0; i < 2; i++) {
            const char *expected = line[i] == 2 ? "known"
                                   : flaky[i]   ? "flaky"
                                   : line[i]    ? "expired"
                                                : "new";
            struct finding_words words;
            fuzz_describe(&c->command, &c->view, i, &words);
            assert_string_equal(report_state_name(words.state), expected);
            assert_int_equal(strstr(words.answer.text, "did not recur") != NULL,
                             strcmp(expected, "flaky") == 0);
        }
        end_campaign(c);
    }
}

/* A record of the numbers that could not be written is told at the end, whatever is written later:
 * the first fault, once it was there. */
static void what_was_not_written_stays_a_fault(void **state)
{
    (void)state;
    for (int plan = 0; plan < 16; plan++) {
        struct told_campaign *c = campaign_made();
        char path[200], first[sizeof c->command.failed.text] = "";
        snprintf(path, sizeof path, "%s/stats.json", findings_folder(c->view.findings)->path);
        for (int time = 0; time < 4; time++) {
            const bool is_taken = (plan >> time) % 2 == 1;
            unlink(path);
            if (is_taken)
                assert_int_equal(mkdir(path, 0700), 0);
            c->command.stats_ns = 0;
            fuzz_show(&c->command, &c->view);
            assert_int_equal(c->command.failed_status != STATUS_OK, plan % (2 << time) != 0);
            if (c->command.failed_status && !first[0])
                strcpy(first, c->command.failed.text);
            assert_string_equal(c->command.failed.text, first);
            if (is_taken)
                assert_int_equal(rmdir(path), 0);
        }
        end_campaign(c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_of_a_campaign),
        cmocka_unit_test(the_text_of_a_campaign),
        cmocka_unit_test(the_lines_of_a_campaign),
        cmocka_unit_test(the_state_of_a_finding),
        cmocka_unit_test(what_was_not_written_stays_a_fault),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}

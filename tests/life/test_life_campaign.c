/* A campaign on an engine that loses updates: each finding is kept as it is after the step that
 * shows it. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz/campaign/campaign.h"
#include "fuzz/findings/finding_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/root.h"

#include <string.h>
#include <sys/stat.h>

#define TRIALS 1500u

static struct reason reason;

/* Planted: keeps the vertices of the step before. */
static enum status stale_move(void *self, const struct job *job, struct reason *why)
{
    (void)self, (void)job, (void)why;
    return STATUS_OK;
}

static void watch(void *user, const struct campaign_view *view)
{
    (void)user, (void)view;
}

static void run(const struct engine *engine, const char *folder)
{
    const struct layout *none = NULL;
    const struct engine_options how = {.device = -1, .threads = 1};
    struct campaign_options options = {
        .folder = folder,
        .identity = "gen=test",
        .trials = TRIALS,
        .shard = 1,
        .shards = 1,
        .jobs = 1,
        .trial_ms = 5000,
        .rules = {.seed = 5, .gen = {.triangles_least = 16, .triangles_most = 64, .rays = 40}}};
    struct findings *findings;
    mkdir(folder, 0777);
    if (fuzz_field_make(&engine, 1, &none, 1, &how, &options.rules.field, &reason) ||
        findings_open(folder, &findings, &reason) ||
        campaign_run(&options, findings, watch, &reason))
        fail_msg("%s", reason.text);
    findings_close(findings);
}

static void a_finding_is_kept_with_the_step_that_shows_it(void **state)
{
    (void)state;
    static struct fuzz_result result;
    const struct engine_options how = {.device = -1, .threads = 1};
    struct engine stale = *engine_find("brute");
    const struct engine *engine = &stale;
    const struct layout *none = NULL;
    struct fuzz_field field;
    struct fuzz_player *player;
    struct findings *findings;
    char folder[200], path[600], name[FUZZ_SIGNATURE_MOST];
    uint32_t later = 0, kept = 0;
    stale.name = "stale";
    stale.move = stale_move;
    snprintf(folder, sizeof folder, "%s/found", root);
    run(&stale, folder);
    if (fuzz_field_make(&engine, 1, &none, 1, &how, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason) || findings_look(folder, &findings, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < findings_count(findings); i++) {
        struct finding_file file;
        assert_int_equal(findings_entry(findings, i)->signature.cause, CAUSE_STALE);
        fuzz_signature_print(&findings_entry(findings, i)->signature, name);
        snprintf(path, sizeof path, "%s/%s/first.trial", folder, name);
        if (finding_file_read(path, &file, &reason) ||
            fuzz_play(player, &file.trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        assert_true(file.trial.step_count > 0 && result.finding_count > 0);
        assert_int_equal(result.finding[0].step, file.trial.step_count);
        assert_int_equal(file.trial.step[file.trial.step_count - 1].act, LIFE_REFIT);
        later += file.trial.step_count > 1;
        kept++;
        finding_file_free(&file);
    }
    assert_true(kept > 2 && later > 0);
    findings_close(findings);
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_finding_is_kept_with_the_step_that_shows_it),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}

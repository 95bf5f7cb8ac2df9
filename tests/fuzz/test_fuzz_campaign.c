/* Campaigns: what a folder holds depends on the trials alone, not on workers, shards, kills or the
 * deaths of an engine. */
#define _GNU_SOURCE /* mkdtemp, asprintf */
#include "fuzz/campaign/campaign.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/played_campaigns.h"

static const char *whole; /* one worker, in one go */
static uint64_t whole_coverage[COVERAGE_WORDS];

static const char *get_whole(void) /* made once */
{
    static char path[500];
    if (whole)
        return whole;
    struct campaign_options options = options_of(in_root("whole"), false);
    assert_run(&options);
    assert_int_equal(last.trials, TRIALS);
    assert_int_equal(last.restarts, 0);
    memcpy(whole_coverage, last.coverage, sizeof whole_coverage);
    snprintf(path, sizeof path, "%s", normal(options.folder));
    return whole = path;
}

static void assert_as_whole(const char *folder)
{
    const char *expected = get_whole();
    assert_same_folders(normal(folder), expected, 1 + 3 * distinct(expected));
}

static void any_number_of_workers_finds_the_same(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("jobs2"), false);
    options.jobs = 2;
    assert_run(&options);
    assert_as_whole(options.folder);
    options = options_of(in_root("jobs5"), false);
    options.jobs = 5;
    assert_run(&options);
    assert_as_whole(options.folder);
    assert_int_equal(last.judged > 0, 1);
}

static void shards_merged_are_one_run(void **state)
{
    (void)state;
    const char *shard[8];
    char path[8][400];
    uint64_t trials = 0;
    const char *expected = get_whole();
    for (uint32_t i = 0; i < 8; i++) {
        snprintf(path[i], sizeof path[i], "%s/shard%u", root, i);
        shard[i] = path[i];
        struct campaign_options options = options_of(shard[i], false);
        options.shard = i + 1;
        options.shards = 8;
        assert_run(&options);
        trials += last.trials;
    }
    assert_int_equal(trials, TRIALS);
    assert_merge(shard, 8, in_root("shards"));
    assert_same_folders(in_root("shards"), expected, 1 + 3 * distinct(expected));
}

static void more_trials_go_on_where_it_was(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("parts"), false);
    options.trials = 3 * FUZZ_BATCH + 7; /* ends within a block */
    assert_run(&options);
    assert_int_equal(last.trials, 3 * FUZZ_BATCH + 7);
    options.trials = TRIALS;
    assert_run(&options);
    assert_int_equal(last.before, 3 * FUZZ_BATCH + 7);
    assert_int_equal(last.trials, TRIALS - 3 * FUZZ_BATCH - 7);
    assert_as_whole(options.folder);
    assert_memory_equal(last.coverage, whole_coverage, sizeof whole_coverage);
    assert_run(&options); /* all was played */
    assert_int_equal(last.trials, 0);
    assert_memory_equal(last.coverage, whole_coverage, sizeof whole_coverage);
    assert_as_whole(in_root("parts"));
}

/* --- kills ------------------------------------------------------------------------------------ */

static void run_in_child(struct child *parent, void *user)
{
    uint64_t before = 0;
    if (run(user))
        _exit(9);
    before = last.before;
    if (!child_send(parent, &before, sizeof before, 1000))
        _exit(9);
}

/* A number of its state. */
static uint64_t number_in(const char *folder, const char *name)
{
    char text[32] = "";
    struct findings *findings;
    if (findings_look(folder, &findings, &reason)) /* killed before it made the folder */
        return 0;
    (void)campaign_state_get(findings_state(findings), name, text, sizeof text);
    findings_close(findings);
    return strtoull(text, NULL, 10);
}

static void kills_lose_nothing(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("killed"), false);
    struct rng rng = rng_make(11, 4);
    uint64_t before = 0;
    uint32_t killed = 0, longest = 30; /* ms */
    options.jobs = 2;
    for (int turn = 0; turn < 20; turn++) {
        struct child child;
        assert_int_equal(child_start(run_in_child, &options, &child, &reason), STATUS_OK);
        struct child *one = &child;
        child_wait(&one, 1, 5 + rng_below(&rng, longest));
        struct child_fate fate;
        child_end(&child, 0, &fate);
        killed += fate.forced;
        uint64_t now = number_in(options.folder, "trials"); /* done for good */
        if (now == before) /* a slow machine or build needs longer to come anywhere */
            longest += longest / 2;
        before = now;
    }
    assert_true(killed >= 5);
    assert_run(&options);
    assert_int_equal(last.before, before);
    assert_true(before > 0); /* those that were killed had come somewhere */
    assert_as_whole(options.folder);
}

/* --- ends ------------------------------------------------------------------------------------- */

static bool knows_boxes(void *user, const struct findings_entry *entry)
{
    (void)user;
    return entry->signature.cause == CAUSE_CUT_BOX;
}

static bool knows_all(void *user, const struct findings_entry *entry)
{
    (void)user;
    (void)entry;
    return true;
}

static void known_findings_do_not_end_it(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("known"), false);
    options.trials = 200;
    options.until = 1;
    options.is_known = knows_all;
    assert_run(&options);
    assert_int_equal(last.trials, 200);
    assert_true(distinct(options.folder) > 3);
    assert_int_equal(last_news, 0);
}

static void one_shard_plays_the_corpus_once(void **state)
{
    (void)state;
    struct fuzz_trial corpus[3];
    const struct work_rules other = {
        .seed = 77, .gen = {.triangles_least = 16, .triangles_most = 20, .rays = 5}};
    for (uint64_t i = 0; i < 3; i++)
        assert_int_equal(work_trial_make(&other, WORK_GEN, i, NULL, &corpus[i], &reason),
                         STATUS_OK);
    for (uint32_t shard = 1; shard <= 2; shard++)
        for (uint32_t turn = 0; turn < 2; turn++) {
            struct campaign_options options =
                options_of(in_root(shard == 1 ? "corpus1" : "corpus2"), false);
            options.shard = shard;
            options.shards = 2;
            options.trials = (2 + 2 * turn) * FUZZ_BATCH;
            options.rules.corpus = corpus;
            options.rules.corpus_count = 3;
            assert_run(&options);
            assert_int_equal(last.corpus, shard == 1 && turn == 0 ? 3 : 0);
            assert_int_equal(last.trials - last.corpus, FUZZ_BATCH);
        }
    for (uint64_t i = 0; i < 3; i++)
        fuzz_trial_free(&corpus[i]);
}

static void enough_findings_end_it(void **state)
{
    (void)state;
    uint64_t trials[2];
    for (uint32_t turn = 0; turn < 2; turn++) {
        struct campaign_options options = options_of(in_root(turn ? "until3" : "until1"), false);
        options.until = 3;
        options.jobs = turn ? 3 : 1;
        options.is_known = knows_boxes;
        assert_run(&options);
        trials[turn] = last.trials;
        struct findings *findings = look(options.folder);
        size_t known = 0, count = findings_count(findings);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(marks[i].known,
                             findings_entry(findings, i)->signature.cause == CAUSE_CUT_BOX);
            known += marks[i].known;
        }
        assert_true(known > 0 && count - known >= 3);
        findings_close(findings);
    }
    assert_true(trials[0] < TRIALS);
    assert_int_equal(trials[0], trials[1]);
    const char *one = normal(in_root("until1"));
    struct findings *findings = look(one);
    assert_same_folders(one, normal(in_root("until3")), 1 + 3 * findings_count(findings));
    findings_close(findings);
}

static size_t most_to_shrink;

static void note_to_shrink(void *user, const struct campaign_view *view)
{
    (void)user;
    most_to_shrink = view->to_shrink > most_to_shrink ? view->to_shrink : most_to_shrink;
}

static void shrunk_at_the_end_they_are_the_same_again(void **state)
{
    (void)state;
    for (uint32_t turn = 0; turn < 2; turn++) {
        struct campaign_options options = options_of(in_root(turn ? "small3" : "small1"), false);
        options.trials = 100;
        options.jobs = turn ? 3 : 1;
        options.shrink = CAMPAIGN_SHRINK_AT_END;
        options.tick = note_to_shrink;
        most_to_shrink = 0;
        assert_run(&options);
        assert_true(most_to_shrink > 0);
        assert_int_equal(last.to_shrink, 0);
        most_to_shrink = 0;
        assert_run(&options); /* nothing is shrunk twice */
        assert_int_equal(most_to_shrink, 0);
    }
    const char *one = normal(in_root("small1"));
    struct findings *findings = look(one);
    size_t count = findings_count(findings), small = 0;
    for (size_t i = 0; i < count; i++)
        small += findings_entry(findings, i)->smallest.triangles <= 4;
    findings_close(findings);
    assert_true(3 * small >= 2 * count); /* the limits of a layout need more */
    assert_same_folders(one, normal(in_root("small3")), 1 + 3 * count);
}

#define BROKEN_TRIALS (6 * FUZZ_BATCH)

static volatile sig_atomic_t stop_flag;
static int stop_after;

/* The campaign asks of each finding that it has not had before: so many more, and a signal comes.
 */
static bool count_down(void *user, const struct findings_entry *entry)
{
    (void)user, (void)entry;
    if (--stop_after == 0)
        stop_flag = 1;
    return false;
}

/* Shrinking what was found so far would begin where the whole campaign does not. */
static void an_interrupted_campaign_shrinks_to_the_same(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("unbroken"), false);
    options.trials = BROKEN_TRIALS;
    options.shrink = CAMPAIGN_SHRINK_AT_END;
    assert_run(&options);
    const char *unbroken = normal(options.folder);
    uint32_t cut = 0;
    for (int after = 1; after <= 2; after++) {
        char *folder;
        assert_true(asprintf(&folder, "%s/broken%d", root, after) > 0);
        options = options_of(folder, false);
        options.trials = BROKEN_TRIALS;
        options.jobs = 2;
        options.shrink = CAMPAIGN_SHRINK_AT_END;
        options.is_known = count_down;
        options.stop = &stop_flag;
        stop_after = after;
        stop_flag = 0;
        assert_run(&options);
        cut += last.unplayed;
        assert_true(!last.unplayed || last.unshrunk);
        assert_int_equal(last.shrunk, 0);
        stop_after = 0;
        stop_flag = 0;
        assert_run(&options);
        assert_false(last.unplayed);
        assert_false(last.unshrunk);
        assert_same_folders(normal(folder), unbroken, 1 + 3 * distinct(unbroken));
        free(folder);
    }
    assert_true(cut > 0);
}

/* Time ends a run as a signal does: trials are left. */
static void a_run_that_is_not_whole_shrinks_nothing(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("timed"), false);
    options.trials = (uint64_t)1 << 40;
    options.seconds = 1;
    options.shrink = CAMPAIGN_SHRINK_AT_END;
    assert_run(&options);
    assert_true(last.unplayed && last.unshrunk);
    assert_true(last.to_shrink > 0);
    assert_int_equal(last.shrunk, 0);
}

static void states_are_reached_by_mutants_and_kept(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("mutants"), false);
    options.trials = 400;
    options.mutate = true;
    options.jobs = 2;
    assert_run(&options);
    assert_true(last.mutants > 0 && last.mutants <= last.trials / 2 + FUZZ_BATCH);
    assert_true(last.kept > 0);
    /* A finding counts once per trial, so no mutant may have the number of an earlier one. */
    uint64_t mutants = number_in(options.folder, "mut");
    assert_true(mutants > 1);
    options.trials = 500; /* the kept ones are played again, for their coverage alone */
    assert_run(&options);
    assert_true(last.kept > 0 && last.mutants > 0);
    assert_true(number_in(options.folder, "mut") > mutants);
    struct findings *findings = look(options.folder);
    for (size_t i = 0; i < findings_count(findings); i++)
        assert_true(findings_entry(findings, i)->has_first);
    findings_close(findings);
}

static void options_are_kept_in_the_state(void **state)
{
    (void)state;
    char text[64] = "", value[40], small[4];
    assert_true(campaign_state_put(text, sizeof text, "engine", "pipe:a b|c=%41"));
    assert_true(campaign_state_put(text, sizeof text, "seed", "12"));
    assert_false(campaign_state_put(text, sizeof text, "more", "a value that has no room here"));
    assert_string_equal(text, "engine=pipe:a%20b%7Cc%3D%2541|seed=12");
    assert_true(campaign_state_get(text, "engine", value, sizeof value));
    assert_string_equal(value, "pipe:a b|c=%41");
    assert_true(campaign_state_get(text, "seed", value, sizeof value));
    assert_string_equal(value, "12");
    assert_false(campaign_state_get(text, "see", value, sizeof value));
    assert_false(campaign_state_get(text, "engine", small, sizeof small));
    assert_false(campaign_state_get("", "seed", value, sizeof value));
}

/* Of 4 trials the second. */
static void medians_of_triangles_are_nearest_ranks(void **state)
{
    static struct campaign_view view = {.trials = 4, .histogram[3] = 2, .histogram[9] = 2};
    (void)state;
    assert_int_equal(campaign_triangles_median(&view), 3);
    view.histogram[9] = ++view.trials - 2;
    assert_int_equal(campaign_triangles_median(&view), 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_workers_finds_the_same),
        cmocka_unit_test(shards_merged_are_one_run),
        cmocka_unit_test(medians_of_triangles_are_nearest_ranks),
        cmocka_unit_test(more_trials_go_on_where_it_was),
        cmocka_unit_test(kills_lose_nothing),
        cmocka_unit_test(enough_findings_end_it),
        cmocka_unit_test(known_findings_do_not_end_it),
        cmocka_unit_test(one_shard_plays_the_corpus_once),
        cmocka_unit_test(shrunk_at_the_end_they_are_the_same_again),
        cmocka_unit_test(an_interrupted_campaign_shrinks_to_the_same),
        cmocka_unit_test(a_run_that_is_not_whole_shrinks_nothing),
        cmocka_unit_test(states_are_reached_by_mutants_and_kept),
        cmocka_unit_test(options_are_kept_in_the_state),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}

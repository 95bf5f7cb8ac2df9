/* Campaigns: what a folder holds depends on the trials alone, not on workers, shards, kills or the
 * deaths of an engine. */
#define _GNU_SOURCE /* mkdtemp, asprintf */
#include "fuzz/campaign.h"
#include "ref/rng.h"
#include "ref/trace.h"
#include "scenes/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/campaigns.h"

#define TRIALS 1000u

/* --- an engine that dies ---------------------------------------------------------------------- */

enum plan { PLAN_LIVE, PLAN_DIE, PLAN_HANG, PLAN_ONCE, PLAN_EAT, PLAN_NEVER_OPEN, PLAN_DIE_OPEN };
static enum plan plan;
static atomic_uint *deaths; /* shared */
static struct job given;

static enum status fragile_open(const struct engine_options *options, void **self,
                                struct reason *why)
{
    (void)options;
    *self = &given;
    if (plan == PLAN_DIE_OPEN)
        _exit(7);
    return plan == PLAN_NEVER_OPEN ? (fail)(why, STATUS_UNSUPPORTED, "not on this machine")
                                   : STATUS_OK;
}

static enum status fragile_prepare(void *self, const struct job *job, struct reason *why)
{
    (void)self;
    (void)why;
    given = *job;
    return STATUS_OK;
}

/* What the plan has for scenes of so many triangles. */
static void act(uint32_t triangles)
{
    bool now = triangles % 16 == 5;
    if (plan == PLAN_LIVE || !now || (plan == PLAN_ONCE && atomic_load(deaths) > 0))
        return;
    atomic_fetch_add(deaths, 1);
    if (plan == PLAN_HANG)
        for (;;)
            pause();
    if (plan == PLAN_EAT) {
        size_t bytes = (size_t)600 << 20;
        char *much = malloc(bytes);
        for (size_t i = 0; much && i < bytes; i += 4096)
            *(volatile char *)(much + i) = 1;
        for (;;)
            pause();
    }
    _exit(3);
}

static enum status fragile_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *why)
{
    (void)self;
    (void)report;
    (void)why;
    act(given.scene->tri_count);
    for (size_t i = 0; i < count; i++)
        if (trace_ray(given.packed, given.scene, given.box, given.tri, given.query, &ray[i],
                      &hit[i], NULL))
            return STATUS_DEVICE;
    return STATUS_OK;
}

static struct model fragile_model(void *self, const struct tri_test *tri)
{
    (void)self;
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = ROUNDING_IEEE,
                          .watertight = tri->watertight,
                          .open = tri->open};
}

static void fragile_close(void *self)
{
    (void)self;
}

static void fragile_describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    (void)options;
    snprintf(text, text_bytes, "fragile 1");
}

static const struct engine fragile = {.name = "fragile",
                                      .needs_packed = true,
                                      .open = fragile_open,
                                      .prepare = fragile_prepare,
                                      .trace = fragile_trace,
                                      .model = fragile_model,
                                      .close = fragile_close,
                                      .describe = fragile_describe};

/* --- running one ------------------------------------------------------------------------------ */

/* The last view, but what it points to. */
static struct campaign_view last;
static struct campaign_mark marks[200];

static void remember(void *user, const struct campaign_view *view)
{
    (void)user;
    last = *view;
    memcpy(marks, view->mark, findings_count(view->findings) * sizeof *marks);
}

/* Engine cpu, and the fragile one if asked, on a layout that is wrong in many ways and a right one.
 */
static struct campaign_options options_of(const char *folder, bool with_fragile)
{
    const struct engine *engine[] = {engine_find("cpu"), &fragile};
    const struct layout *layout[] = {layout_find("f32"), layout_find("rtrs_rf")};
    const struct engine_options how = {.device = -1, .threads = 1};
    struct campaign_options options = {
        .folder = folder,
        .identity = "gen=test",
        .trials = TRIALS,
        .shard = 1,
        .shards = 1,
        .jobs = 1,
        .trial_ms = 300,
        .rules = {
            .seed = 5,
            .gen = {.triangles_least = 16, .triangles_most = 64, .rays = 12, .faithful = true}}};
    if (fuzz_field_make(engine, with_fragile ? 2 : 1, layout, 2, &how, &options.rules.field,
                        &reason))
        fail_msg("%s", reason.text);
    return options;
}

static enum status run(const struct campaign_options *options)
{
    struct findings *findings;
    mkdir(options->folder, 0777);
    enum status status = findings_open(options->folder, &findings, &reason);
    if (status)
        return status;
    status = campaign_run(options, findings, remember, &reason);
    findings_close(findings);
    return status;
}

static void assert_run(const struct campaign_options *options)
{
    reason.text[0] = '\0';
    if (run(options))
        fail_msg("%s", reason.text);
}

/* Merged alone, a folder is in the form in which folders are compared. */
static const char *normal(const char *folder)
{
    static char to[8][500];
    static int next, made_normal;
    next = (next + 1) % 8;
    snprintf(to[next], sizeof to[next], "%.400s-normal%d", folder, ++made_normal);
    assert_merge(&folder, 1, to[next]);
    return to[next];
}

static const char *whole; /* one worker, in one go */

static const char *get_whole(void) /* made once */
{
    static char path[500];
    if (whole)
        return whole;
    struct campaign_options options = options_of(in_root("whole"), false);
    assert_run(&options);
    assert_int_equal(last.trials, TRIALS);
    assert_int_equal(last.restarts, 0);
    snprintf(path, sizeof path, "%s", normal(options.folder));
    return whole = path;
}

static size_t distinct(const char *folder)
{
    struct findings *findings = look(folder);
    size_t count = findings_count(findings);
    assert_true(count > 8); /* or there is nothing to compare */
    findings_close(findings);
    return count;
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
    options.trials = 3 * FUZZ_BATCH;
    assert_run(&options);
    assert_int_equal(last.trials, 3 * FUZZ_BATCH);
    options.trials = TRIALS;
    assert_run(&options);
    assert_int_equal(last.before, 3 * FUZZ_BATCH);
    assert_int_equal(last.trials, TRIALS - 3 * FUZZ_BATCH);
    assert_as_whole(options.folder);
    assert_run(&options); /* all was played */
    assert_int_equal(last.trials, 0);
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

static void kills_lose_nothing(void **state)
{
    (void)state;
    struct campaign_options options = options_of(in_root("killed"), false);
    struct rng rng = rng_make(11, 4);
    uint64_t before = 0;
    size_t killed = 0;
    options.jobs = 2;
    for (int turn = 0; turn < 20; turn++) {
        struct child child;
        assert_int_equal(child_start(run_in_child, &options, &child, &reason), STATUS_OK);
        struct child *one = &child;
        child_wait(&one, 1, 5 + rng_below(&rng, 250));
        struct child_fate fate;
        child_end(&child, 0, &fate);
        killed += fate.forced;
    }
    assert_true(killed >= 5);
    assert_run(&options);
    before = last.before;
    assert_true(before > 0); /* those that were killed had come somewhere */
    assert_as_whole(options.folder);
}

/* --- deaths ----------------------------------------------------------------------------------- */

static const struct findings_entry *find(struct findings *findings, const char *name)
{
    struct fuzz_signature signature;
    assert_int_equal(fuzz_signature_parse(name, &signature, &reason), STATUS_OK);
    return findings_find(findings, &signature);
}

/* Trials at which the fragile engine does what is planned. */
static uint64_t planned(const struct campaign_options *options)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < options->trials; i++) {
        struct fuzz_trial trial;
        assert_int_equal(work_trial_make(&options->rules, WORK_GEN, i, NULL, &trial, &reason),
                         STATUS_OK);
        count += trial.scene.tri_count % 16 == 5;
        fuzz_trial_free(&trial);
    }
    return count;
}

/* Each finding of engine cpu in `a` is in `b`, as often. */
static void assert_same_of_cpu(const char *a, const char *b)
{
    struct findings *left = look(a), *right = look(b);
    size_t compared = 0;
    for (size_t i = 0; i < findings_count(left); i++) {
        const struct findings_entry *entry = findings_entry(left, i);
        if (strcmp(entry->signature.engine, "cpu") != 0)
            continue;
        const struct findings_entry *other = findings_find(right, &entry->signature);
        assert_non_null(other);
        assert_int_equal(other->count, entry->count);
        assert_int_equal(findings_order_compare(&other->first, &entry->first), 0);
        compared++;
    }
    assert_true(compared > 5);
    findings_close(left);
    findings_close(right);
}

static void assert_said(const char *folder, const char *opinion)
{
    char *text;
    size_t size;
    char *path = join_path(folder, "findings.jsonl");
    assert_int_equal(file_read(path, &text, &size, &reason), STATUS_OK);
    if (!strstr(text, opinion))
        fail_msg("%s: nothing says '%s'", path, opinion);
    free(text);
    free(path);
}

static struct campaign_options options_of_deaths(const char *folder, uint64_t trials)
{
    struct campaign_options options = options_of(folder, true);
    options.trials = trials;
    options.memory_bytes = (uint64_t)300 << 20;
    return options;
}

static void check_deaths(enum plan what, uint64_t trials, const char *name, const char *opinion)
{
    const char *folder[2] = {in_root("deaths1"), in_root("deaths3")};
    struct campaign_options options;
    for (uint32_t turn = 0; turn < 2; turn++) {
        options = options_of_deaths(folder[turn], trials);
        options.jobs = 1 + 2 * turn;
        options.trial_ms = what == PLAN_EAT ? 30000 : options.trial_ms;
        plan = what;
        assert_run(&options);
        plan = PLAN_LIVE;
        assert_int_equal(last.trials, trials);
        assert_true(last.restarts > 0);
        struct findings *findings = look(folder[turn]);
        const struct findings_entry *entry = find(findings, name);
        if (!entry)
            fail_msg("%s was not found", name);
        assert_true(entry->count > 0);
        assert_int_equal(entry->count, planned(&options));
        findings_close(findings);
        assert_said(folder[turn], opinion);
    }
    const char *one = normal(folder[0]), *three = normal(folder[1]);
    assert_same_folders(one, three, 1 + 3 * distinct(one));
    /* The other engine is judged on every trial, also on those that killed this one. */
    options = options_of_deaths(in_root("healthy"), trials);
    assert_run(&options);
    assert_int_equal(last.restarts, 0);
    assert_same_of_cpu(in_root("healthy"), folder[0]);
    remove_folder_of(folder[0]);
    remove_folder_of(folder[1]);
    remove_folder_of(one);
    remove_folder_of(three);
    remove_folder_of(in_root("healthy"));
}

static void a_crash_is_a_finding_and_the_campaign_goes_on(void **state)
{
    (void)state;
    check_deaths(PLAN_DIE, 200, "fragile.f32.crash.unexplained", "ended itself with code 3");
}

static void a_hang_is_one(void **state)
{
    (void)state;
    check_deaths(PLAN_HANG, 40, "fragile.f32.hang.unexplained", "did not answer within 0.3 s");
}

static void too_much_memory_is_one(void **state)
{
    (void)state;
    check_deaths(PLAN_EAT, 40, "fragile.f32.crash.unexplained", "held more than 300 MiB");
}

static void what_does_not_die_again_is_flaky(void **state)
{
    (void)state;
    const char *name = "fragile.f32.crash.not_repeatable";
    struct campaign_options options = options_of_deaths(in_root("once"), 200);
    atomic_store(deaths, 0);
    plan = PLAN_ONCE;
    assert_run(&options);
    plan = PLAN_LIVE;
    assert_int_equal(atomic_load(deaths), 1);
    assert_int_equal(last.restarts, 1);
    struct findings *findings = look(options.folder);
    const struct findings_entry *entry = find(findings, name);
    assert_non_null(entry);
    assert_int_equal(entry->count, 1);
    size_t at = 0;
    while (findings_entry(findings, at) != entry)
        at++;
    assert_int_equal(marks[at].played_again, CAMPAIGN_AGAIN);
    assert_int_equal(marks[at].shown, 0);
    assert_true(campaign_is_flaky(&marks[at]));
    findings_close(findings);
}

static void an_engine_that_does_not_open_is_an_error(void **state)
{
    (void)state;
    struct campaign_options options = options_of_deaths(in_root("closed"), 40);
    plan = PLAN_NEVER_OPEN;
    assert_int_equal(run(&options), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "not on this machine");
    plan = PLAN_DIE_OPEN;
    assert_int_equal(run(&options), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "opening the engines: a worker ended itself with code 7"));
    plan = PLAN_LIVE;
}

/* --- ends ------------------------------------------------------------------------------------- */

static bool knows_boxes(void *user, const struct findings_entry *entry)
{
    (void)user;
    return entry->signature.cause == CAUSE_CUT_BOX;
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

static void shrunk_at_the_end_they_are_the_same_again(void **state)
{
    (void)state;
    for (uint32_t turn = 0; turn < 2; turn++) {
        struct campaign_options options = options_of(in_root(turn ? "small3" : "small1"), false);
        options.trials = 100;
        options.jobs = turn ? 3 : 1;
        options.shrink = CAMPAIGN_SHRINK_AT_END;
        assert_run(&options);
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
    options.trials = 500; /* the kept ones are played again, for their coverage alone */
    assert_run(&options);
    assert_true(last.kept > 0);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_workers_finds_the_same),
        cmocka_unit_test(shards_merged_are_one_run),
        cmocka_unit_test(more_trials_go_on_where_it_was),
        cmocka_unit_test(kills_lose_nothing),
        cmocka_unit_test(a_crash_is_a_finding_and_the_campaign_goes_on),
        cmocka_unit_test(a_hang_is_one),
        cmocka_unit_test(too_much_memory_is_one),
        cmocka_unit_test(what_does_not_die_again_is_flaky),
        cmocka_unit_test(an_engine_that_does_not_open_is_an_error),
        cmocka_unit_test(enough_findings_end_it),
        cmocka_unit_test(shrunk_at_the_end_they_are_the_same_again),
        cmocka_unit_test(states_are_reached_by_mutants_and_kept),
        cmocka_unit_test(options_are_kept_in_the_state),
    };
    deaths = child_share(sizeof *deaths);
    int failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    child_unshare(deaths, sizeof *deaths);
    return failed;
}

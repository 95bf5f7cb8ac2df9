/* Campaigns on an engine that crashes, hangs, takes all memory or does not open; and on findings of
 * which smaller trials come. */
#define _GNU_SOURCE /* mkdtemp, asprintf */
#include "fuzz/campaign/campaign.h"
#include "ref/outside/child.h"
#include "fuzz/play/trial_tree.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/files/file.h"

#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/played_campaigns.h"

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
        struct bvh bvh; /* the published builder refuses some scenes: no engine runs then */
        bool has_tree = fuzz_trial_build(&trial, &bvh, &reason) == STATUS_OK;
        count += has_tree && trial.scene.tri_count % 16 == 5;
        bvh_free(&bvh);
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
    assert_true(compared > 2);
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
    return options;
}

static void check_deaths(enum plan what, uint64_t trials, const char *name, const char *opinion)
{
    const char *folder[2] = {in_root("deaths1"), in_root("deaths3")};
    struct campaign_options options;
    for (uint32_t turn = 0; turn < 2; turn++) {
        options = options_of_deaths(folder[turn], trials);
        options.jobs = 1 + 2 * turn;
        if (what == PLAN_EAT) { /* else none: AddressSanitizer keeps what was freed before */
            options.memory_bytes = (uint64_t)300 << 20;
            options.trial_ms = 30000;
        }
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
    assert_int_equal(remove_tree(folder[0]), 0);
    assert_int_equal(remove_tree(folder[1]), 0);
    assert_int_equal(remove_tree(one), 0);
    assert_int_equal(remove_tree(three), 0);
    assert_int_equal(remove_tree(in_root("healthy")), 0);
}

static void a_crash_is_a_finding_and_the_campaign_goes_on(void **state)
{
    (void)state;
    check_deaths(PLAN_DIE, 200, "fragile.f32.crash.unexplained", "ended itself with code 3");
}

/* The most trials at which something is planned only twice: each hang takes its time. */
static uint64_t planned_twice(void)
{
    struct campaign_options options = options_of_deaths(root, 16);
    while (planned(&options) <= 2)
        options.trials++;
    return options.trials - 1;
}

static void a_hang_is_one(void **state)
{
    (void)state;
    check_deaths(PLAN_HANG, planned_twice(), "fragile.f32.hang.unexplained",
                 "did not answer within 0.5 s");
}

static void too_much_memory_is_one(void **state)
{
    (void)state;
    check_deaths(PLAN_EAT, planned_twice(), "fragile.f32.crash.unexplained",
                 "held more than 300 MiB");
}

static void check_flaky(enum plan what, const char *folder, const char *name)
{
    struct campaign_options options = options_of_deaths(folder, 200);
    atomic_store(deaths, 0);
    plan = what;
    assert_run(&options);
    plan = PLAN_LIVE;
    assert_int_equal(atomic_load(deaths), 1);
    assert_int_equal(last.restarts, what == PLAN_ONCE);
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
    assert_int_equal(last_flaky, 1);
    assert_int_equal(last_news, findings_count(findings) - 1);
    findings_close(findings);
}

static void what_does_not_die_again_is_flaky(void **state)
{
    (void)state;
    check_flaky(PLAN_ONCE, in_root("once"), "fragile.f32.crash.not_repeatable");
}

/* Also where another layout of the same engine is wrong every time. */
static void what_is_not_wrong_again_is_flaky(void **state)
{
    (void)state;
    check_flaky(PLAN_MISS_ONCE, in_root("wrong_once"), "fragile.f32.missed.not_repeatable");
}

static bool knows_what_is_wrong(void *user, const struct findings_entry *entry)
{
    (void)user;
    return entry->signature.kind != FUZZ_KIND_CRASH;
}

/* Neither what is flaky nor what is known is one of the findings after which a campaign ends. */
static void what_is_flaky_does_not_end_it(void **state)
{
    (void)state;
    struct campaign_options options = options_of_deaths(in_root("not_enough"), 200);
    options.until = 1;
    options.is_known = knows_what_is_wrong;
    atomic_store(deaths, 0);
    plan = PLAN_ONCE;
    assert_run(&options);
    plan = PLAN_LIVE;
    assert_int_equal(atomic_load(deaths), 1);
    assert_int_equal(last.trials, 200);
    assert_int_equal(last_news, 0);
    assert_int_equal(last_flaky, 1);
}

/* Alone and beside others; the trials that it was at are played as if nothing had been. */
static void a_stopped_worker_is_replaced(void **state)
{
    (void)state;
    for (uint32_t jobs = 1; jobs <= 3; jobs += 2) {
        const char *folder[2] = {in_root("stopped"), in_root("undisturbed")};
        for (int turn = 0; turn < 2; turn++) {
            struct campaign_options options = options_of_deaths(folder[turn], 200);
            options.jobs = jobs;
            atomic_store(deaths, 0);
            plan = turn == 0 ? PLAN_STOP_ONCE : PLAN_LIVE;
            alarm(60); /* waiting without end is not */
            assert_run(&options);
            alarm(0);
            plan = PLAN_LIVE;
            assert_int_equal(atomic_load(deaths), turn == 0);
            assert_int_equal(last.restarts, turn == 0);
            assert_int_equal(last.trials, 200);
        }
        const char *one = normal(folder[0]), *other = normal(folder[1]);
        assert_same_folders(one, other, 1 + 3 * distinct(one));
        assert_int_equal(remove_tree(folder[0]), 0);
        assert_int_equal(remove_tree(folder[1]), 0);
        assert_int_equal(remove_tree(one), 0);
        assert_int_equal(remove_tree(other), 0);
    }
}

static void what_stops_every_worker_ends_the_campaign(void **state)
{
    (void)state;
    struct campaign_options options = options_of_deaths(in_root("stops"), 200);
    atomic_store(deaths, 0);
    plan = PLAN_STOP;
    alarm(60);
    assert_int_equal(run(&options), STATUS_DEVICE);
    alarm(0);
    plan = PLAN_LIVE;
    assert_int_equal(atomic_load(deaths), 3);
    assert_non_null(strstr(reason.text, "3 workers in a row were stopped"));
    assert_non_null(strstr(reason.text, "engine fragile"));
    struct findings *findings = look(options.folder);
    for (size_t i = 0; i < findings_count(findings); i++)
        assert_string_not_equal(findings_entry(findings, i)->signature.engine, "fragile");
    findings_close(findings);
}

static void spin(struct child *parent, void *user)
{
    (void)parent, (void)user;
    for (volatile uint64_t i = 0;; i++)
        ;
}

/* RIVALS others want the one processor: what takes 60 ms of it lasts twice as long as the first
 * trials may, which have six times the limit. */
#define RIVALS     31
#define WAITING_MS 150
_Static_assert(PLAN_WORK_MS *(RIVALS + 1) > 2 * 6 * WAITING_MS,
               "else the wait is within the limit");
static void waiting_for_a_processor_is_no_hang(void **state)
{
    (void)state;
    struct campaign_options options = options_of_deaths(in_root("busy"), planned_twice());
    options.trial_ms = WAITING_MS;
    cpu_set_t all, one;
    struct child rival[RIVALS];
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    for (int i = 0, found = 0; i < CPU_SETSIZE && !found; i++)
        if ((found = CPU_ISSET((size_t)i, &all)))
            CPU_SET((size_t)i, &one);
    assert_int_equal(planned(&options), 2);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    for (size_t i = 0; i < RIVALS; i++)
        assert_int_equal(child_start(spin, NULL, &rival[i], &reason), STATUS_OK);
    plan = PLAN_WORK;
    enum status status = run(&options);
    plan = PLAN_LIVE;
    for (size_t i = 0; i < RIVALS; i++)
        child_end(&rival[i], 0, NULL);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(last.trials, options.trials);
    assert_int_equal(last.restarts, 0);
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

/* --- smaller trials --------------------------------------------------------------------------- */

/* Writes into a folder that all of its findings are shrunk, as of a campaign whose shrinking made
 * none smaller; returns how many there are. */
static size_t all_are_shrunk(const char *folder, uint64_t hash[])
{
    struct findings *findings;
    char state[FINDINGS_STATE_MOST];
    assert_int_equal(findings_open(folder, &findings, &reason), STATUS_OK);
    const size_t count = findings_count(findings);
    strcpy(state, findings_state(findings));
    char *digit = strstr(state, "|shrunk=");
    assert_non_null(digit);
    digit += strlen("|shrunk=");
    assert_int_equal(strspn(digit, "0"), count);
    memset(digit, '1', count);
    for (size_t i = 0; i < count; i++)
        hash[i] = findings_entry(findings, i)->smallest.hash;
    assert_int_equal(findings_checkpoint(findings, state, &reason), STATUS_OK);
    findings_close(findings);
    return count;
}

/* What has a smaller trial is to be shrunk again, and nothing else. */
static void a_smaller_trial_is_not_shrunk(void **state)
{
    (void)state;
    uint64_t hash[ARRAY_COUNT(marks)];
    struct campaign_options options = options_of(in_root("smaller"), false);
    options.trials = 3 * FUZZ_BATCH;
    assert_run(&options);
    const size_t count = all_are_shrunk(options.folder, hash);
    options.trials = 30 * FUZZ_BATCH;
    assert_run(&options);
    struct findings *findings = look(options.folder);
    size_t same = 0;
    assert_true(findings_count(findings) > count);
    for (size_t i = 0; i < findings_count(findings); i++) {
        const bool is_same = i < count && findings_entry(findings, i)->smallest.hash == hash[i];
        assert_int_equal(marks[i].shrunk, is_same);
        same += is_same;
    }
    assert_true(same > 0 && same < count);
    assert_int_equal(last.shrunk, same);
    findings_close(findings);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_crash_is_a_finding_and_the_campaign_goes_on),
        cmocka_unit_test(a_hang_is_one),
        cmocka_unit_test(too_much_memory_is_one),
        cmocka_unit_test(what_does_not_die_again_is_flaky),
        cmocka_unit_test(what_is_not_wrong_again_is_flaky),
        cmocka_unit_test(what_is_flaky_does_not_end_it),
        cmocka_unit_test(a_stopped_worker_is_replaced),
        cmocka_unit_test(what_stops_every_worker_ends_the_campaign),
        cmocka_unit_test(waiting_for_a_processor_is_no_hang),
        cmocka_unit_test(an_engine_that_does_not_open_is_an_error),
        cmocka_unit_test(a_smaller_trial_is_not_shrunk),
    };
    deaths = child_share(sizeof *deaths);
    int failed = cmocka_run_group_tests(tests, make_root, remove_root);
    child_unshare(deaths, sizeof *deaths);
    return failed;
}

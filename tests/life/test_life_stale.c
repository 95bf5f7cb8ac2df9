/* Laws of what steps bring about: an engine that is right when it is prepared anew is stale, and no
 * other one is, whether it has taken steps or not. */
#include "fuzz/findings/finding_file.h"
#include "fuzz/play/player.h"
#include "ref/explain/judged.h"

#include "tests/life/lived_match.h"
#include "tests/support/fuzz_trials.h"

static const struct engine *brute;
static struct pool pool = {.options = {.device = -1, .threads = 1}};

/* Planted: keeps the vertices of the step before. */
static enum status stale_move(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)job, (void)reason;
    return STATUS_OK;
}

/* Planted: loses the hits of a triangle in three, at every step alike. */
static enum status lossy_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                               struct trace_report *report, struct reason *reason)
{
    enum status status = brute->trace(self, ray, count, hit, report, reason);
    for (size_t i = 0; i < count && !status; i++)
        if (hit[i].prim != ABI_NO_PRIM && hit[i].prim % 3 == 0)
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    return status;
}

static struct engine engine_of(const char *name, bool stale, bool lossy)
{
    struct engine engine = *brute;
    engine.name = name;
    engine.move = stale ? stale_move : NULL;
    engine.trace = lossy ? lossy_trace : brute->trace;
    engine.trace_tasks = NULL;
    return engine;
}

/* How many of the causes of findings in trials with these steps are `stale`, and how many not. */
static void causes_of(const struct engine *engine, const char *steps, size_t *stale, size_t *other)
{
    static struct fuzz_result result;
    static const struct engine_options options = {.device = -1, .threads = 1};
    const struct layout *none = NULL;
    struct fuzz_field field;
    struct fuzz_player *player;
    struct reason reason = {""};
    *stale = *other = 0;
    if (fuzz_field_make(&engine, 1, &none, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    for (uint64_t index = 0; index < 12; index++) {
        struct fuzz_trial trial;
        trial_make(9, index, 8, 30, 60, &trial);
        if (steps[0] && steps_parse(steps, trial.step, &trial.step_count, &reason))
            fail_msg("%s", reason.text);
        if (fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        for (size_t i = 0; i < result.finding_count; i++) {
            if (fuzz_explain(player, &trial, &result.finding[i], &reason))
                fail_msg("%s", reason.text);
            *(result.finding[i].signature.cause == CAUSE_STALE ? stale : other) += 1;
        }
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
}

static void a_finding_that_needs_steps_is_stale(void **state)
{
    (void)state;
    size_t stale, other;
    const struct engine forgets = engine_of("forgets", true, false);
    causes_of(&forgets, "refit:jitter:2", &stale, &other);
    assert_true(stale > 8 && other == 0);
    causes_of(&forgets, "rebuild:mirror,refit:one:3,refit:jitter:1", &stale, &other);
    assert_true(stale > 8 && other == 0);
    causes_of(&forgets, "rebuild:jitter:2", &stale, &other);
    assert_true(stale == 0 && other == 0); /* it updates after refits alone */
}

static void one_that_needs_none_is_not(void **state)
{
    (void)state;
    size_t stale, other;
    const struct engine loses = engine_of("loses", false, true);
    causes_of(&loses, "", &stale, &other);
    assert_true(stale == 0 && other > 4);
    causes_of(&loses, "refit:jitter:2", &stale, &other);
    assert_true(stale == 0 && other > 4);
}

static void a_row_says_what_is_wrong_when_prepared_anew(void **state)
{
    (void)state;
    struct lived lived = lived_make("soup:n=60", "refit:jitter:1");
    static struct engine forgets, loses, both; /* the pool closes them at the end */
    forgets = engine_of("forgets", true, false);
    loses = engine_of("loses", false, true);
    both = engine_of("both", true, true);
    const struct row stale = lived_row(&lived, &forgets, NULL, NULL, &pool),
                     wrong = lived_row(&lived, &loses, NULL, NULL, &pool),
                     mixed = lived_row(&lived, &both, NULL, NULL, &pool),
                     right = lived_row(&lived, brute, NULL, NULL, &pool);
    assert_true(stale.count[VERDICT_WRONG] > 20 && stale.life.again);
    assert_int_equal(stale.life.wrong_again, 0);
    assert_true(wrong.count[VERDICT_WRONG] > 20 && wrong.life.again);
    assert_int_equal(wrong.life.wrong_again, wrong.count[VERDICT_WRONG]);
    assert_true(mixed.life.again && mixed.count[VERDICT_WRONG] > wrong.count[VERDICT_WRONG]);
    assert_int_equal(mixed.life.wrong_again, wrong.count[VERDICT_WRONG]);
    assert_int_equal(right.count[VERDICT_WRONG], 0);
    assert_false(right.life.again);
    lived_free(&lived);
}

/* Planted: what it does at the moment. */
static enum { HONEST, PHANTOM, BY_TURNS, BROKEN } mood;
static uint32_t traces;

static enum status wavering_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                  struct trace_report *report, struct reason *reason)
{
    if (mood == BROKEN)
        return (fail)(reason, STATUS_DEVICE, "as planned");
    enum status status = brute->trace(self, ray, count, hit, report, reason);
    const bool lies = mood == PHANTOM || (mood == BY_TURNS && traces++ % 2 == 0);
    for (size_t i = 0; i < count && !status && lies; i++)
        hit[i] = (struct hit){.t = 1};
    return status;
}

/* The cause of an answer that was given in one mood, after the engine is opened in another. */
static enum cause cause_after(const struct engine *engine, const struct ray *ray, int then, int now)
{
    static const struct engine_options options = {.device = -1, .threads = 1};
    struct lived lived = lived_make("soup:n=30", "");
    const struct job job = {
        .scene = &lived.first, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_CLOSEST};
    struct judged_job from = {.engine = engine, .job = &job};
    struct oracle *oracle;
    struct judged judged;
    struct judged_ray out;
    struct reason reason = {""};
    mood = HONEST;
    if (oracle_make(&lived.first, &oracle, &reason) ||
        engine_open(engine, &options, &from.self, &reason) ||
        engine->prepare(from.self, &job, &reason))
        fail_msg("%s", reason.text);
    from.oracle = oracle;
    mood = then;
    traces = 0;
    if (judged_make(&from, &judged, &reason) || judged_explain(&judged, ray, &out, &reason))
        fail_msg("%s", reason.text);
    mood = now;
    assert_int_equal(judged_stale(&judged, &options, &out, &reason), STATUS_OK);
    const enum cause cause = out.why.cause;
    explain_free(&out.why);
    judged_free(&judged);
    engine->close(from.self);
    oracle_free(oracle);
    lived_free(&lived);
    return cause;
}

/* Stale is what is wrong, the same each time, and right once the engine is opened anew. One that
 * then answers nothing is not right, though nothing is hit. */
static void only_what_is_right_anew_is_stale(void **state)
{
    (void)state;
    struct engine engine = engine_of("wavers", false, false);
    const struct ray away = {.org = {0, 0, 99}, .dir = {0, 0, 1}, .tmax = INFINITY};
    engine.trace = wavering_trace;
    assert_int_equal(cause_after(&engine, &away, HONEST, HONEST), CAUSE_NONE);
    assert_int_equal(cause_after(&engine, &away, PHANTOM, HONEST), CAUSE_STALE);
    assert_int_not_equal(cause_after(&engine, &away, PHANTOM, PHANTOM), CAUSE_STALE);
    assert_int_not_equal(cause_after(&engine, &away, PHANTOM, BROKEN), CAUSE_STALE);
    assert_int_equal(cause_after(&engine, &away, BY_TURNS, HONEST), CAUSE_NOT_REPEATABLE);
    assert_int_equal(cause_after(&engine, &away, BROKEN, HONEST), CAUSE_STALE);
}

/* Planted: misses everything once, when it has been asked so often. */
static int until_miss;

static enum status once_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                              struct trace_report *report, struct reason *reason)
{
    enum status status = brute->trace(self, ray, count, hit, report, reason);
    for (size_t i = 0; i < count && until_miss == 1; i++)
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    until_miss -= until_miss > 0;
    return status;
}

/* What is right when it is asked again is not repeatable, in trials with steps, too: that it is
 * right when it is prepared anew tells nothing. */
static void what_is_wrong_once_is_not_stale(void **state)
{
    (void)state;
    static const char *const steps[] = {"", "refit:jitter:2", "rebuild:mirror,refit:one:3"};
    static const struct engine_options options = {.device = -1, .threads = 1};
    static struct fuzz_result result;
    struct engine once = engine_of("once", false, false);
    const struct engine *const engine = &once;
    const struct layout *none = NULL;
    struct fuzz_field field;
    struct fuzz_player *player;
    struct reason reason = {""};
    size_t found = 0, after_steps = 0;
    once.trace = once_trace;
    if (fuzz_field_make(&engine, 1, &none, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < 36; i++) {
        struct fuzz_trial trial;
        trial_make(9, i, 8, 30, 60, &trial);
        if (steps[i % 3][0] && steps_parse(steps[i % 3], trial.step, &trial.step_count, &reason))
            fail_msg("%s", reason.text);
        until_miss = 1 + (int)(i / 3 % 6); /* after which step: as the player goes */
        if (fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        until_miss = 0;
        for (size_t k = 0; k < result.finding_count; k++, found++) {
            if (fuzz_explain(player, &trial, &result.finding[k], &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(result.finding[k].signature.cause, CAUSE_NOT_REPEATABLE);
            after_steps += result.finding[k].step > 0;
        }
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
    if (found < 8 || after_steps < 4)
        fail_msg("%zu, %zu after steps", found, after_steps);
}

static int close_pool(void **state)
{
    (void)state;
    pool_free(&pool);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_finding_that_needs_steps_is_stale),
        cmocka_unit_test(one_that_needs_none_is_not),
        cmocka_unit_test(only_what_is_right_anew_is_stale),
        cmocka_unit_test(what_is_wrong_once_is_not_stale),
        cmocka_unit_test(a_row_says_what_is_wrong_when_prepared_anew),
    };
    brute = engine_find("brute");
    return cmocka_run_group_tests(tests, NULL, close_pool);
}

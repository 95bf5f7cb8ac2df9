/* Laws of fuzz/play/player.h: playing many trials at once is playing each alone in a match, and
 * what an engine does wrong is found, whatever it is. */
#include "fuzz/play/coverage.h"
#include "ref/match/match.h"
#include "ref/trace/trace.h"

#include "tests/support/fuzz_trials.h"

#define TRIALS 40u
#define RAYS   200u

static const char *const engine_names[] = {"cpu", "vulkan", "embree_robust"};
static const char *const layout_names[] = {"f32", "rf16"};

/* The engines of the list that can run here. */
static size_t runnable(const struct engine **engine)
{
    size_t count = 0;
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++) {
        const struct engine_options options = {.device = -1, .threads = 1};
        struct reason reason;
        void *self;
        const struct engine *one = engine_find(engine_names[i]);
        if (engine_open(one, &options, &self, &reason))
            continue;
        one->close(self);
        engine[count++] = one;
    }
    return count;
}

static struct fuzz_player *open_player(const struct engine *const *engine, size_t count,
                                       struct fuzz_field *field)
{
    const struct engine_options options = {.device = -1, .threads = 1};
    const struct layout *layout[ARRAY_COUNT(layout_names)];
    struct fuzz_player *player = NULL;
    struct reason reason;
    for (size_t i = 0; i < ARRAY_COUNT(layout); i++)
        layout[i] = layout_find(layout_names[i]);
    if (fuzz_field_make(engine, count, layout, ARRAY_COUNT(layout), &options, field, &reason) ||
        fuzz_player_open(field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

/* What matches say of a trial, summed over the contestants. */
static void play_match(const struct fuzz_trial *trial, const struct fuzz_field *field,
                       struct pool *pool, size_t *verdicts)
{
    struct match_options options = {.builder = trial->builder,
                                    .build = trial->build,
                                    .box = trial->box,
                                    .tri = trial->tri,
                                    .query = trial->query,
                                    .repeats = 1};
    struct match match;
    struct reason reason;
    if (match_make(&trial->scene, trial->ray, trial->ray_count, &options, pool, &match, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < field->count; i++) {
        struct row row;
        if (field->who[i].layout)
            assert_int_equal(match_pack(&match, field->who[i].layout, &reason), STATUS_OK);
        match_run(&match, field->who[i].engine, &row);
        assert_true(row.status == ROW_OK || row.status == ROW_VACUOUS);
        for (int v = 0; v < VERDICT_COUNT; v++)
            verdicts[v] += row.count[v];
    }
    match_free(&match);
}

static void many_at_once_have_the_verdicts_of_matches(void **state)
{
    (void)state;
    const struct engine *engine[ARRAY_COUNT(engine_names)];
    struct fuzz_field field;
    struct fuzz_player *player = open_player(engine, runnable(engine), &field);
    struct pool pool = {.options = field.options};
    struct fuzz_trial trial[TRIALS];
    static struct fuzz_result result[TRIALS];
    struct fuzz_time time = {0};
    struct fuzz_mark mark;
    struct reason reason;
    size_t other = 0, judged = 0;
    for (size_t i = 0; i < TRIALS; i++)
        trial_make(1, i, 1, 64, RAYS, &trial[i]);
    if (fuzz_play(player, trial, TRIALS, result, &time, &mark, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(mark.contestant, FUZZ_CONTESTANTS_MOST);
    for (size_t i = 0; i < TRIALS; i++) {
        size_t verdicts[VERDICT_COUNT] = {0};
        play_match(&trial[i], &field, &pool, verdicts);
        for (int v = 0; v < VERDICT_COUNT; v++)
            assert_int_equal(result[i].count[v], verdicts[v]);
        assert_int_equal(result[i].wrong, 0);
        assert_int_equal(result[i].refused, 0);
        assert_int_equal(result[i].finding_count, 0);
        assert_true(coverage_count(result[i].coverage) > 10);
        other += field.count * RAYS - result[i].count[VERDICT_RIGHT];
        judged += result[i].judged;
        fuzz_trial_free(&trial[i]);
    }
    assert_true(other > 100); /* the trials are not all easy */
    assert_int_equal(judged, TRIALS * RAYS);
    for (size_t i = 0; i < field.count; i++)
        assert_true(time.engine[i] > 0);
    assert_true(time.build > 0 && time.truth > 0 && time.judge > 0);
    fuzz_player_close(player);
    pool_free(&pool);
}

/* --- engines made to be wrong --- */

enum player_plan { PLAN_MISS, PLAN_BITS, PLAN_UNFINISHED, PLAN_DEAD, PLAN_REFUSES, PLAN_NONSENSE };
static enum player_plan plan;
static bool dead;
static struct job planned;
static size_t opened;
#define AT 7u /* the ray at which */

static enum status planned_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &planned;
    dead = false;
    opened++;
    return STATUS_OK;
}

static enum status planned_prepare(void *self, const struct job *job, struct reason *reason)
{
    (void)self;
    planned = *job;
    if (dead)
        return (fail)(reason, STATUS_DEVICE, "dead");
    if (plan == PLAN_REFUSES && job->scene->tri_count > 0)
        return (fail)(reason, STATUS_UNSUPPORTED, "no");
    return STATUS_OK;
}

static const struct ray *victim;

static enum status planned_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *reason)
{
    (void)self, (void)report;
    for (size_t i = 0; i < count; i++) {
        bool at = memcmp(&ray[i], victim, sizeof *ray) == 0;
        if (trace_ray(&(struct job){.scene = planned.scene,
                                    .packed = planned.packed,
                                    .box = planned.box,
                                    .tri = planned.tri,
                                    .query = planned.query},
                      &ray[i], &hit[i], NULL))
            return STATUS_DEVICE;
        if (at && plan == PLAN_MISS)
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        if (at && plan == PLAN_BITS)
            hit[i].u = float_from_bits(float_bits(hit[i].u) ^ 1u);
        dead = dead || (at && plan == PLAN_DEAD);
        if (dead || (at && plan == PLAN_UNFINISHED))
            return (fail)(reason, STATUS_DEVICE, "a ray was not finished");
        if (at && plan == PLAN_NONSENSE)
            return (fail)(reason, STATUS_INPUT, "nonsense");
    }
    return STATUS_OK;
}

static struct model planned_model(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    (void)engine, (void)self;
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = ROUNDING_IEEE,
                          .bits = true,
                          .watertight = tri->watertight,
                          .open = tri->open};
}

static void planned_close(void *self)
{
    (void)self;
}

static const struct engine planned_engine = {.name = "planned",
                                             .needs_packed = true,
                                             .open = planned_open,
                                             .prepare = planned_prepare,
                                             .trace = planned_trace,
                                             .model = planned_model,
                                             .close = planned_close};

/* Plays three trials, the second of which has the ray at which it happens; returns its result. */
static struct fuzz_result play_planned(enum player_plan what, struct fuzz_finding *explained)
{
    const struct engine *engine[] = {&planned_engine};
    struct fuzz_field field;
    struct fuzz_trial trial[3];
    struct fuzz_result result[3];
    struct reason reason;
    plan = what;
    opened = 0;
    struct fuzz_player *player = open_player(engine, 1, &field);
    for (size_t i = 0; i < ARRAY_COUNT(trial); i++)
        trial_make(2, i, 16, 16, 20, &trial[i]);
    trial[1].query = QUERY_CLOSEST;
    /* Straight at a triangle's middle: no boundary excuses it. */
    float v[3][3];
    struct ray *ray = &trial[1].ray[AT];
    scene_tri(&trial[1].scene, 3, v);
    for (int k = 0; k < 3; k++) {
        float middle = (v[0][k] + v[1][k] + v[2][k]) / 3.0f;
        ray->org[k] = 9.0f + (float)k;
        ray->dir[k] = middle - ray->org[k];
    }
    ray->tmax = 1e30f;
    victim = ray;
    if (fuzz_play(player, trial, 3, result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(result[0].finding_count, what == PLAN_REFUSES ? 2 : 0);
    assert_int_equal(result[2].finding_count, what == PLAN_REFUSES ? 2 : 0);
    assert_true(result[1].finding_count >= 1);
    *explained = result[1].finding[0];
    if (what != PLAN_REFUSES)
        assert_int_equal(explained->ray, what == PLAN_NONSENSE || what == PLAN_DEAD ? 0 : AT);
    if (fuzz_explain(player, &trial[1], explained, &reason))
        fail_msg("%s", reason.text);
    fuzz_player_close(player);
    for (size_t i = 0; i < ARRAY_COUNT(trial); i++)
        fuzz_trial_free(&trial[i]);
    return result[1];
}

static void every_kind_of_fault_is_found(void **state)
{
    (void)state;
    static const struct {
        enum player_plan plan;
        enum fuzz_kind kind;
        size_t findings, judged, opened;
        enum cause cause;
    } expected[] = {
        {PLAN_MISS, FUZZ_KIND_WRONG + (int)WRONG_MISSED, 4, 20, 1, CAUSE_SHADER}, /* and bits */
        {PLAN_BITS, FUZZ_KIND_BITS, 2, 20, 1, CAUSE_SHADER},
        {PLAN_UNFINISHED, FUZZ_KIND_UNFINISHED, 2, 19, 1, CAUSE_SHADER},
        {PLAN_DEAD, FUZZ_KIND_CRASH, 2, 0, 3, CAUSE_UNEXPLAINED},
        {PLAN_REFUSES, FUZZ_KIND_REFUSED, 2, 0, 1, CAUSE_UNEXPLAINED},
        {PLAN_NONSENSE, FUZZ_KIND_PROTOCOL, 2, 0, 1, CAUSE_UNEXPLAINED},
    };
    for (size_t i = 0; i < ARRAY_COUNT(expected); i++) {
        struct fuzz_finding finding;
        struct fuzz_result result = play_planned(expected[i].plan, &finding);
        char text[FUZZ_SIGNATURE_MOST];
        fuzz_signature_print(&finding.signature, text);
        if (finding.signature.kind != expected[i].kind ||
            result.finding_count != expected[i].findings || result.judged != expected[i].judged ||
            opened != expected[i].opened || finding.signature.cause != expected[i].cause)
            fail_msg("plan %zu: %s, %zu findings, %zu judged, opened %zu times", i, text,
                     result.finding_count, result.judged, opened);
        assert_string_equal(finding.signature.engine, "planned");
        assert_true(result.wrong >= 2);
        assert_int_equal(result.players, result.judged ? 3 : 0); /* a fault is no answer */
    }
}

/* Layouts that an engine does not take are a limit of it, as ones that cannot hold the trial. */
static void layouts_that_an_engine_does_not_take_are_refused(void **state)
{
    (void)state;
    const struct engine *engine[] = {engine_find("cpu_stackless"), engine_find("fast")};
    const struct layout *layout[] = {layout_find("f32"), layout_find("half4"),
                                     layout_find("amd64_g0")};
    const struct engine_options options = {.device = -1, .threads = 1};
    struct fuzz_field field;
    struct fuzz_player *player;
    struct fuzz_trial trial;
    struct fuzz_result result;
    struct reason reason;
    trial_make(1, 0, 8, 8, RAYS, &trial);
    if (fuzz_field_make(engine, 2, layout, 3, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason) ||
        fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(result.refusers, 2 | 4 | 32);
    assert_int_equal(result.players, 1 | 8 | 16);
    for (size_t i = 0; i < result.finding_count; i++) /* of amd64_g0, which is no tree */
        assert_int_equal(result.finding[i].signature.kind, FUZZ_KIND_TREE);
    fuzz_player_close(player);
    fuzz_trial_free(&trial);
}

/* --- promises --------------------------------------------------------------------------------- */

static enum status hitter_open(const struct engine *engine, const struct engine_options *options,
                               void **self, struct reason *why)
{
    (void)engine, (void)options, (void)why;
    *self = NULL;
    return STATUS_OK;
}

static enum status hitter_prepare(void *self, const struct job *job, struct reason *why)
{
    (void)self, (void)job, (void)why;
    return STATUS_OK;
}

static enum status hitter_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                struct trace_report *report, struct reason *why)
{
    (void)self, (void)ray, (void)why;
    *report = (struct trace_report){0};
    for (size_t i = 0; i < count; i++)
        hit[i] = (struct hit){2, 0.25f, 0.25f, 0};
    return STATUS_OK;
}

static void hitter_close(void *self)
{
    (void)self;
}

static struct model closed_model(const struct engine *engine, void *self,
                                 const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){.formula = TWIN_MT, .rounding = ROUNDING_IEEE};
}

static struct model open_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    struct model model = closed_model(engine, self, tri);
    model.open = true;
    return model;
}

/* A hit at exactly tmin is right in a closed range and WRONG in an open one, whatever the range of
 * the other contestant. */
static void each_is_held_to_its_own_range(void **state)
{
    (void)state;
    struct engine closed = {.name = "closed",
                            .own_tri = true,
                            .open = hitter_open,
                            .prepare = hitter_prepare,
                            .trace = hitter_trace,
                            .model = closed_model,
                            .close = hitter_close};
    struct engine open = closed;
    open.name = "open", open.model = open_model;
    for (int turn = 0; turn < 2; turn++) {
        const struct engine *engine[] = {turn ? &open : &closed, turn ? &closed : &open};
        struct fuzz_field field;
        struct fuzz_player *player = open_player(engine, 2, &field);
        struct fuzz_trial trial;
        struct fuzz_result result;
        struct reason reason;
        if (fuzz_trial_make(3, 1, 1, &trial, &reason))
            fail_msg("%s", reason.text);
        memcpy(trial.scene.vertex, (const float[9]){0, 0, 0, 4, 0, 0, 0, 4, 0}, 9 * sizeof(float));
        memcpy(trial.scene.index, (const uint32_t[3]){0, 1, 2}, 3 * sizeof(uint32_t));
        trial.ray[0] = (struct ray){{1, 1, -2}, 2, {0, 0, 1}, INFINITY};
        trial.query = QUERY_CLOSEST;
        if (fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(result.finding_count, 1);
        assert_int_equal(result.finding[0].contestant, !turn);
        fuzz_player_close(player);
        fuzz_trial_free(&trial);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_at_once_have_the_verdicts_of_matches),
        cmocka_unit_test(every_kind_of_fault_is_found),
        cmocka_unit_test(each_is_held_to_its_own_range),
        cmocka_unit_test(layouts_that_an_engine_does_not_take_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

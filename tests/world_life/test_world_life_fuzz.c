/* Laws of trials of worlds with steps: how they are made, cut, played, kept and shrunk. */
#include "fuzz/findings/finding_file.h"
#include "fuzz/play/trial_world_life.h"
#include "fuzz/shrink/shrink.h"
#include "ref/engine.h"
#include "scenes/world_steps.h"
#include "tests/two_level/fuzz_world_play.h"

#include <stdlib.h>

#define TRIALS 24

static struct fuzz_trial lived_trial(uint64_t index, const char *steps)
{
    struct fuzz_trial trial = trial_of(5, index, &of_worlds);
    struct reason reason = {""};
    if (steps_parse(steps, trial.step, &trial.step_count, &reason) ||
        fuzz_trial_check(&trial, &reason))
        fail_msg("%s", reason.text);
    return trial;
}

/* Planted: keeps the world of the step before. */
static enum status stale_move(void *self, const struct world_job *job, struct reason *reason)
{
    (void)self, (void)job, (void)reason;
    return STATUS_OK;
}

static struct engine stale_engine(void)
{
    static struct world_tracer worlds;
    struct engine engine = *engine_find("brute");
    worlds = *engine.worlds;
    worlds.move_world = stale_move;
    engine.name = "stale";
    engine.worlds = &worlds;
    return engine;
}

/* --- making ----------------------------------------------------------------------------------- */

/* Steps are drawn apart: what is traced before them is the trial without, but for its steps. */
static void worlds_are_given_steps_of_all_kinds(void **state)
{
    (void)state;
    struct gen_options options = of_worlds;
    uint32_t kinds[MOTIONS] = {0}, acts[LIFE_ACTS] = {0};
    for (uint64_t i = 0; i < 200; i++) {
        struct fuzz_trial plain = trial_of(7, i, &of_worlds);
        options.steps = true;
        struct fuzz_trial lives = trial_of(7, i, &options);
        assert_int_equal(plain.step_count, 0);
        assert_in_range(lives.step_count, 1, 4);
        for (uint32_t k = 0; k < lives.step_count; k++) {
            kinds[lives.step[k].motion]++;
            acts[lives.step[k].act]++;
        }
        assert_int_equal(fuzz_trial_check(&lives, NULL), STATUS_OK);
        assert_true(fuzz_trial_hash(&lives) != fuzz_trial_hash(&plain));
        lives.step_count = 0;
        assert_true(fuzz_trial_hash(&lives) == fuzz_trial_hash(&plain));
        fuzz_trial_free(&plain);
        fuzz_trial_free(&lives);
    }
    for (enum life_motion m = 0; m < MOTIONS; m++)
        assert_true(kinds[m] > 8);
    assert_true(acts[LIFE_REFIT] > acts[LIFE_REBUILD] && acts[LIFE_REBUILD] > 50);
}

static void motions_of_instances_are_of_worlds_alone(void **state)
{
    (void)state;
    struct gen_options options = of_worlds;
    options.worlds = false;
    struct fuzz_trial trial = trial_of(5, 1, &options);
    trial.step_count = 1;
    trial.step[0] = (struct step){LIFE_REFIT, MOTION_JITTER, 1};
    assert_int_equal(fuzz_trial_check(&trial, NULL), STATUS_OK);
    trial.step[0].motion = MOTION_DRIFT;
    assert_int_equal(fuzz_trial_check(&trial, NULL), STATUS_INPUT);
    fuzz_trial_free(&trial);
}

/* --- cutting ---------------------------------------------------------------------------------- */

static bool same_world(const struct world *a, const struct world *b)
{
    bool same = a->instance_count == b->instance_count && a->mesh_count == b->mesh_count &&
                memcmp(a->instance, b->instance, a->instance_count * sizeof *a->instance) == 0;
    for (uint32_t i = 0; i < a->mesh_count && same; i++)
        same = a->mesh[i].scene->vertex_count == b->mesh[i].scene->vertex_count &&
               (a->mesh[i].scene->vertex_count == 0 ||
                memcmp(a->mesh[i].scene->vertex, b->mesh[i].scene->vertex,
                       12 * (size_t)a->mesh[i].scene->vertex_count) == 0);
    return same;
}

/* The worlds before a cut are those of the whole life, and the last is the trial's own. */
static void a_trial_of_a_world_that_is_cut_has_the_world_of_its_step(void **state)
{
    (void)state;
    uint32_t moved[LIFE_STEPS_MOST] = {0};
    for (uint64_t index = 0; index < TRIALS; index++) {
        struct fuzz_trial trial =
            lived_trial(index, "refit:drift:3,rebuild:jitter:5,refit:turn:2,refit:exchange:4");
        struct trial_world_life life, again;
        struct trial_meshes own;
        assert_int_equal(trial_world_life_make(&trial, &life, NULL), STATUS_OK);
        assert_int_equal(trial_meshes_make(&trial.world, &trial.scene, &own, NULL), STATUS_OK);
        assert_true(same_world(&own.world, &life.meshes[trial.step_count].world));
        for (uint32_t i = 0; i < trial.step_count; i++)
            moved[i] += !same_world(&life.meshes[i].world, &life.meshes[i + 1].world);
        for (uint32_t step = 1; step <= trial.step_count; step++) {
            struct fuzz_trial cut;
            assert_int_equal(trial_life_cut(&trial, step, &cut, NULL), STATUS_OK);
            assert_int_equal(cut.step_count, step);
            assert_memory_equal(cut.step, trial.step, step * sizeof *cut.step);
            assert_int_equal(trial_world_life_make(&cut, &again, NULL), STATUS_OK);
            for (uint32_t i = 0; i <= step; i++)
                assert_true(same_world(&again.meshes[i].world, &life.meshes[i].world));
            trial_world_life_free(&again);
            fuzz_trial_free(&cut);
        }
        trial_meshes_free(&own);
        trial_world_life_free(&life);
        fuzz_trial_free(&trial);
    }
    for (uint32_t i = 0; i < 3; i++) /* an exchange may be of one with itself */
        assert_true(moved[i] > TRIALS / 2);
}

/* --- playing ---------------------------------------------------------------------------------- */

static void honest_engines_are_right_after_steps_of_worlds(void **state)
{
    (void)state;
    static struct fuzz_result result;
    struct gen_options options = of_worlds;
    const struct engine *const engine[] = {engine_find("cpu"), engine_find("fast")};
    const struct layout *const layout[] = {layout_find("f32"), layout_find("rf16"),
                                           layout_find("cwbvh80")};
    struct fuzz_player *player = open_all(engine, 2, layout, 3);
    uint32_t refitted = 0, rebuilt = 0;
    options.steps = true;
    for (uint64_t i = 0; i < 2 * TRIALS; i++) {
        struct fuzz_trial trial = trial_of(11, i, &options);
        must_play(player, &trial, 1, &result);
        if (result.finding_count > 0)
            fail_msg("trial %u, step %u", (unsigned)i, result.finding[0].step);
        assert_int_equal(result.states, trial.step_count + 1);
        refitted += result.refitted != 0;
        rebuilt += result.rebuilt != 0;
        fuzz_trial_free(&trial);
    }
    assert_true(refitted > 20 && rebuilt > 5);
    fuzz_player_close(player);
}

/* At the step after which it shows: the trial that ends before is clean. Its cause is `stale`. */
static void a_lost_update_of_a_world_is_found_and_stale(void **state)
{
    (void)state;
    static struct fuzz_result result;
    static const char *const steps[] = {"refit:drift:1", "rebuild:turn,refit:reflect",
                                        "refit:jitter:1", "refit:still,refit:scale:3"};
    const struct engine engine = stale_engine(), *const engines_of[] = {&engine};
    const struct layout *const none[] = {NULL};
    struct fuzz_player *player = open_all(engines_of, 1, none, 1);
    struct reason reason = {""};
    uint32_t found = 0;
    for (uint64_t i = 0; i < TRIALS; i++) {
        struct fuzz_trial trial = lived_trial(i, steps[i % ARRAY_COUNT(steps)]), cut;
        must_play(player, &trial, 1, &result);
        for (size_t f = 0; f < result.finding_count; f++) {
            if (fuzz_explain(player, &trial, &result.finding[f], &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(result.finding[f].step, trial.step_count);
            assert_int_equal(result.finding[f].signature.cause, CAUSE_STALE);
            found++;
        }
        assert_int_equal(trial_life_cut(&trial, trial.step_count - 1, &cut, NULL), STATUS_OK);
        must_play(player, &cut, 1, &result);
        assert_int_equal(result.finding_count, 0);
        fuzz_trial_free(&cut);
        fuzz_trial_free(&trial);
        trial = lived_trial(i, "rebuild:drift:1,rebuild:jitter:2");
        must_play(player, &trial, 1, &result);
        assert_int_equal(result.finding_count, 0); /* it updates after refits alone */
        fuzz_trial_free(&trial);
    }
    assert_true(found > TRIALS / 2);
    fuzz_player_close(player);
}

/* --- keeping and shrinking -------------------------------------------------------------------- */

static void files_of_worlds_keep_the_steps(void **state)
{
    (void)state;
    struct finding_file file = {.trial = lived_trial(3, "refit:drift:3,rebuild:hide,refit")}, again;
    char *bytes;
    size_t size;
    struct reason reason = {""};
    if (finding_file_print(&file, &bytes, &size, &reason) ||
        finding_file_parse("it", bytes, size, &again, &reason))
        fail_msg("%s", reason.text);
    assert_non_null(strstr(bytes, "\nsteps refit:drift:3,rebuild:hide,refit\n"));
    assert_true(fuzz_trial_hash(&file.trial) == fuzz_trial_hash(&again.trial));
    assert_int_equal(again.trial.step_count, 3);
    free(bytes);
    finding_file_free(&file);
    finding_file_free(&again);
}

/* What a stale engine shows needs one refit; the rest of the life goes. */
static void steps_of_worlds_are_dropped(void **state)
{
    (void)state;
    static struct fuzz_result result;
    const struct shrink_options options = {.asks = 3000};
    const struct engine engine = stale_engine(), *const engines_of[] = {&engine};
    const struct layout *const none[] = {NULL};
    struct fuzz_player *player = open_all(engines_of, 1, none, 1);
    struct reason reason = {""};
    uint32_t shrunk = 0;
    for (uint64_t i = 0; i < 4; i++) {
        struct finding_file file = {.has_signature = true}, out;
        struct shrink_stats stats;
        file.trial = lived_trial(i, "rebuild:drift,refit:turn:1,refit:drift:1,rebuild");
        must_play(player, &file.trial, 1, &result);
        if (result.finding_count > 0) {
            if (fuzz_explain(player, &file.trial, &result.finding[0], &reason))
                fail_msg("%s", reason.text);
            file.signature = result.finding[0].signature;
            if (fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(out.trial.step_count, 1);
            assert_int_equal(out.trial.step[0].act, LIFE_REFIT);
            assert_true(out.trial.ray_count == 1 && out.trial.world.is);
            assert_int_equal(out.signature.cause, CAUSE_STALE);
            finding_file_free(&out);
            shrunk++;
        }
        finding_file_free(&file);
    }
    assert_true(shrunk > 1);
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_are_given_steps_of_all_kinds),
        cmocka_unit_test(motions_of_instances_are_of_worlds_alone),
        cmocka_unit_test(a_trial_of_a_world_that_is_cut_has_the_world_of_its_step),
        cmocka_unit_test(honest_engines_are_right_after_steps_of_worlds),
        cmocka_unit_test(a_lost_update_of_a_world_is_found_and_stale),
        cmocka_unit_test(files_of_worlds_keep_the_steps),
        cmocka_unit_test(steps_of_worlds_are_dropped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

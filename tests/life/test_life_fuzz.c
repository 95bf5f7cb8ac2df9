/* Trials with steps: what a player finds in engines that update badly, what is kept of it, and what
 * the shrinker leaves. */
#include "fuzz/findings/finding_file.h"
#include "fuzz/gen/gen.h"
#include "fuzz/play/trial_life.h"
#include "fuzz/shrink/shrink.h"

#include "tests/support/fuzz_trials.h"

#include <stdio.h>

#define TRIALS 40u

/* --- engines ---------------------------------------------------------------------------------- */

static const struct engine *brute;
static uint32_t moves, prepares, traces;

static enum status counted_prepare(void *self, const struct job *job, struct reason *reason)
{
    prepares++;
    return brute->prepare(self, job, reason);
}

static enum status counted_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *reason)
{
    traces += count > 0;
    return brute->trace(self, ray, count, hit, report, reason);
}

static enum status honest_move(void *self, const struct job *job, struct reason *reason)
{
    moves++;
    return brute->prepare(self, job, reason);
}

/* Planted: keeps the vertices of the step before. */
static enum status stale_move(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)job, (void)reason;
    moves++;
    return STATUS_OK;
}

/* As brute force on no layout, called `name`. */
static struct engine engine_of(const char *name,
                               enum status (*move)(void *self, const struct job *job,
                                                   struct reason *reason))
{
    struct engine engine = *engine_find("brute");
    brute = engine_find("brute");
    engine.name = name;
    engine.move = move;
    engine.prepare = counted_prepare;
    engine.trace = counted_trace;
    engine.trace_tasks = NULL;
    return engine;
}

static struct fuzz_player *player_of(const struct engine *engine, const struct layout *layout)
{
    static const struct engine_options options = {.device = -1, .threads = 1};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason = {""};
    moves = prepares = traces = 0;
    if (fuzz_field_make(&engine, 1, &layout, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static struct fuzz_trial trial_of(uint64_t index, const char *steps)
{
    struct fuzz_trial trial;
    struct reason reason = {""};
    trial_make(9, index, 8, 30, 60, &trial);
    if (steps_parse(steps, trial.step, &trial.step_count, &reason) ||
        fuzz_trial_check(&trial, &reason))
        fail_msg("%s", reason.text);
    return trial;
}

static void play(struct fuzz_player *player, const struct fuzz_trial *trial,
                 struct fuzz_result *result)
{
    struct reason reason = {""};
    if (fuzz_play(player, trial, 1, result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
}

/* --- playing ---------------------------------------------------------------------------------- */

/* Each step is played to its end from the start, and traced after every step. */
static void engines_are_taken_through_all_steps(void **state)
{
    (void)state;
    static struct fuzz_result result;
    const struct engine engine = engine_of("honest", honest_move);
    struct fuzz_player *player = player_of(&engine, NULL);
    struct fuzz_trial trial = trial_of(0, "refit:jitter:2,rebuild:mirror,refit:one:3");
    play(player, &trial, &result);
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(result.judged, 4 * trial.ray_count);
    assert_int_equal(prepares, 4 + 2); /* at first, and at the rebuild of two lives */
    assert_int_equal(moves, 3 + 1);
    assert_int_equal(traces, 4 + 3 + 2 + 1);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

static void honest_engines_are_right_after_any_steps(void **state)
{
    (void)state;
    static struct fuzz_result result;
    const struct layout *const of[] = {layout_find("f32"), layout_find("rf16"),
                                       layout_find("cwbvh80"), layout_find("tiny8")};
    static const char *const names[] = {"cpu", "fast"};
    uint32_t refitted = 0, rebuilt = 0;
    for (size_t e = 0; e < 2; e++)
        for (size_t l = 0; l < ARRAY_COUNT(of); l++) {
            struct fuzz_player *player = player_of(engine_find(names[e]), of[l]);
            for (uint64_t i = 0; i < TRIALS; i++) {
                struct fuzz_trial trial = trial_of(i, "refit,refit,refit");
                struct rng rng = rng_make(i, e);
                for (uint32_t k = 0; k < trial.step_count; k++)
                    trial.step[k] =
                        (struct step){rng_below(&rng, 3) == 0 ? LIFE_REBUILD : LIFE_REFIT,
                                      rng_below(&rng, MOTIONS_OF_VERTICES), rng_below(&rng, 1000)};
                play(player, &trial, &result);
                if (result.finding_count > 0)
                    fail_msg("%s %s: trial %u, step %u", names[e], of[l]->name, (unsigned)i,
                             result.finding[0].step);
                refitted += result.refitted;
                rebuilt += result.rebuilt;
                fuzz_trial_free(&trial);
            }
            fuzz_player_close(player);
        }
    assert_true(refitted > 100 && rebuilt > 5);
}

/* At the step after which it shows, and no earlier one: the trial that ends before it is clean. */
static uint32_t found_at(const struct engine *engine, const char *steps, uint64_t index)
{
    static struct fuzz_result result;
    struct fuzz_player *player = player_of(engine, NULL);
    struct fuzz_trial trial = trial_of(index, steps), cut;
    uint32_t step = 0;
    play(player, &trial, &result);
    if (result.finding_count > 0) {
        step = result.finding[0].step;
        moves = 0;
        assert_true(step > 0);
        assert_int_equal(trial_life_cut(&trial, step - 1, &cut, NULL), STATUS_OK);
        play(player, &cut, &result);
        assert_int_equal(result.finding_count, 0);
        fuzz_trial_free(&cut);
    }
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
    return step;
}

static void a_lost_update_is_found_after_its_step(void **state)
{
    (void)state;
    const struct engine stale = engine_of("stale", stale_move);
    uint32_t second = 0, first = 0;
    for (uint64_t i = 0; i < TRIALS; i++) {
        assert_int_equal(found_at(&stale, "rebuild:jitter:1,rebuild:mirror", i), 0);
        assert_int_equal(found_at(&stale, "refit,refit,refit", i), 0);
        second += found_at(&stale, "rebuild:jitter:1,refit:jitter:2", i) == 2;
        first += found_at(&stale, "refit:jitter:2,refit:still", i) == 1;
    }
    assert_true(second > TRIALS / 2 && first > TRIALS / 2);
}

static void a_trial_that_is_cut_has_the_scene_of_its_step(void **state)
{
    (void)state;
    struct fuzz_trial trial = trial_of(1, "refit:jitter:3,rebuild:one:5,refit:swap:2");
    struct trial_life life;
    assert_int_equal(trial_life_make(&trial, &life, NULL), STATUS_OK);
    for (uint32_t step = 0; step <= trial.step_count; step++) {
        struct fuzz_trial cut;
        struct trial_life again;
        char all[STEPS_TEXT_MOST], some[STEPS_TEXT_MOST];
        assert_int_equal(trial_life_cut(&trial, step, &cut, NULL), STATUS_OK);
        assert_int_equal(cut.step_count, step);
        assert_memory_equal(cut.scene.vertex, life.scene[step].vertex,
                            12 * (size_t)cut.scene.vertex_count);
        steps_write(trial.step, step, all);
        steps_write(cut.step, cut.step_count, some);
        assert_string_equal(all, some);
        assert_int_equal(trial_life_make(&cut, &again, NULL), STATUS_OK);
        for (uint32_t i = 0; i <= again.count && again.count > 0; i++)
            assert_memory_equal(again.scene[i].vertex, life.scene[i].vertex,
                                12 * (size_t)cut.scene.vertex_count);
        trial_life_free(&again);
        fuzz_trial_free(&cut);
    }
    trial_life_free(&life);
    fuzz_trial_free(&trial);
}

/* --- keeping and shrinking -------------------------------------------------------------------- */

static void steps_are_part_of_a_trial(void **state)
{
    (void)state;
    struct fuzz_trial one = trial_of(2, "refit:jitter:3,rebuild"), none = trial_of(2, "refit");
    none.step_count = 0;
    uint64_t still = fuzz_trial_hash(&none);
    for (uint32_t count = 1; count <= one.step_count; count++) {
        struct fuzz_trial_size small = fuzz_trial_size(&none), large;
        none.step_count = count;
        memcpy(none.step, one.step, sizeof one.step);
        large = fuzz_trial_size(&none);
        assert_true(large.steps == count && fuzz_trial_size_compare(&small, &large) < 0);
        assert_true(fuzz_trial_hash(&none) != still);
    }
    assert_true(fuzz_trial_hash(&none) == fuzz_trial_hash(&one));
    one.move = 0.5f;
    assert_int_equal(fuzz_trial_check(&one, NULL), STATUS_INPUT);
    one.move = 0;
    one.step_count = LIFE_STEPS_MOST + 1;
    assert_int_equal(fuzz_trial_check(&one, NULL), STATUS_INPUT);
    fuzz_trial_free(&one);
    fuzz_trial_free(&none);
}

static void files_keep_the_steps(void **state)
{
    (void)state;
    struct finding_file file = {.trial = trial_of(3, "refit:jitter:3,rebuild:mirror,refit")}, again;
    char *bytes;
    size_t size;
    struct reason reason = {""};
    if (finding_file_print(&file, &bytes, &size, &reason) ||
        finding_file_parse("it", bytes, size, &again, &reason))
        fail_msg("%s", reason.text);
    assert_non_null(strstr(bytes, "\nsteps refit:jitter:3,rebuild:mirror,refit\n"));
    assert_true(fuzz_trial_hash(&file.trial) == fuzz_trial_hash(&again.trial));
    assert_int_equal(again.trial.step_count, 3);
    free(bytes);
    finding_file_free(&file);
    finding_file_free(&again);
}

/* Shrinks what an engine shows in a trial with these steps; returns what is left. */
static struct fuzz_trial shrunk(const struct engine *engine, const char *steps)
{
    static struct fuzz_result result;
    const struct shrink_options options = {.asks = 4000};
    struct fuzz_player *player = player_of(engine, NULL);
    struct finding_file file = {.has_signature = true}, out;
    struct shrink_stats stats;
    struct reason reason = {""};
    for (uint64_t i = 0;; i++) {
        file.trial = trial_of(i, steps);
        play(player, &file.trial, &result);
        if (result.finding_count > 0)
            break;
        fuzz_trial_free(&file.trial);
    }
    assert_int_equal(fuzz_explain(player, &file.trial, &result.finding[0], &reason), STATUS_OK);
    file.signature = result.finding[0].signature;
    moves = 0;
    if (fuzz_shrink_finding(player, &file, &options, &out, &stats, &reason))
        fail_msg("%s", reason.text);
    assert_int_not_equal(stats.end, SHRINK_NOT_SHOWN);
    play(player, &out.trial, &result);
    assert_true(result.finding_count > 0);
    assert_int_equal(result.finding[0].step, out.trial.step_count);
    finding_file_free(&file);
    fuzz_player_close(player);
    return out.trial;
}

static void shrinking_leaves_the_step_that_fails(void **state)
{
    (void)state;
    const struct engine stale = engine_of("stale", stale_move);
    static const char *const steps[] = {"refit:jitter:2",
                                        "rebuild:swap:3,refit:jitter:2,refit:far:3",
                                        "refit:still,refit:mirror:1,rebuild:jitter:9"};
    for (size_t i = 0; i < ARRAY_COUNT(steps); i++) {
        struct fuzz_trial trial = shrunk(&stale, steps[i]);
        assert_int_equal(trial.step_count, 1);
        assert_int_equal(trial.step[0].act, LIFE_REFIT);
        assert_true(trial.step[0].motion != MOTION_STILL);
        assert_true(trial.scene.tri_count <= 2);
        assert_int_equal(trial.ray_count, 1);
        fuzz_trial_free(&trial);
    }
}

/* Shows what it wants in the whole trial, and in the one that ends after its first step. */
static enum status ask_for_first(void *user, const struct fuzz_trial *candidate, size_t count,
                                 size_t *first, struct reason *reason)
{
    const struct fuzz_trial *whole = user;
    struct trial_life life;
    enum status status = trial_life_make(whole, &life, reason);
    for (*first = 0; *first < count && !status; ++*first) {
        const struct fuzz_trial *one = &candidate[*first];
        if (fuzz_trial_hash(one) == fuzz_trial_hash(whole) ||
            (one->step_count == 1 && one->scene.vertex_count == whole->scene.vertex_count &&
             memcmp(one->scene.vertex, life.scene[1].vertex,
                    12 * (size_t)one->scene.vertex_count) == 0))
            break;
    }
    trial_life_free(&life);
    return status;
}

static void the_end_of_a_life_is_cut_with_its_scene(void **state)
{
    (void)state;
    struct fuzz_trial whole = trial_of(4, "refit:jitter:1,refit:mirror:2,rebuild:one:7"), out;
    const struct shrink_options options = {.asks = 3000};
    struct shrink_stats stats;
    assert_int_equal(fuzz_shrink_trial(&whole, ask_for_first, &whole, &options, &out, &stats, NULL),
                     STATUS_OK);
    assert_int_equal(out.step_count, 1);
    assert_int_equal(out.scene.vertex_count, whole.scene.vertex_count);
    fuzz_trial_free(&whole);
    fuzz_trial_free(&out);
}

/* --- drawing ---------------------------------------------------------------------------------- */

static void one_generated_trial_in_64_has_steps(void **state)
{
    (void)state;
    static const struct gen_options options = {
        .triangles_least = 16, .triangles_most = 64, .rays = 1};
    uint32_t with = 0, kinds[MOTIONS_OF_VERTICES] = {0}, acts[LIFE_ACTS] = {0}, many = 0;
    for (uint64_t i = 0; i < 6400; i++) {
        struct fuzz_trial trial;
        assert_int_equal(gen_trial(3, i, &options, &trial, NULL), STATUS_OK);
        assert_int_equal(fuzz_trial_check(&trial, NULL), STATUS_OK);
        with += trial.step_count > 0;
        many += trial.step_count > 3;
        for (uint32_t k = 0; k < trial.step_count; k++) {
            kinds[trial.step[k].motion]++;
            acts[trial.step[k].act]++;
        }
        fuzz_trial_free(&trial);
    }
    assert_in_range(with, 60, 140);
    assert_true(many > 5 && acts[LIFE_REFIT] > acts[LIFE_REBUILD] && acts[LIFE_REBUILD] > 20);
    for (enum life_motion m = 0; m < MOTIONS_OF_VERTICES; m++)
        assert_true(kinds[m] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_are_taken_through_all_steps),
        cmocka_unit_test(honest_engines_are_right_after_any_steps),
        cmocka_unit_test(a_lost_update_is_found_after_its_step),
        cmocka_unit_test(a_trial_that_is_cut_has_the_scene_of_its_step),
        cmocka_unit_test(steps_are_part_of_a_trial),
        cmocka_unit_test(files_keep_the_steps),
        cmocka_unit_test(shrinking_leaves_the_step_that_fails),
        cmocka_unit_test(the_end_of_a_life_is_cut_with_its_scene),
        cmocka_unit_test(one_generated_trial_in_64_has_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The fuzzer's edits: each changes what it says, says what it changes, and keeps trials valid. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/mutate.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"

#define TRIALS 150u

static const struct gen_options short_ones = {16, 64, 40, false};

/* What an edit did to one trial. */
enum effect {
    EFFECT_CHANGED,
    EFFECT_NOTHING,
    EFFECT_LIED,      /* says "changed" where nothing is, or the other way */
    EFFECT_INVALID,   /* left a trial that no reader would take */
    EFFECT_ELSEWHERE, /* changed another part than its own */
    EFFECTS
};

static uint64_t hash_without(const struct fuzz_trial *trial, enum edit_part part)
{
    struct fuzz_trial copy = *trial;
    static const struct scene no_scene;
    if (part == EDIT_SCENE)
        copy.scene = no_scene;
    if (part == EDIT_RAYS)
        copy.ray_count = 0;
    if (part == EDIT_TESTS) {
        copy.builder = builders[0];
        copy.box = box_tests[0];
        copy.tri = tri_tests[0];
        copy.query = QUERY_CLOSEST;
        copy.move = 0;
        copy.move_seed = 0;
        copy.build = (struct build_options){.leaf = 1, .eps = 0};
    }
    return fuzz_trial_hash(&copy);
}

static enum effect effect_of(const struct edit *edit, uint64_t seed)
{
    struct fuzz_trial trial = trial_of(53, seed, &short_ones);
    struct rng rng = rng_make(seed, 59);
    bool changed = false, rays_too = edit->part == EDIT_SCENE; /* which may go with the scene */
    uint64_t before = fuzz_trial_hash(&trial), others = hash_without(&trial, edit->part);
    assert_int_equal(edit->apply(&rng, &trial, &changed), STATUS_OK);
    enum effect effect = changed ? EFFECT_CHANGED : EFFECT_NOTHING;
    if (changed != (fuzz_trial_hash(&trial) != before))
        effect = EFFECT_LIED;
    else if (!rays_too && hash_without(&trial, edit->part) != others)
        effect = EFFECT_ELSEWHERE;
    else if (fuzz_trial_check(&trial, NULL))
        effect = EFFECT_INVALID;
    fuzz_trial_free(&trial);
    return effect;
}

static void every_edit_changes_something_and_says_so(void **state)
{
    (void)state;
    for (uint32_t e = 0; edits[e].name; e++) {
        uint32_t count[EFFECTS] = {0};
        for (uint32_t i = 0; i < TRIALS; i++)
            count[effect_of(&edits[e], i)]++;
        print_message("%-12s %3u changed, %3u nothing\n", edits[e].name, count[EFFECT_CHANGED],
                      count[EFFECT_NOTHING]);
        assert_int_equal(count[EFFECT_LIED] + count[EFFECT_INVALID] + count[EFFECT_ELSEWHERE], 0);
        /* The builder has no other that is not published. */
        if (strcmp(edits[e].name, "builder") != 0)
            assert_true(count[EFFECT_CHANGED] > TRIALS / 4);
        for (uint32_t other = 0; other < e; other++)
            assert_string_not_equal(edits[e].name, edits[other].name);
    }
}

/* Planted edits. */
static enum status lies(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng, (void)trial;
    *changed = true;
    return STATUS_OK;
}

static enum status overflows(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng;
    for (uint32_t i = 0; i < 3 * trial->scene.vertex_count; i++)
        trial->scene.vertex[i] = INFINITY;
    *changed = trial->scene.vertex_count > 0;
    return STATUS_OK;
}

static enum status strays(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng;
    trial->build.leaf++;
    *changed = true;
    return STATUS_OK;
}

static void bad_edits_are_caught(void **state)
{
    (void)state;
    static const struct edit planted[] = {{"lies", EDIT_SCENE, lies},
                                          {"overflows", EDIT_SCENE, overflows},
                                          {"strays", EDIT_RAYS, strays}};
    static const enum effect expected[] = {EFFECT_LIED, EFFECT_INVALID, EFFECT_ELSEWHERE};
    for (uint32_t i = 0; i < ARRAY_COUNT(planted); i++)
        assert_int_equal(effect_of(&planted[i], 1), expected[i]);
}

/* A long life: edits upon edits keep a trial valid, small and in its members. */
static void mutants_of_mutants_stay_valid(void **state)
{
    (void)state;
    struct rng rng = rng_make(61, 0);
    for (uint32_t life = 0; life < 40; life++) {
        struct fuzz_trial trial = trial_of(67, life, &short_ones);
        uint32_t least = trial.scene.tri_count;
        for (uint32_t i = 0; i < 200; i++) {
            uint64_t before = fuzz_trial_hash(&trial);
            struct reason reason = {""};
            assert_int_equal(gen_mutate(&rng, &trial, &reason), STATUS_OK);
            assert_true(fuzz_trial_hash(&trial) != before);
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("life %u, edit %u, %s: %s", life, i, trial.origin.recipe, reason.text);
            assert_true(trial.scene.tri_count <= 128 || trial.scene.tri_count <= least);
            assert_false(trial.builder->faithful || trial.box->faithful || trial.tri->faithful);
        }
        assert_true(trial.origin.mutated);
        assert_true(strlen(trial.origin.recipe) < sizeof trial.origin.recipe);
        assert_non_null(strstr(trial.origin.recipe, " + "));
        fuzz_trial_free(&trial);
    }
}

/* The same random numbers make the same mutant. */
static void a_mutant_depends_on_its_random_numbers_only(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 200; i++) {
        struct fuzz_trial a = trial_of(71, i, &short_ones), b = trial_of(71, i, &short_ones);
        struct rng left = rng_make(i, 73), right = rng_make(i, 73);
        assert_int_equal(gen_mutate(&left, &a, NULL), STATUS_OK);
        assert_int_equal(gen_mutate(&right, &b, NULL), STATUS_OK);
        assert_true(fuzz_trial_hash(&a) == fuzz_trial_hash(&b));
        assert_string_equal(a.origin.recipe, b.origin.recipe);
        fuzz_trial_free(&a);
        fuzz_trial_free(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_edit_changes_something_and_says_so),
        cmocka_unit_test(bad_edits_are_caught),
        cmocka_unit_test(mutants_of_mutants_stay_valid),
        cmocka_unit_test(a_mutant_depends_on_its_random_numbers_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

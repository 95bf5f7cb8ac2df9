/* Laws of campaigns of lives: every trial that can have steps has some, and is otherwise the trial
 * that it is without; those that have steps anyway have the same. */
#include "fuzz/campaign/worker.h"
#include "fuzz/gen/gen.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#define TRIALS  1500u
#define LARGEST 512u /* triangles of a trial that takes steps */

static struct fuzz_trial trial_of(uint64_t index, bool steps)
{
    const struct gen_options options = {
        .triangles_least = 8, .triangles_most = 40, .rays = 4, .steps = steps};
    struct fuzz_trial trial;
    struct reason reason = {""};
    if (gen_trial(7, index, &options, &trial, &reason))
        fail_msg("%s", reason.text);
    return trial;
}

static void every_trial_is_a_life_and_else_the_same(void **state)
{
    (void)state;
    uint32_t large = 0, lives = 0, motions = 0;
    for (uint64_t index = 0; index < TRIALS; index++) {
        struct fuzz_trial with = trial_of(index, true), without = trial_of(index, false);
        struct reason reason = {""};
        assert_int_equal(fuzz_trial_check(&with, &reason), STATUS_OK);
        assert_int_equal(with.step_count > 0, with.scene.tri_count <= LARGEST);
        if (without.step_count > 0) {
            assert_int_equal(with.step_count, without.step_count);
            assert_memory_equal(with.step, without.step, sizeof with.step);
        }
        for (uint32_t i = 0; i < with.step_count; i++)
            motions |= 1u << with.step[i].motion;
        large += with.step_count == 0;
        lives += without.step_count > 0;
        with.step_count = without.step_count = 0;
        memset(with.step, 0, sizeof with.step);
        memset(without.step, 0, sizeof without.step);
        assert_true(fuzz_trial_hash(&with) == fuzz_trial_hash(&without));
        fuzz_trial_free(&with);
        fuzz_trial_free(&without);
    }
    assert_true(lives > TRIALS / 128 && lives < TRIALS / 32 && large < TRIALS / 100);
    assert_int_equal(motions, (1u << MOTIONS_OF_VERTICES) - 1);
}

/* A mutant of a trial without steps, such as one of the corpus, is a life, too. */
static void mutants_are_lives(void **state)
{
    (void)state;
    for (int steps = 0; steps < 2; steps++) {
        const struct work_rules rules = {
            .seed = 3,
            .gen = {.triangles_least = 8, .triangles_most = 40, .rays = 4, .steps = steps}};
        uint32_t lives = 0;
        for (uint64_t index = 0; index < 100; index++) {
            struct fuzz_trial base = trial_of(index, false), out;
            struct reason reason = {""};
            base.step_count = 0;
            memset(base.step, 0, sizeof base.step);
            if (work_trial_make(&rules, WORK_MUT, index, &base, &out, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(fuzz_trial_check(&out, &reason), STATUS_OK);
            if (steps && out.scene.tri_count <= LARGEST)
                assert_true(out.step_count > 0 || out.move > 0);
            lives += out.step_count > 0;
            fuzz_trial_free(&base);
            fuzz_trial_free(&out);
        }
        assert_true(steps ? lives > 80 : lives < 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_trial_is_a_life_and_else_the_same),
        cmocka_unit_test(mutants_are_lives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

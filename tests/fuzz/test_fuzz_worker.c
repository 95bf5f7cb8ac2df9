/* What a worker makes of an order: the trials, whose numbers a finding is known by. */
#include "fuzz/campaign/worker.h"

#include "fuzz/gen/gen.h"
#include "ref/tree/bvh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define MUTANTS 60u

static struct reason reason;

static struct work_rules rules_of(uint64_t seed)
{
    return (struct work_rules){.seed = seed,
                               .gen = {.triangles_least = 8, .triangles_most = 20, .rays = 30}};
}

static struct fuzz_trial make(const struct work_rules *rules, enum work_stream stream,
                              uint64_t index, const struct fuzz_trial *base)
{
    struct fuzz_trial trial;
    if (work_trial_make(rules, stream, index, base, &trial, &reason))
        fail_msg("%s", reason.text);
    return trial;
}

static uint64_t hash_of(const struct work_rules *rules, uint64_t index,
                        const struct fuzz_trial *base)
{
    struct fuzz_trial trial = make(rules, WORK_MUT, index, base);
    uint64_t hash = fuzz_trial_hash(&trial);
    assert_true(trial.origin.mutated);
    assert_int_equal(trial.origin.seed, rules->seed);
    assert_int_equal(trial.origin.index, index);
    assert_int_equal(trial.origin.version, GEN_VERSION);
    fuzz_trial_free(&trial);
    return hash;
}

static void mutants_are_of_base_seed_and_number(void **state)
{
    (void)state;
    const struct work_rules rules = rules_of(5), other = rules_of(6);
    struct fuzz_trial base = make(&rules, WORK_GEN, 3, NULL),
                      second = make(&rules, WORK_GEN, 4, NULL);
    const uint64_t before = fuzz_trial_hash(&base);
    uint32_t of_seed = 0, of_number = 0, of_base = 0, changed = 0;
    for (uint64_t i = 0; i < MUTANTS; i++) {
        uint64_t hash = hash_of(&rules, i, &base);
        assert_int_equal(hash, hash_of(&rules, i, &base));
        of_seed += hash != hash_of(&other, i, &base);
        of_number += hash != hash_of(&rules, i + 1, &base);
        of_base += hash != hash_of(&rules, i, &second);
        changed += hash != before;
    }
    assert_int_equal(fuzz_trial_hash(&base), before);
    /* Two edits may come to the same. */
    assert_true(of_seed > MUTANTS * 3 / 4 && of_number > MUTANTS * 3 / 4);
    assert_true(of_base > MUTANTS * 3 / 4 && changed > MUTANTS / 2);
    fuzz_trial_free(&base);
    fuzz_trial_free(&second);
}

/* What was kept or given is played as it is. */
static void builders_named_are_those_of_what_is_made(void **state)
{
    (void)state;
    struct work_rules rules = rules_of(5);
    struct fuzz_trial base = make(&rules, WORK_GEN, 3, NULL);
    rules.builder_count = 2;
    rules.builder[0] = builders[0];
    rules.builder[1] = builders[1];
    for (uint64_t i = 0; i < 8; i++)
        for (int mutated = 0; mutated < 2; mutated++) {
            struct fuzz_trial trial = make(&rules, mutated ? WORK_MUT : WORK_GEN, i, &base);
            assert_ptr_equal(trial.builder, builders[i % 2]);
            fuzz_trial_free(&trial);
        }
    for (int other = 0; other < 2; other++) {
        base.builder = builders[other];
        struct fuzz_trial trial = make(&rules, WORK_GIVEN, 0, &base);
        assert_ptr_equal(trial.builder, builders[other]);
        fuzz_trial_free(&trial);
    }
    fuzz_trial_free(&base);
}

/* Whatever an edit or a named builder puts in place of the base's: no engine may have to refuse
 * the mutant. */
static void mutants_of_stored_and_optimized_trials_can_be_traced(void **state)
{
    (void)state;
    static const char *const store[] = {"edges", "baldwin_webber"};
    static const char *const tri[] = {"mt", "baldwin_webber"};
    struct work_rules rules = rules_of(5);
    uint32_t other = 0;
    rules.builder_count = 2;
    rules.builder[0] = builder_find("rtrs");
    rules.builder[1] = builder_find("lbvh");
    for (int b = 0; b < 2; b++) {
        struct fuzz_trial base = make(&rules, WORK_GEN, 3, NULL);
        base.store = tri_store_find(store[b]);
        base.tri = tri_test_find(tri[b]);
        base.builder = builder_find("ploc");
        base.build.passes = 4;
        for (uint64_t i = 0; i < 10 * MUTANTS; i++) {
            struct fuzz_trial trial = make(&rules, WORK_MUT, i, &base);
            assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_OK);
            assert_int_equal(trial.build.passes, trial.builder->faithful ? 0 : 4);
            assert_int_equal(trial.store == base.store,
                             tri_store_answers(base.store, trial.tri->id));
            other += trial.store != base.store;
            fuzz_trial_free(&trial);
        }
        fuzz_trial_free(&base);
    }
    assert_true(other > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mutants_are_of_base_seed_and_number),
        cmocka_unit_test(builders_named_are_those_of_what_is_made),
        cmocka_unit_test(mutants_of_stored_and_optimized_trials_can_be_traced),
    };
    return cmocka_run_group_tests_name("fuzz_worker", tests, NULL, NULL) ? 1 : 0;
}

/* Stream `gen` of the fuzzer: a pure function of seed and index, and what it is made of. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fuzz/gen/gen_sketch.h"
#include "ref/base/float_mode.h"
#include "ref/oracle/oracle.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"

#define MANY 1000u

/* --- purity ------------------------------------------------------------------------------------
 */

static uint64_t hash_of(gen_fn *gen, uint64_t seed, uint64_t index,
                        const struct gen_options *options)
{
    struct fuzz_trial trial;
    if (gen(seed, index, options, &trial, NULL))
        return 0;
    uint64_t hash = fuzz_trial_hash(&trial);
    fuzz_trial_free(&trial);
    return hash;
}

/* Makes the trials in order, then backwards on four threads whose floating-point modes differ; the
 * first index that differs, or -1. */
static int first_impure(gen_fn *gen, uint32_t count)
{
    uint64_t *once = calloc(count, sizeof *once), *again = calloc(count, sizeof *again);
    int impure = -1;
    assert_non_null(once);
    assert_non_null(again);
    for (uint32_t i = 0; i < count; i++)
        once[i] = hash_of(gen, 7, i, &ordinary);
#pragma omp parallel for schedule(dynamic, 7) num_threads(4)
    for (uint32_t i = 0; i < count; i++) {
        unsigned long saved = float_mode();
        if (i % 3 == 1)
            float_mode_set(saved | FLOAT_FLUSH);
        if (i % 3 == 2)
            float_mode_set(saved | FLOAT_UP);
        again[count - 1 - i] = hash_of(gen, 7, count - 1 - i, &ordinary);
        float_mode_set(saved);
    }
    for (uint32_t i = 0; i < count && impure < 0; i++)
        if (once[i] == 0 || once[i] != again[i])
            impure = (int)i;
    free(once);
    free(again);
    return impure;
}

static void a_trial_depends_on_seed_and_index_only(void **state)
{
    (void)state;
    assert_int_equal(first_impure(gen_trial, MANY), -1);
}

/* Planted: the ninth trial of a run knows how many came before it. */
static enum status counting_gen(uint64_t seed, uint64_t index, const struct gen_options *options,
                                struct fuzz_trial *out, struct reason *reason)
{
    static _Atomic uint32_t made;
    enum status status = gen_trial(seed, index, options, out, reason);
    if (!status && ++made % 9 == 0 && out->ray_count > 0)
        out->ray[0].tmax = (float)made; /* adding to it would not show where it is large */
    return status;
}

/* Planted: computes in the modes that it finds. */
static enum status careless_gen(uint64_t seed, uint64_t index, const struct gen_options *options,
                                struct fuzz_trial *out, struct reason *reason)
{
    enum status status = gen_trial(seed, index, options, out, reason);
    volatile float little = 0x1p-30f, one = 1.0f;
    if (!status && out->ray_count > 0)
        out->ray[0].tmax = one + little;
    return status;
}

static void impure_generators_are_caught(void **state)
{
    (void)state;
    assert_true(first_impure(counting_gen, 100) >= 0);
    assert_true(first_impure(careless_gen, 100) >= 0);
}

/* The same trials without steps. */
static enum status stepless_gen(uint64_t seed, uint64_t index, const struct gen_options *options,
                                struct fuzz_trial *out, struct reason *reason)
{
    enum status status = gen_trial(seed, index, options, out, reason);
    out->step_count = 0;
    return status;
}

/* And without parts of triangles. */
static enum status whole_gen(uint64_t seed, uint64_t index, const struct gen_options *options,
                             struct fuzz_trial *out, struct reason *reason)
{
    enum status status = stepless_gen(seed, index, options, out, reason);
    out->build.presplit = 0;
    return status;
}

static uint64_t hash_of_many(gen_fn *gen, const struct gen_options *options)
{
    uint64_t all = 0xCBF29CE484222325u;
    for (uint64_t i = 0; i < MANY; i++)
        all = (all ^ hash_of(gen, 1, i, options)) * 0x100000001B3u;
    return all;
}

/* Other bytes need another GEN_VERSION. A member that comes or goes changes them, too. */
static void the_first_thousand_trials_are_what_they_were(void **state)
{
    (void)state;
    static const struct gen_options published = {
        .triangles_least = 16, .triangles_most = 64, .rays = 100, .faithful = true};
    const uint64_t golden = 0x443FAF4A101DB743u, golden_published = 0xC5B99B15691B2739u;
    uint64_t hash = hash_of_many(gen_trial, &ordinary);
    uint64_t faithful = hash_of_many(gen_trial, &published);
    if (hash != golden || faithful != golden_published)
        print_error("0x%016llXu, 0x%016llXu\n", (unsigned long long)hash,
                    (unsigned long long)faithful);
    assert_int_equal(GEN_VERSION, 8);
    assert_true(hash == golden);
    assert_true(faithful == golden_published);
    /* Those of version 7, which had no steps, and of version 6, which had no parts either. */
    assert_true(hash_of_many(stepless_gen, &ordinary) == 0xECB9F9B87FD91A67u);
    assert_true(hash_of_many(stepless_gen, &published) == 0x392B22C93A41DB69u);
    assert_true(hash_of_many(whole_gen, &ordinary) == 0x7B0361CE74869F45u);
    assert_true(hash_of_many(whole_gen, &published) == 0x44000F44487293E7u);
}

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void neighbours_share_nothing(void **state)
{
    (void)state;
    uint64_t hash[4 * 250];
    for (uint32_t i = 0; i < ARRAY_COUNT(hash); i++)
        hash[i] = hash_of(gen_trial, 1 + i / 250, i % 250, &ordinary);
    qsort(hash, ARRAY_COUNT(hash), sizeof *hash, by_value);
    for (uint32_t i = 1; i < ARRAY_COUNT(hash); i++)
        assert_true(hash[i] != hash[i - 1]);
}

/* --- sizes and members -------------------------------------------------------------------------
 */

static int by_size(const void *a, const void *b)
{
    return (int)*(const uint32_t *)a - (int)*(const uint32_t *)b;
}

static void ordinary_trials_have_16_to_64_triangles(void **state)
{
    (void)state;
    static const struct gen_options short_ones = {
        .triangles_least = 16, .triangles_most = 64, .rays = 4};
    static uint32_t size[20000];
    uint32_t few = 0, large = 0, edited = 0;
    for (uint32_t i = 0; i < ARRAY_COUNT(size); i++) {
        struct fuzz_trial trial = trial_of(3, i, &short_ones);
        size[i] = trial.scene.tri_count;
        bool limits = is_recipe(&trial, "records") || is_recipe(&trial, "items");
        bool tiny = is_recipe(&trial, "few");
        large += limits;
        few += tiny;
        edited += strchr(trial.origin.recipe, '+') != NULL;
        if (limits)
            assert_in_range(size[i], 10922, 65537);
        else if (tiny)
            assert_in_range(size[i], 0, 18);
        else
            assert_in_range(size[i], 13, 67); /* three edits drop or double */
        fuzz_trial_free(&trial);
    }
    qsort(size, ARRAY_COUNT(size), sizeof *size, by_size);
    print_message("%zu trials: median %u triangles, %u about limits, %u of 0 to 15, %u edited\n",
                  ARRAY_COUNT(size), size[ARRAY_COUNT(size) / 2], large, few, edited);
    assert_in_range(size[ARRAY_COUNT(size) / 2], 32, 48);
    assert_in_range(large, 4, 20);  /* 1 in 2048 */
    assert_in_range(few, 300, 550); /* 1 in 49 */
    assert_in_range(edited, 8000, 12000);
}

static void members_as_published_take_part_if_asked_for(void **state)
{
    (void)state;
    for (int faithful = 0; faithful < 2; faithful++) {
        struct gen_options options = {
            .triangles_least = 16, .triangles_most = 64, .rays = 4, .faithful = faithful};
        uint32_t seen[3][16] = {{0}}, queries[QUERY_COUNT] = {0}, leaves[17] = {0};
        for (uint32_t i = 0; i < 1000; i++) {
            struct fuzz_trial trial = trial_of(5, i, &options);
            for (uint32_t m = 0; builders_all[m]; m++)
                seen[0][m] += builders_all[m] == trial.builder;
            for (uint32_t m = 0; m < 8; m++) {
                seen[1][m] += m < 3 && box_tests[m] == trial.box;
                seen[2][m] += m < 5 && tri_tests[m] == trial.tri;
            }
            assert_in_range(trial.build.leaf, 1, 16);
            queries[trial.query]++;
            leaves[trial.build.leaf]++;
            fuzz_trial_free(&trial);
        }
        for (uint32_t m = 0; builders_all[m]; m++)
            assert_int_equal(seen[0][m] > 12, faithful || !builders_all[m]->faithful);
        for (uint32_t m = 0; box_tests[m]; m++)
            assert_int_equal(seen[1][m] > 100, faithful || !box_tests[m]->faithful);
        for (uint32_t m = 0; tri_tests[m]; m++)
            assert_int_equal(seen[2][m] > 80, faithful || !tri_tests[m]->faithful);
        for (uint32_t leaf = 1; leaf <= 8; leaf++)
            assert_true(leaves[leaf] > 20);
        assert_true(queries[QUERY_ANY] > 150 && queries[QUERY_CLOSEST] > 500);
    }
}

/* --- hits --------------------------------------------------------------------------------------
 */

struct fuzz_share {
    uint32_t rays, hits, contract;
};

static struct fuzz_share share_of(const struct fuzz_trial *trial)
{
    struct fuzz_share share = {.rays = trial->ray_count};
    struct oracle *oracle;
    struct reason reason;
    struct oracle_answer *answer = calloc(trial->ray_count, sizeof *answer);
    assert_non_null(answer);
    assert_int_equal(oracle_make(&trial->scene, &oracle, &reason), STATUS_OK);
    assert_int_equal(oracle_closest(oracle, ORACLE_AUTO, ORACLE_CLOSED, trial->ray,
                                    trial->ray_count, 1, answer, NULL, &reason),
                     STATUS_OK);
    for (uint32_t i = 0; i < trial->ray_count; i++) {
        share.hits += answer[i].prim != ABI_NO_PRIM;
        share.contract += ray_in_contract(&trial->ray[i]);
    }
    oracle_free(oracle);
    free(answer);
    return share;
}

static void trials_are_not_vacuous(void **state)
{
    (void)state;
    struct fuzz_share sum[64] = {{0}}, all = {0};
    uint32_t trials = getenv("RAYDIFF_SLOW") ? 4000 : 800;
    for (uint32_t i = 0; i < trials; i++) {
        struct fuzz_trial trial = trial_of(11, i, &ordinary);
        uint32_t r = 0;
        while (!is_recipe(&trial, recipes[r].name))
            r++;
        struct fuzz_share share = share_of(&trial);
        sum[r].rays += share.rays;
        sum[r].hits += share.hits;
        all.rays += share.rays;
        all.hits += share.hits;
        all.contract += share.contract;
        fuzz_trial_free(&trial);
    }
    for (uint32_t r = 0; recipes[r].name; r++)
        if (sum[r].rays > 0) {
            double hits = (double)sum[r].hits / sum[r].rays;
            print_message("%-12s %5.1f %% hits\n", recipes[r].name, 100 * hits);
            assert_true(hits > 0.1 && hits < 0.95);
        }
    double hits = (double)all.hits / all.rays, contract = (double)all.contract / all.rays;
    print_message("all %u rays: %.1f %% hits, %.1f %% in contract\n", all.rays, 100 * hits,
                  100 * contract);
    assert_true(hits > 0.3 && hits < 0.7);
    assert_true(contract > 0.98 && contract < 1);
}

/* --- speed -------------------------------------------------------------------------------------
 */

/* A figure, not a law: shared machines are slow at times. */
static void a_trial_takes_microseconds(void **state)
{
    (void)state;
    static const struct gen_options of_32 = {
        .triangles_least = 32, .triangles_most = 32, .rays = 500};
    struct timespec begin, end;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
    for (uint32_t i = 0; i < MANY; i++) {
        struct fuzz_trial trial = trial_of(13, i, &of_32);
        fuzz_trial_free(&trial);
    }
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
    double us =
        ((double)(end.tv_sec - begin.tv_sec) * 1e9 + (double)(end.tv_nsec - begin.tv_nsec)) / 1e3 /
        MANY;
    print_message("%.1f us of processor time a trial of 32 triangles and 500 rays\n", us);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_trial_depends_on_seed_and_index_only),
        cmocka_unit_test(impure_generators_are_caught),
        cmocka_unit_test(the_first_thousand_trials_are_what_they_were),
        cmocka_unit_test(neighbours_share_nothing),
        cmocka_unit_test(ordinary_trials_have_16_to_64_triangles),
        cmocka_unit_test(members_as_published_take_part_if_asked_for),
        cmocka_unit_test(trials_are_not_vacuous),
        cmocka_unit_test(a_trial_takes_microseconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

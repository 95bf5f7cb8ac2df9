/* Trials and signatures: copies, hashes, what no reader may let through, names of folders. */
#include "fuzz/play/signature.h"
#include "fuzz/play/trial.h"
#include "fuzz/campaign/worker_base.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

static struct fuzz_trial make(void)
{
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(3, 2, 2, &trial, &reason), STATUS_OK);
    for (int i = 0; i < 9; i++)
        trial.scene.vertex[i] = (float)(i * i % 5) - 1.5f;
    static const uint32_t index[] = {0, 1, 2, 2, 1, 0};
    memcpy(trial.scene.index, index, sizeof index);
    trial.ray[0] = (struct ray){{0, 1, 2}, 0, {1, -1, 0.5f}, 100};
    trial.ray[1] = (struct ray){{NAN, 1, INFINITY}, -0.0f, {0, 0, 0}, INFINITY};
    return trial;
}

static void trial_make_gives_members_and_zeroes(void **state)
{
    (void)state;
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(4, 2, 3, &trial, &reason), STATUS_OK);
    assert_int_equal(trial.scene.vertex_count, 4);
    assert_int_equal(trial.scene.tri_count, 2);
    assert_int_equal(trial.ray_count, 3);
    assert_ptr_equal(trial.builder, builders[0]);
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_OK);
    fuzz_trial_free(&trial);
    fuzz_trial_free(&trial);
    static const uint32_t over[][3] = {{3 * FUZZ_TRIANGLES_MOST + 1, 0, 0},
                                       {0, FUZZ_TRIANGLES_MOST + 1, 0},
                                       {0, 0, FUZZ_RAYS_MOST + 1}};
    for (size_t i = 0; i < ARRAY_COUNT(over); i++) {
        assert_int_equal(fuzz_trial_make(over[i][0], over[i][1], over[i][2], &trial, &reason),
                         STATUS_LIMIT);
        assert_null(trial.ray);
        assert_null(trial.scene.vertex);
    }
}

static void trial_copy_is_deep(void **state)
{
    (void)state;
    struct fuzz_trial trial = make(), copy;
    strcpy(trial.origin.recipe, "made by hand");
    assert_int_equal(fuzz_trial_copy(&trial, &copy, &reason), STATUS_OK);
    assert_int_equal(fuzz_trial_hash(&copy), fuzz_trial_hash(&trial));
    assert_string_equal(copy.origin.recipe, "made by hand");
    assert_memory_equal(copy.ray, trial.ray, 2 * sizeof *trial.ray);
    memset(trial.scene.vertex, 0, 36);
    memset(trial.scene.index, 0, 24);
    memset(trial.ray, 0, 2 * sizeof *trial.ray);
    assert_int_not_equal(fuzz_trial_hash(&copy), fuzz_trial_hash(&trial));
    fuzz_trial_free(&trial);
    assert_int_equal(copy.scene.index[3], 2);
    fuzz_trial_free(&copy);
}

/* Every bit of every number and every member counts; the origin does not. */
/* As bytes for a forked process: back to the bit; cut or longer ones are refused. */
static void trial_travels_as_bytes(void **state)
{
    (void)state;
    struct finding_file file = {.trial = make(), .has_signature = true}, again, bare = {0};
    fuzz_signature_set_engine(&file.signature, "cpu");
    file.signature.layout = layouts[1];
    file.signature.kind = FUZZ_KIND_BITS;
    strcpy(file.versions, "one\ntwo");
    size_t size = worker_base_bytes(&file);
    char *bytes = malloc(size + 1);
    assert_non_null(bytes);
    worker_base_put(&file, bytes);
    assert_int_equal(worker_base_get(bytes, size, &again, &reason), STATUS_OK);
    assert_int_equal(fuzz_trial_hash(&again.trial), fuzz_trial_hash(&file.trial));
    assert_true(fuzz_signature_same(&again.signature, &file.signature));
    assert_string_equal(again.versions, "one\ntwo");
    assert_ptr_not_equal(again.trial.ray, file.trial.ray);
    finding_file_free(&again);
    const size_t sizes[] = {0, sizeof file - 1, sizeof file, size - 1, size + 1};
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
        assert_int_equal(worker_base_get(bytes, sizes[i], &again, &reason), STATUS_INPUT);
        assert_null(again.trial.ray);
    }
    worker_base_put(&bare, bytes); /* no triangle, no ray */
    assert_int_equal(worker_base_get(bytes, worker_base_bytes(&bare), &again, &reason), STATUS_OK);
    assert_int_equal(again.trial.ray_count, 0);
    finding_file_free(&again);
    finding_file_free(&file);
    free(bytes);
}

static void trial_hash_sees_all_that_decides(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    uint64_t plain = fuzz_trial_hash(&trial);
    uint32_t *const words[] = {(uint32_t *)trial.scene.vertex, trial.scene.index,
                               (uint32_t *)trial.ray};
    static const size_t counts[] = {9, 6, 16};
    for (size_t part = 0; part < 3; part++)
        for (size_t i = 0; i < counts[part]; i++)
            for (int bit = 0; bit < 32; bit++) {
                words[part][i] ^= 1u << bit;
                assert_int_not_equal(fuzz_trial_hash(&trial), plain);
                words[part][i] ^= 1u << bit;
            }
    struct fuzz_trial other = trial;
    other.builder = builders[1];
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.box = box_tests[1];
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.tri = tri_tests[1];
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.query = QUERY_ANY;
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.build.leaf++;
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.build.eps = -other.build.eps;
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.build.passes = 1;
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.store = tri_stores[1];
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.move = 0.5f;
    uint64_t moved = fuzz_trial_hash(&other);
    assert_int_not_equal(moved, plain);
    for (int bit = 0; bit < 64; bit++) {
        other.move_seed = (uint64_t)1 << bit;
        assert_int_not_equal(fuzz_trial_hash(&other), moved);
    }
    other.move_seed = 0;
    other.move = 0.25f;
    assert_int_not_equal(fuzz_trial_hash(&other), moved);
    other = trial;
    other.ray_count--;
    assert_int_not_equal(fuzz_trial_hash(&other), plain);
    other = trial;
    other.origin = (struct fuzz_origin){1, 2, 3, true, "other"};
    assert_int_equal(fuzz_trial_hash(&other), plain);
    fuzz_trial_free(&trial);
}

static void trial_check_refuses_what_no_reader_may_pass(void **state)
{
    (void)state;
    struct fuzz_trial trial = make(), bad;
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_OK);
    bad = trial;
    bad.builder = NULL;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad = trial;
    bad.tri = NULL;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad = trial;
    bad.query = QUERY_ALL;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad = trial;
    bad.build.leaf = 0;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad = trial;
    bad.store = tri_store_find("edges");
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_OK);
    bad.tri = tri_test_find("woop");
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    static const float eps[] = {-1, NAN, INFINITY};
    for (size_t i = 0; i < ARRAY_COUNT(eps); i++) {
        bad = trial;
        bad.build.eps = eps[i];
        assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    }
    static const float move[] = {-1, NAN, INFINITY, 2 * FUZZ_MOVE_MOST};
    for (size_t i = 0; i < ARRAY_COUNT(move); i++) {
        bad = trial;
        bad.move = move[i];
        assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    }
    bad = trial;
    bad.store = NULL;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad = trial;
    bad.build.passes = FUZZ_PASSES_MOST;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_OK);
    bad.build.passes++;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    bad.build.passes = 1;
    bad.builder = builder_find("rtrs");
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "as published"));
    bad = trial;
    bad.scene.tri_count = FUZZ_TRIANGLES_MOST + 1;
    assert_int_equal(fuzz_trial_check(&bad, &reason), STATUS_LIMIT);
    trial.scene.index[5] = 3;
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_INPUT);
    trial.scene.index[5] = 0;
    trial.scene.vertex[8] = NAN;
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_INPUT);
    fuzz_trial_free(&trial);
}

static void smaller_is_fewer_then_rounder(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    struct fuzz_trial_size plain = fuzz_trial_size(&trial), other;
    assert_int_equal(fuzz_trial_size_compare(&plain, &plain), 0);
    trial.scene.vertex[0] = 0x1.000002p+0f; /* longer than any of make() */
    other = fuzz_trial_size(&trial);
    assert_true(fuzz_trial_size_compare(&plain, &other) < 0);
    trial.ray_count--; /* but a ray less */
    other = fuzz_trial_size(&trial);
    assert_true(fuzz_trial_size_compare(&plain, &other) > 0);
    trial.ray_count++;
    trial.scene.vertex[0] = 0;
    other = fuzz_trial_size(&trial);
    assert_true(fuzz_trial_size_compare(&plain, &other) > 0);
    static const float round[] = {0, 1, 2, 3, 7, 0.1f}; /* each longer than the one before */
    for (size_t i = 0; i < ARRAY_COUNT(round); i++) {
        struct fuzz_trial_size before = other;
        trial.scene.vertex[0] = round[i];
        other = fuzz_trial_size(&trial);
        if (i > 0)
            assert_true(before.bits < other.bits);
    }
    const struct fuzz_trial still = trial;
    struct fuzz_trial_size before = fuzz_trial_size(&still);
    for (int longer = 0; longer < 5; longer++) { /* than still; rest, seed, reinsertion, storage */
        trial.move = longer == 0 ? 1 : 0.1f;
        trial.move_seed = longer > 1;
        trial.build.passes = longer > 2;
        trial.store = tri_stores[longer > 3];
        other = fuzz_trial_size(&trial);
        assert_true(fuzz_trial_size_compare(&before, &other) < 0);
        before = other;
    }
    trial = still;
    fuzz_trial_free(&trial);
}

/* The first number that differs decides, in the order of docs/fuzzing.md. */
static void the_first_number_decides_which_is_smaller(void **state)
{
    (void)state;
    for (int first = 0; first < 7; first++)
        for (int second = first; second < 7; second++) {
            struct fuzz_trial_size size[2] = {{0}, {0}};
            for (int side = 0; side < 2; side++) {
                uint32_t n[7] = {5, 5, 5, 5, 5, 5, 5};
                n[second] += side == 0 ? 1 : 0;
                n[first] = side == 0 ? 4 : 6;
                size[side] = (struct fuzz_trial_size){.instances = n[0],
                                                      .triangles = n[1],
                                                      .rays = n[2],
                                                      .vertices = n[3],
                                                      .places = n[4],
                                                      .bits = n[5],
                                                      .hash = n[6]};
            }
            assert_true(fuzz_trial_size_compare(&size[0], &size[1]) < 0);
            assert_true(fuzz_trial_size_compare(&size[1], &size[0]) > 0);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trial_make_gives_members_and_zeroes),
        cmocka_unit_test(the_first_number_decides_which_is_smaller),
        cmocka_unit_test(trial_copy_is_deep),
        cmocka_unit_test(trial_travels_as_bytes),
        cmocka_unit_test(trial_hash_sees_all_that_decides),
        cmocka_unit_test(trial_check_refuses_what_no_reader_may_pass),
        cmocka_unit_test(smaller_is_fewer_then_rounder),
    };
    return cmocka_run_group_tests_name("fuzz_trial", tests, NULL, NULL);
}

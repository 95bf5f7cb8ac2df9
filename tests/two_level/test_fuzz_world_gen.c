/* The generator of worlds: a pure function of seed and index, and what it comes to. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/mutate.h"
#include "fuzz/play/coverage_bits.h"
#include "ref/base/float_mode.h"
#include "ref/oracle/oracle_world.h"
#include "scenes/worlds.h"

#include <cmocka.h>

#include "tests/two_level/fuzz_world_play.h"

#define MANY 1000u

static const struct gen_options usual = {
    .triangles_least = 16, .triangles_most = 64, .rays = 60, .worlds = true};

static uint64_t hash_of(uint64_t seed, uint64_t index)
{
    struct fuzz_trial trial = trial_of(seed, index, &usual);
    uint64_t hash = fuzz_trial_hash(&trial);
    fuzz_trial_free(&trial);
    return hash;
}

/* In order, then backwards on threads whose floating-point modes differ. */
static void a_world_depends_on_seed_and_index_only(void **state)
{
    (void)state;
    static uint64_t once[MANY], again[MANY];
    for (uint32_t i = 0; i < MANY; i++)
        once[i] = hash_of(7, i);
#pragma omp parallel for schedule(dynamic, 7) num_threads(4)
    for (uint32_t i = 0; i < MANY; i++) {
        unsigned long saved = float_mode();
        if (i % 3 == 1)
            float_mode_set(saved | FLOAT_FLUSH);
        if (i % 3 == 2)
            float_mode_set(saved | FLOAT_UP);
        again[MANY - 1 - i] = hash_of(7, MANY - 1 - i);
        float_mode_set(saved);
    }
    for (uint32_t i = 0; i < MANY; i++) {
        assert_true(once[i] == again[i]);
        assert_true(i == 0 || once[i] != once[i - 1]);
    }
    assert_true(hash_of(8, 0) != once[0]);
}

/* Other bytes need another GEN_VERSION. */
static void the_first_thousand_worlds_are_what_they_were(void **state)
{
    (void)state;
    const uint64_t golden = 0x1017ACF9145F6AD0u;
    uint64_t all = 0xCBF29CE484222325u;
    for (uint64_t i = 0; i < MANY; i++)
        all = (all ^ hash_of(1, i)) * 0x100000001B3u;
    if (all != golden)
        print_error("0x%016llXu\n", (unsigned long long)all);
    assert_int_equal(GEN_VERSION, 8);
    assert_true(all == golden);
}

/* Valid as made and after each of many edits, each of which changes it. */
static void every_world_and_every_edit_of_one_is_valid(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 300; i++) {
        struct reason reason = {""};
        struct fuzz_trial trial = trial_of(2, i, &usual);
        struct rng rng = rng_make(5, i);
        if (fuzz_trial_check(&trial, &reason))
            fail_msg("world %u: %s", (unsigned)i, reason.text);
        assert_true(trial.world.is);
        assert_int_equal(trial.ray_count, 60);
        for (int edit = 0; edit < 20; edit++) {
            uint64_t before = fuzz_trial_hash(&trial);
            assert_int_equal(gen_mutate(&rng, &trial, &reason), STATUS_OK);
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("world %u, %s: %s", (unsigned)i, trial.origin.recipe, reason.text);
            assert_true(fuzz_trial_hash(&trial) != before);
            assert_true(trial.origin.mutated && trial.move == 0);
        }
        fuzz_trial_free(&trial);
    }
}

/* Of the states of a world all are reached, and every generator of scenes/worlds is. */
static void every_state_of_worlds_is_reached(void **state)
{
    (void)state;
    uint64_t map[COVERAGE_WORDS] = {0};
    bool made[64] = {false};
    for (uint64_t i = 0; i < 2 * MANY; i++) {
        struct fuzz_trial trial = trial_of(3, i, &usual);
        coverage_add_world(map, &trial.world, trial.ray_count);
        for (size_t g = 0; world_generators[g]; g++)
            made[g] = made[g] || is_recipe(&trial, world_generators[g]->name);
        fuzz_trial_free(&trial);
    }
    for (uint32_t bit = COVERAGE_WORLD; bit <= COVERAGE_MODE_LAST; bit++)
        if (!(map[bit / 64] >> (bit % 64) & 1))
            fail_msg("bit %u of the groups of worlds", bit - COVERAGE_WORLD);
    for (size_t g = 0; world_generators[g]; g++)
        if (made[g] == world_generators[g]->undrawn)
            fail_msg("generator %s", world_generators[g]->name);
}

/* Rays: how many hit something of what they may meet, tie between instances, hit edges and
 * vertices. */
static void rays_are_aimed_at_what_is_placed(void **state)
{
    (void)state;
    size_t rays = 0, hits = 0, ties = 0, beside = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct reason reason = {""};
        struct fuzz_trial trial = trial_of(4, i, &usual);
        struct trial_meshes meshes;
        struct oracle *oracle;
        struct oracle_answer truth[60];
        assert_int_equal(trial_meshes_make(&trial.world, &trial.scene, &meshes, &reason),
                         STATUS_OK);
        assert_int_equal(oracle_make_world(&meshes.world, &oracle, &reason), STATUS_OK);
        assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, trial.ray,
                                              trial.world.mode, 60, 1, truth, NULL, &reason),
                         STATUS_OK);
        for (size_t k = 0; k < 60; k++) {
            rays++;
            hits += truth[k].prim != ABI_NO_PRIM;
            ties += truth[k].prim != ABI_NO_PRIM && truth[k].tie_count > 1;
            beside += truth[k].class == ORACLE_EDGE || truth[k].class == ORACLE_VERTEX;
        }
        oracle_free(oracle);
        trial_meshes_free(&meshes);
        fuzz_trial_free(&trial);
    }
    assert_true(hits > rays * 2 / 5);
    assert_true(ties > hits / 10);
    assert_true(beside > hits / 20);
}

/* The world of a trial has each mesh with its own vertices, and is the same as by hand. */
static void meshes_have_their_own_vertices(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 100; i++) {
        struct reason reason = {""};
        struct fuzz_trial trial = trial_of(6, i, &usual);
        struct trial_meshes meshes;
        uint32_t tri = 0;
        assert_int_equal(trial_meshes_make(&trial.world, &trial.scene, &meshes, &reason),
                         STATUS_OK);
        assert_int_equal(meshes.world.mesh_count, trial_world_meshes(&trial.world));
        for (uint32_t m = 0; m < meshes.world.mesh_count; m++) {
            const struct scene *scene = meshes.world.mesh[m].scene;
            uint32_t first, count;
            trial_world_mesh(&trial.world, m, &first, &count);
            assert_int_equal(first, tri);
            assert_int_equal(count, scene->tri_count);
            assert_true(scene->vertex_count <= 3 * count);
            for (uint32_t k = 0; k < count; k++, tri++) {
                float is[3][3], was[3][3];
                scene_tri(scene, k, is);
                scene_tri(&trial.scene, tri, was);
                assert_memory_equal(is, was, sizeof is);
            }
        }
        assert_int_equal(tri, trial.scene.tri_count);
        trial_meshes_free(&meshes);
        fuzz_trial_free(&trial);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_world_depends_on_seed_and_index_only),
        cmocka_unit_test(the_first_thousand_worlds_are_what_they_were),
        cmocka_unit_test(every_world_and_every_edit_of_one_is_valid),
        cmocka_unit_test(every_state_of_worlds_is_reached),
        cmocka_unit_test(rays_are_aimed_at_what_is_placed),
        cmocka_unit_test(meshes_have_their_own_vertices),
    };
    return cmocka_run_group_tests_name("fuzz_world_gen", tests, NULL, NULL);
}

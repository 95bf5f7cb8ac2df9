/* States that playing a trial reaches, against what the trial is made of: how each layout's tree
 * moved, and the packed tree of each mesh of a world. */
#include "fuzz/gen/gen.h"
#include "fuzz/play/coverage_bits.h"
#include "fuzz/play/trial_tree.h"

#include <math.h>

#include "tests/support/fuzz_trials.h"

static struct reason reason;
static struct fuzz_result result;

/* Of engine cpu on the layouts from one of the table on. */
static struct fuzz_player *player_of(const struct layout *const *layout, size_t count)
{
    static const struct engine_options options = {.device = -1, .threads = 1};
    static struct fuzz_field field;
    struct fuzz_player *player;
    const struct engine *const cpu = engine_find("cpu");
    if (fuzz_field_make(&cpu, 1, layout, count, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static void play(struct fuzz_player *player, const struct fuzz_trial *trial)
{
    if (fuzz_play(player, trial, 1, &result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
}

/* A tree that was refitted and one that was built again are states of their own, of whichever
 * layout. */
static void each_motion_of_a_layout_is_a_state(void **state)
{
    (void)state;
    size_t count = 0, mixed = 0;
    while (layouts[count])
        count++;
    for (size_t first = 0; first + 1 < count; first += 2) {
        struct fuzz_player *player = player_of(&layouts[first], count - first < 4 ? 2 : 4);
        for (uint32_t i = 0; i < 12; i++) {
            struct fuzz_trial trial;
            uint64_t wanted[COVERAGE_WORDS] = {0}, all[COVERAGE_WORDS] = {0};
            trial_make(3, i, 10, 40, 2, &trial);
            trial.move = i % 3 ? ldexpf(1, (int)(4 * i)) : 0;
            trial.move_seed = i;
            play(player, &trial);
            if (result.refitted)
                coverage_add_motion(wanted, false);
            if (result.rebuilt)
                coverage_add_motion(wanted, true);
            coverage_add_motion(all, false);
            coverage_add_motion(all, true);
            for (size_t w = 0; w < COVERAGE_WORDS; w++)
                assert_int_equal(result.coverage[w] & all[w], wanted[w]);
            mixed += result.refitted && result.rebuilt;
            fuzz_trial_free(&trial);
        }
        fuzz_player_close(player);
    }
    assert_true(mixed > 3);
}

/* What the packed tree of any of its meshes has, playing the world has reached. */
static void each_mesh_of_a_world_is_looked_at(void **state)
{
    (void)state;
    static const char *const names[] = {"rf16", "f32"};
    const struct gen_options options = {
        .triangles_least = 30, .triangles_most = 60, .rays = 4, .worlds = true};
    size_t alone = 0;
    for (uint32_t i = 0; i < 60; i++) {
        const struct layout *layout = layout_find(names[i % 2]);
        struct fuzz_trial trial;
        struct trial_meshes meshes;
        assert_non_null(layout);
        if (gen_trial(12, i, &options, &trial, &reason) ||
            trial_meshes_make(&trial.world, &trial.scene, &meshes, &reason))
            fail_msg("%s", reason.text);
        struct fuzz_player *player = player_of(&layout, 1);
        play(player, &trial);
        for (uint32_t m = 0; m < meshes.world.mesh_count && result.players; m++) {
            uint64_t map[COVERAGE_WORDS] = {0};
            struct packed packed;
            struct bvh bvh;
            if (bvh_build(trial.builder, &meshes.scene[m], &trial.build, &bvh, &reason) ||
                packed_make_stored(layout, trial.store, &bvh, &meshes.scene[m], &packed, &reason))
                fail_msg("%s", reason.text);
            coverage_add_packed(map, &packed);
            for (size_t w = 0; w < COVERAGE_WORDS; w++)
                assert_int_equal(map[w] & ~result.coverage[w], 0);
            alone += m > 0;
            packed_free(&packed);
            bvh_free(&bvh);
        }
        fuzz_player_close(player);
        trial_meshes_free(&meshes);
        fuzz_trial_free(&trial);
    }
    assert_true(alone > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_motion_of_a_layout_is_a_state),
        cmocka_unit_test(each_mesh_of_a_world_is_looked_at),
    };
    return cmocka_run_group_tests_name("play_coverage", tests, NULL, NULL);
}

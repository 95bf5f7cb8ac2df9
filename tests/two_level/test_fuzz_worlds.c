/* Trials of worlds are played as those of scenes are, and what cheats in a world is found by random
 * ones and shrunk to next to nothing. */
#include "fuzz/gen/gen.h"
#include "fuzz/shrink/shrink.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/two_level/world_cheats.h"

#define KIND(wrong) (1u << WRONG_##wrong)

static const struct gen_options of_worlds = {16, 40, 150, false, true};
static const struct gen_options of_scenes = {16, 40, 50, false, false};

static void make(uint64_t seed, uint64_t index, const struct gen_options *options,
                 struct fuzz_trial *out)
{
    struct reason reason = {""};
    if (gen_trial(seed, index, options, out, &reason))
        fail_msg("%s", reason.text);
}

static struct fuzz_player *open_all(const struct engine *const *engine, size_t engines_count,
                                    const struct layout *const *layout, size_t layouts_count)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    struct fuzz_field field;
    struct fuzz_player *player;
    if (fuzz_field_make(engine, engines_count, layout, layouts_count, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static void must_play(struct fuzz_player *player, const struct fuzz_trial *trial, size_t count,
                      struct fuzz_result *result)
{
    struct reason reason = {""};
    if (fuzz_play(player, trial, count, result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
}

/* --- honest engines --------------------------------------------------------------------------- */

static struct fuzz_player *open_ours(void)
{
    const struct engine *const who[] = {engine_reference(true), engine_find("brute")};
    const struct layout *const on[] = {layout_find("f32"), layout_find("rf16")};
    return open_all(who, 2, on, 2);
}

static void ours_are_right_in_every_world(void **state)
{
    (void)state;
    struct fuzz_player *player = open_ours();
    size_t judged = 0, refused = 0, hits = 0;
    for (uint64_t i = 0; i < 400; i++) {
        struct fuzz_trial trial;
        struct fuzz_result result;
        make(11, i, &of_worlds, &trial);
        must_play(player, &trial, 1, &result);
        if (result.finding_count)
            fail_msg("world %u (%s): %s", (unsigned)i, trial.origin.recipe,
                     fuzz_kind_name(result.finding[0].signature.kind));
        assert_int_equal(result.wrong, 0);
        judged += result.judged;
        refused += result.refused;
        hits += result.provers == 7 || (result.refused && result.provers == 5);
        fuzz_trial_free(&trial);
    }
    assert_int_equal(judged, 400 * 150);
    assert_in_range(refused, 1, 150); /* rf16 has no bounds over 65504 */
    assert_true(hits > 350);
    fuzz_player_close(player);
}

/* Scenes and worlds in one call, in any order, have the results that each has alone. */
static void what_is_played_together_makes_no_difference(void **state)
{
    (void)state;
    struct fuzz_player *player = open_ours();
    struct fuzz_trial trial[24];
    static struct fuzz_result together[24], alone;
    for (uint64_t i = 0; i < 24; i++)
        make(12, i, i % 5 < 2 ? &of_scenes : &of_worlds, &trial[i]);
    must_play(player, trial, 24, together);
    for (size_t i = 0; i < 24; i++) {
        must_play(player, &trial[i], 1, &alone);
        assert_memory_equal(alone.count, together[i].count, sizeof alone.count);
        assert_memory_equal(alone.coverage, together[i].coverage, sizeof alone.coverage);
        assert_int_equal(alone.judged, together[i].judged);
        assert_int_equal(alone.players, together[i].players);
        assert_true(alone.judged > 0);
        fuzz_trial_free(&trial[i]);
    }
    fuzz_player_close(player);
}

/* What traces scenes alone declines: that is no fault, and no answer. */
static void engines_of_scenes_decline_worlds(void **state)
{
    (void)state;
    const struct engine *const who[] = {engine_find("fast"), engine_reference(true)};
    const struct layout *const on[] = {layout_find("f32")};
    struct fuzz_player *player = open_all(who, 2, on, 1);
    struct fuzz_trial trial;
    struct fuzz_result result;
    assert_null(who[0]->worlds);
    make(13, 1, &of_worlds, &trial);
    must_play(player, &trial, 1, &result);
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(result.refusers, 1);
    assert_int_equal(result.decliners, 1);
    assert_int_equal(result.players, 2);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

/* A transform whose inverse is beyond float32: no engine of ours can take it. */
static void inverses_beyond_float32_are_declined(void **state)
{
    (void)state;
    struct fuzz_player *player = open_ours();
    struct fuzz_trial trial;
    struct fuzz_result result;
    make(13, 1, &of_worlds, &trial);
    struct instance *one = &trial.world.instance[0];
    memset(one->m, 0, sizeof one->m);
    one->mesh = 0;
    one->mask = 0xFF;
    one->m[0][0] = one->m[1][1] = 1;
    one->m[2][2] = 0x1p-140f;
    assert_int_equal(fuzz_trial_check(&trial, NULL), STATUS_OK);
    must_play(player, &trial, 1, &result);
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(result.players, 0);
    assert_int_equal(result.refusers, 7);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

/* --- cheats ----------------------------------------------------------------------------------- */

static struct fuzz_player *open_cheating(void)
{
    const struct engine *const who[] = {&cheating};
    return open_all(who, 1, NULL, 0);
}

/* What a cheat is found as, and how much of a world it needs. */
static const struct need {
    enum world_cheat cheat;
    const char *name;
    uint32_t kinds;
    uint32_t instances, triangles, places;
} needs[] = {
    {CHEAT_NO_MASK, "no mask", KIND(MASKED), 1, 1, 0},
    {CHEAT_MASK_EQUAL, "mask equal", KIND(MISSED), 1, 1, 0},
    {CHEAT_NO_SKIP, "no skip", KIND(MASKED), 1, 1, 0},
    {CHEAT_NO_CULL, "no cull", KIND(CULLED), 1, 1, 0},
    {CHEAT_NO_DISABLE, "no disable", KIND(MISSED), 1, 1, 0},
    {CHEAT_NO_FLIP, "no flip", KIND(FACING) | KIND(CULLED), 1, 1, 0},
    {CHEAT_MIRROR, "mirror", KIND(FACING) | KIND(CULLED), 1, 1, 2},
    {CHEAT_OTHER_FACE, "other face", KIND(FACING), 1, 1, 0},
    {CHEAT_NO_OPACITY_CULL, "no opacity cull", KIND(OPACITY), 1, 1, 0},
    {CHEAT_NO_FORCE, "no force", KIND(OPACITY) | KIND(MISSED), 1, 1, 0},
    {CHEAT_NO_RAY_OPACITY, "no ray opacity", KIND(OPACITY) | KIND(MISSED), 1, 1, 0},
    {CHEAT_NO_FILTER, "no filter", KIND(OPACITY), 1, 1, 0},
    {CHEAT_PASS_OVER, "pass over", KIND(MISSED), 1, 1, 0},
    {CHEAT_FIRST_PASSED, "first passed", KIND(MISSED), 2, 2, 0},
    {CHEAT_INSTANCE_0, "instance 0", KIND(MISSED), 1, 1, 0},
    {CHEAT_INDEX, "index", KIND(INSTANCE), 1, 1, 0},
    {CHEAT_CUT, "cut", KIND(INSTANCE), 1, 1, 0},
    {CHEAT_MISS_TAG, "miss tag", KIND(INSTANCE), 1, 1, 0},
    {CHEAT_NOT_CARRIED, "not carried", KIND(MISSED), 2, 2, 1},
    {CHEAT_LAST_TRANSFORM, "last transform", KIND(MISSED) | KIND(PHANTOM), 2, 1, 1},
    {CHEAT_LENGTH, "length", KIND(DISTANCE), 1, 1, 0},
};

/* Trials are played until one shows the cheat; returns how many. */
static uint32_t find(struct fuzz_player *player, const struct need *need, struct finding_file *out)
{
    for (uint32_t i = 0; i < 400; i++) {
        struct fuzz_result result;
        struct reason reason = {""};
        make(14, i, &of_worlds, &out->trial);
        must_play(player, &out->trial, 1, &result);
        for (size_t k = 0; k < result.finding_count; k++) {
            struct fuzz_finding *finding = &result.finding[k];
            if (finding->signature.kind >= FUZZ_KIND_BITS ||
                !(need->kinds >> finding->signature.kind & 1))
                continue;
            assert_int_equal(fuzz_explain(player, &out->trial, finding, &reason), STATUS_OK);
            assert_int_equal(finding->signature.cause, CAUSE_UNEXPLAINED);
            out->signature = finding->signature;
            out->has_signature = true;
            return i + 1;
        }
        fuzz_trial_free(&out->trial);
    }
    fail_msg("%s is not found", need->name);
    return 0;
}

struct steps {
    struct fuzz_player *player;
    enum fuzz_kind kind;
    uint64_t accepted;
    struct fuzz_trial_size last;
};

/* Each step is smaller than the one before, and still shows the kind. */
static void watch(void *user, const struct shrink_stats *stats, const struct fuzz_trial *best)
{
    struct steps *steps = user;
    struct fuzz_result result;
    bool shown = false;
    if (stats->accepted == steps->accepted)
        return;
    struct fuzz_trial_size size = fuzz_trial_size(best);
    assert_true(fuzz_trial_size_compare(&size, &steps->last) < 0);
    steps->accepted = stats->accepted;
    steps->last = size;
    assert_int_equal(fuzz_trial_check(best, NULL), STATUS_OK);
    must_play(steps->player, best, 1, &result);
    for (size_t i = 0; i < result.finding_count; i++)
        shown = shown || result.finding[i].signature.kind == steps->kind;
    assert_true(shown);
}

static void shrink_and_check(struct fuzz_player *player, const struct need *need,
                             const struct finding_file *found)
{
    struct reason reason = {""};
    struct steps steps = {player, found->signature.kind, 0, fuzz_trial_size(&found->trial)};
    struct shrink_options options = {.progress = watch, .user = &steps};
    struct finding_file small, again;
    struct shrink_stats stats;
    if (fuzz_shrink_finding(player, found, &options, &small, &stats, &reason))
        fail_msg("%s", reason.text);
    print_message("%s: %s: %u instances, %u triangles, %u rays, %u vertices, places %u, %u bits\n",
                  need->name, fuzz_kind_name(found->signature.kind), stats.after.instances,
                  stats.after.triangles, stats.after.rays, stats.after.vertices, stats.after.places,
                  (unsigned)stats.after.bits);
    assert_int_equal(stats.end, SHRINK_FIXPOINT);
    assert_true(steps.accepted > 0 && steps.accepted == stats.accepted);
    assert_int_equal(stats.after.rays, 1);
    assert_true(stats.after.instances <= need->instances);
    assert_true(stats.after.triangles <= need->triangles);
    assert_true(stats.after.places <= need->places);
    options.progress = NULL;
    if (fuzz_shrink_finding(player, &small, &options, &again, &stats, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(stats.accepted, 0);
    assert_int_equal(fuzz_trial_hash(&small.trial), fuzz_trial_hash(&again.trial));
    finding_file_free(&small);
    finding_file_free(&again);
}

static void every_cheat_is_found_and_shrunk_to_next_to_nothing(void **state)
{
    (void)state;
    struct fuzz_player *player = open_cheating();
    for (size_t i = 0; i < ARRAY_COUNT(needs); i++) {
        struct finding_file found = {.has_signature = false};
        cheater.cheat = needs[i].cheat;
        find(player, &needs[i], &found);
        shrink_and_check(player, &needs[i], &found);
        finding_file_free(&found);
    }
    fuzz_player_close(player);
}

static void an_honest_engine_is_not_found(void **state)
{
    (void)state;
    struct fuzz_player *player = open_cheating();
    static const enum world_cheat none[] = {CHEAT_NONE, CHEAT_NO_FIRST};
    for (uint64_t i = 0; i < 200; i++) {
        struct fuzz_trial trial;
        struct fuzz_result result;
        cheater.cheat = none[i % 2];
        make(15, i, &of_worlds, &trial);
        must_play(player, &trial, 1, &result);
        assert_int_equal(result.finding_count, 0);
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ours_are_right_in_every_world),
        cmocka_unit_test(what_is_played_together_makes_no_difference),
        cmocka_unit_test(engines_of_scenes_decline_worlds),
        cmocka_unit_test(inverses_beyond_float32_are_declined),
        cmocka_unit_test(every_cheat_is_found_and_shrunk_to_next_to_nothing),
        cmocka_unit_test(an_honest_engine_is_not_found),
    };
    return cmocka_run_group_tests_name("fuzz_worlds", tests, NULL, NULL);
}

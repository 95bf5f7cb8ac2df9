/* What cheats in a world is found by random trials, and shrunk to next to nothing. */
#include "fuzz/shrink/shrink.h"

#include "tests/two_level/fuzz_world_play.h"

#include "tests/two_level/world_cheats.h"

#define KIND(wrong) (1u << WRONG_##wrong)

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
        make_trial(14, i, &of_worlds, &out->trial);
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

struct watched_steps {
    struct fuzz_player *player;
    enum fuzz_kind kind;
    uint64_t accepted;
    struct fuzz_trial_size last;
};

/* Each step is smaller than the one before, and still shows the kind. */
static void watch(void *user, const struct shrink_stats *stats, const struct fuzz_trial *best)
{
    struct watched_steps *steps = user;
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
    struct watched_steps steps = {player, found->signature.kind, 0, fuzz_trial_size(&found->trial)};
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
        make_trial(15, i, &of_worlds, &trial);
        must_play(player, &trial, 1, &result);
        assert_int_equal(result.finding_count, 0);
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_cheat_is_found_and_shrunk_to_next_to_nothing),
        cmocka_unit_test(an_honest_engine_is_not_found),
    };
    return cmocka_run_group_tests_name("fuzz_world_cheats", tests, NULL, NULL);
}

/* Trials of worlds are played as those of scenes are: each answer judged, tags with it. */
#include "fuzz/play/scaled.h"
#include "ref/oracle/oracle_world.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/two_level/fuzz_world_play.h"

static const struct gen_options of_scenes = {
    .triangles_least = 16, .triangles_most = 40, .rays = 50};

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
        make_trial(11, i, &of_worlds, &trial);
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
        make_trial(12, i, i % 5 < 2 ? &of_scenes : &of_worlds, &trial[i]);
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
    const struct engine *const who[] = {engine_find("cpu_stackless"), engine_reference(true)};
    const struct layout *const on[] = {layout_find("f32")};
    struct fuzz_player *player = open_all(who, 2, on, 1);
    struct fuzz_trial trial;
    struct fuzz_result result;
    assert_null(who[0]->worlds);
    make_trial(13, 1, &of_worlds, &trial);
    must_play(player, &trial, 1, &result);
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(result.refusers, 1);
    assert_int_equal(result.decliners, 1);
    assert_int_equal(result.players, 2);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

static enum status blind_prepare(void *self, const struct world_job *job, struct reason *reason)
{
    (void)self, (void)job, (void)reason;
    return STATUS_OK;
}

static enum status blind_trace(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    (void)self, (void)ray, (void)mode, (void)report, (void)reason;
    for (size_t i = 0; i < ray_count; i++) {
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        tag[i] = 0;
    }
    return STATUS_OK;
}

static const struct world_tracer blind_worlds = {.prepare_world = blind_prepare,
                                                 .trace_world = blind_trace};

/* A transform whose inverse is beyond float32: nothing of ours can take or judge it, and what would
 * take it is not asked. */
static void inverses_beyond_float32_are_declined(void **state)
{
    (void)state;
    struct engine blind = *engine_find("brute");
    blind.name = "blind";
    blind.worlds = &blind_worlds;
    const struct engine *const who[] = {engine_reference(true), engine_find("brute"), &blind};
    const struct layout *const on[] = {layout_find("f32")};
    struct fuzz_player *player = open_all(who, 3, on, 1);
    struct fuzz_trial trial;
    struct fuzz_result result;
    make_trial(13, 1, &of_worlds, &trial);
    must_play(player, &trial, 1, &result);
    assert_int_equal(result.players, 7);
    assert_true(result.finding_count > 0); /* of the blind one */
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

/* What a trial is at another scale: the truth is the same, t times a power of two. */
static void scaled_worlds_have_the_same_truth(void **state)
{
    (void)state;
    uint32_t scaled = 0, hits = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct reason reason = {""};
        struct fuzz_trial trial[2];
        struct oracle_answer truth[2];
        bool possible;
        int power;
        make_trial(16, i, &of_worlds, &trial[0]);
        uint32_t ray = (uint32_t)i % trial[0].ray_count;
        assert_int_equal(fuzz_trial_scaled(&trial[0], ray, FUZZ_SCALE_ALL, FUZZ_SCALE_STEPS,
                                           &trial[1], &power, &possible, &reason),
                         STATUS_OK);
        for (uint32_t k = 0; k < 2 && possible; k++) {
            struct trial_meshes meshes;
            struct oracle *oracle;
            const struct fuzz_trial one = fuzz_trial_rays_from(&trial[k], k ? 0 : ray, 1);
            assert_int_equal(trial_meshes_make(&one.world, &one.scene, &meshes, &reason),
                             STATUS_OK);
            assert_int_equal(oracle_make_world(&meshes.world, &oracle, &reason), STATUS_OK);
            assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, one.ray,
                                                  one.world.mode, 1, 1, &truth[k], NULL, &reason),
                             STATUS_OK);
            oracle_free(oracle);
            trial_meshes_free(&meshes);
        }
        if (possible) {
            scaled++;
            hits += truth[0].prim != ABI_NO_PRIM;
            assert_int_equal(truth[0].prim, truth[1].prim);
            assert_true(truth[0].prim == ABI_NO_PRIM ||
                        ldexp(truth[0].t_lo, power) == truth[1].t_lo);
            fuzz_trial_free(&trial[1]);
        }
        fuzz_trial_free(&trial[0]);
    }
    assert_true(scaled > 200 && hits > 60);
}

/* --- answers that are meddled with ------------------------------------------------------------ */

/* Engine cpu with something done to what it answers, or to what it takes. */
static struct {
    uint32_t turned; /* bits of each tag of a hit */
    bool declines;
} meddler;

static enum status meddled_prepare(void *self, const struct world_job *job, struct reason *reason)
{
    if (meddler.declines)
        return (fail)(reason, STATUS_UNSUPPORTED, "not such a world");
    return engine_reference(true)->worlds->prepare_world(self, job, reason);
}

static enum status meddled_trace(void *self, const struct ray *ray, const struct ray_mode *mode,
                                 size_t ray_count, struct hit *hit, uint32_t *tag,
                                 struct trace_report *report, struct reason *reason)
{
    enum status status = engine_reference(true)->worlds->trace_world(self, ray, mode, ray_count,
                                                                     hit, tag, report, reason);
    for (size_t i = 0; i < ray_count; i++)
        tag[i] ^= hit[i].prim == ABI_NO_PRIM ? 0 : meddler.turned;
    return status;
}

static const struct world_tracer meddled_worlds = {.prepare_world = meddled_prepare,
                                                   .trace_world = meddled_trace};

/* A tag alone makes an answer WRONG, and other bits than cpu's, though the hits are cpu's. */
static void a_tag_alone_is_a_finding(void **state)
{
    (void)state;
    struct engine meddled = *engine_reference(true);
    meddled.name = "meddled";
    meddled.reference = false;
    meddled.worlds = &meddled_worlds;
    const struct engine *const who[] = {engine_reference(true), &meddled};
    const struct layout *const on[] = {layout_find("f32")};
    struct fuzz_player *player = open_all(who, 2, on, 1);
    struct fuzz_trial trial;
    struct fuzz_result result;
    make_trial(13, 1, &of_worlds, &trial);
    for (uint32_t round = 0; round < 2; round++) {
        meddler.turned = round ? 1 : 0;
        must_play(player, &trial, 1, &result);
        bool instance = false, bits = false;
        for (size_t i = 0; i < result.finding_count; i++) {
            const struct fuzz_finding *one = &result.finding[i];
            assert_int_equal(one->contestant, 1);
            instance = instance || one->signature.kind == fuzz_kind_of_wrong(WRONG_INSTANCE);
            bits = bits || one->signature.kind == FUZZ_KIND_BITS;
        }
        assert_int_equal(instance, round);
        assert_int_equal(bits, round);
    }
    meddler.declines = true;
    must_play(player, &trial, 1, &result);
    meddler.declines = false;
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(result.decliners, 2);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

/* --- lines ------------------------------------------------------------------------------------ */

/* " got", the place of a placed triangle by ref/world, then " custom" and the rest of the tag. */
static void put_expected(const struct world *world, uint32_t prim, uint32_t tag, uint32_t expected,
                         char *text, size_t size)
{
    const struct place got = world_place(world, prim), other = world_place(world, expected);
    snprintf(
        text, size,
        ", got instance %u geometry %u triangle %u custom %u %s, expected instance %u geometry "
        "%u triangle %u",
        got.instance, got.geometry, got.tri, tag & ABI_TAG_CUSTOM,
        tag & ABI_TAG_FRONT ? "front" : "back", other.instance, other.geometry, other.tri);
}

/* In worlds of several meshes and geometries, some empty, some placed often or not at all. */
static void a_line_has_the_places_of_both_triangles(void **state)
{
    (void)state;
    size_t later = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct fuzz_trial trial = trial_of(17, i, &of_worlds);
        struct trial_meshes meshes;
        struct reason reason = {""};
        char line[600], want[300];
        assert_int_equal(trial_meshes_make(&trial.world, &trial.scene, &meshes, &reason),
                         STATUS_OK);
        const uint32_t all = world_tri_count(&meshes.world);
        for (uint32_t k = 0; k < 200 && k < all; k++) {
            const uint32_t prim = k * 37 % all, expected = all - 1 - prim;
            const struct place place = world_place(&meshes.world, prim);
            const struct fuzz_finding finding = {
                .answer = {.prim = prim},
                .tag = k * 0x10204081u,
                .judgement = {.verdict = VERDICT_WRONG, .expected = expected}};
            fuzz_finding_line(&trial, &finding, line, sizeof line);
            put_expected(&meshes.world, prim, finding.tag, expected, want, sizeof want);
            if (!strstr(line, want))
                fail_msg("world %u: %s, not %s", (unsigned)i, line, want);
            later += place.mesh > 0 && place.geometry > 0;
        }
        trial_meshes_free(&meshes);
        fuzz_trial_free(&trial);
    }
    assert_true(later > 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ours_are_right_in_every_world),
        cmocka_unit_test(what_is_played_together_makes_no_difference),
        cmocka_unit_test(engines_of_scenes_decline_worlds),
        cmocka_unit_test(inverses_beyond_float32_are_declined),
        cmocka_unit_test(scaled_worlds_have_the_same_truth),
        cmocka_unit_test(a_tag_alone_is_a_finding),
        cmocka_unit_test(a_line_has_the_places_of_both_triangles),
    };
    return cmocka_run_group_tests_name("fuzz_worlds", tests, NULL, NULL);
}

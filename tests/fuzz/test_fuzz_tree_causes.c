/* The cause of bytes that are no tree, where one bound is wrong: of each end, on each axis, what
 * became of it. */
#include "fuzz/play/player.h"
#include "ref/layout.h"

#include <math.h>

#include "tests/support/fuzz_trials.h"

enum spoil { SPOIL_NOTHING, SPOIL_INFINITE, SPOIL_NAN, SPOIL_ZERO, SPOIL_ULP, SPOIL_FAR };

static struct {
    enum spoil how;
    int axis;
    bool upper;
} spoilt;

static float spoilt_bound(float x, float inward)
{
    switch (spoilt.how) {
    case SPOIL_NOTHING:
        return x;
    case SPOIL_INFINITE:
        return inward;
    case SPOIL_NAN:
        return NAN;
    case SPOIL_ZERO:
        return 0;
    case SPOIL_ULP:
        return nextafterf(x, inward);
    case SPOIL_FAR:
        return x + (inward > 0 ? 0.25f : -0.25f);
    }
    return x;
}

/* Packs as f32 does, then spoils a bound of the last record, which is a leaf. */
static enum status spoiling_pack(const struct layout *self, const struct bvh *bvh,
                                 const struct scene *scene, struct packed *out,
                                 struct reason *reason)
{
    const struct layout *f32 = layout_find("f32");
    (void)self;
    enum status status = f32->pack(f32, bvh, scene, out, reason);
    if (status)
        return status;
    uint32_t *word = out->word + 8 * (size_t)(out->node_count - 1);
    uint32_t *bound = word + spoilt.axis + (spoilt.upper ? 4 : 0);
    *bound = float_bits(spoilt_bound(float_from_bits(*bound), spoilt.upper ? -INFINITY : INFINITY));
    return STATUS_OK;
}

/* The cause of the finding about the tree; CAUSE_COUNT: there is none. */
static enum cause cause_of(struct fuzz_player *player, const struct fuzz_trial *trial)
{
    static struct fuzz_result result;
    struct reason reason = {""};
    assert_int_equal(fuzz_play(player, trial, 1, &result, NULL, NULL, &reason), STATUS_OK);
    for (size_t i = 0; i < result.finding_count; i++)
        if (result.finding[i].signature.kind == FUZZ_KIND_TREE) {
            struct fuzz_finding finding = result.finding[i];
            assert_int_equal(fuzz_explain(player, trial, &finding, &reason), STATUS_OK);
            return finding.signature.cause;
        }
    return CAUSE_COUNT;
}

/* 16 triangles of size 1, and a box around each leaf whose ends are no zeros; all times `scale`. */
static struct fuzz_trial stairs(float scale)
{
    struct fuzz_trial trial;
    trial_make(3, 1, 16, 16, 4, &trial);
    trial.builder = builder_find("median");
    trial.build.leaf = 2;
    scene_free(&trial.scene);
    assert_int_equal(scene_make(48, 16, &trial.scene), STATUS_OK);
    for (uint32_t i = 0; i < 48; i++) {
        trial.scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            trial.scene.vertex[3 * i + k] = scale * (0.75f + (float)(i / 3) + (i % 3 == k));
    }
    return trial;
}

static void a_bound_that_is_wrong_has_its_cause(void **state)
{
    (void)state;
    static const struct {
        enum spoil how;
        float scale;
        enum cause cause;
    } cases[] = {
        {SPOIL_NOTHING, 1, CAUSE_COUNT},      {SPOIL_INFINITE, 1, CAUSE_HALF_OVERFLOW},
        {SPOIL_NAN, 1, CAUSE_HALF_OVERFLOW},  {SPOIL_ZERO, 0x1p-19f, CAUSE_HALF_SUBNORMAL_FLUSHED},
        {SPOIL_ULP, 1, CAUSE_ROUNDED_INWARD}, {SPOIL_ULP, 0x1p9f, CAUSE_ROUNDED_INWARD},
        {SPOIL_FAR, 1, CAUSE_STORED_BOX}};
    struct layout layout = *layout_find("f32");
    layout.name = "spoilt";
    layout.pack = spoiling_pack;
    const struct layout *of[] = {&layout};
    const struct engine *engine = engine_find("cpu");
    const struct engine_options options = {.device = -1, .threads = 1};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason;
    if (fuzz_field_make(&engine, 1, of, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < 6 * ARRAY_COUNT(cases); i++) {
        struct fuzz_trial trial = stairs(cases[i / 6].scale);
        spoilt.how = cases[i / 6].how;
        spoilt.axis = (int)(i % 3);
        spoilt.upper = i % 6 >= 3;
        /* Zero lies below all coordinates: it is wrong at the upper end alone. */
        enum cause wanted =
            cases[i / 6].how == SPOIL_ZERO && !spoilt.upper ? CAUSE_COUNT : cases[i / 6].cause;
        enum cause is = cause_of(player, &trial);
        if (is != wanted)
            fail_msg("case %zu, axis %d, %s end: %s", i / 6, spoilt.axis,
                     spoilt.upper ? "upper" : "lower", is < CAUSE_COUNT ? cause_name(is) : "none");
        fuzz_trial_free(&trial);
    }
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bound_that_is_wrong_has_its_cause),
    };
    return cmocka_run_group_tests_name("fuzz_tree_causes", tests, NULL, NULL) ? 1 : 0;
}

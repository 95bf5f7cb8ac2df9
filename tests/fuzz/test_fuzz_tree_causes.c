/* The cause of bytes that are no tree: where one bound is wrong, of each end, on each axis, what
 * became of it; where triangles' numbers and references are, what most of them have become. */
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

/* --- numbers and references --- */

enum harm { HARM_CUT, HARM_NONE, HARM_OTHER, HARM_REF_CUT, HARM_REF_OTHER, HARMS };

static const enum cause harm_cause[HARMS] = {CAUSE_INDEX_TRUNCATED, CAUSE_SENTINEL,
                                             CAUSE_WRONG_ITEM, CAUSE_REFERENCE_TRUNCATED,
                                             CAUSE_CHILD_REFERENCE};

#define CUT_AT 0x8000u /* a field of 15 bits */

static uint32_t harmed[HARMS]; /* how many, of each kind */

static uint32_t harmed_number(enum harm how, uint32_t number)
{
    switch (how) {
    case HARM_CUT:
    case HARM_REF_CUT:
        return number - CUT_AT;
    case HARM_NONE:
        return ABI_NO_PRIM;
    case HARM_OTHER:
        return number ^ 0x40;
    default:
        return number - 4;
    }
}

/* Packs as f32 does, then harms numbers above CUT_AT, a different one each time. */
static enum status harming_pack(const struct layout *self, const struct bvh *bvh,
                                const struct scene *scene, struct packed *out,
                                struct reason *reason)
{
    const struct layout *f32 = layout_find("f32");
    (void)self;
    enum status status = f32->pack(f32, bvh, scene, out, reason);
    if (status)
        return status;
    uint32_t item = 0, node = 0;
    for (enum harm how = HARM_CUT; how < HARMS; how++)
        for (uint32_t done = 0; done < harmed[how]; done++) {
            uint32_t *number;
            if (how < HARM_REF_CUT) {
                while (out->item[item] <= CUT_AT + 0x40)
                    item++;
                number = &out->item[item++];
            } else { /* above leaves, so that nothing but one of them is lost */
                while (bvh->node[node].item_count > 0 || bvh->node[node].snd <= CUT_AT + 4 ||
                       bvh->node[node + 1].item_count == 0)
                    node++;
                number = &out->word[8 * (size_t)node++ + 3];
            }
            *number = harmed_number(how, *number);
        }
    return STATUS_OK;
}

/* 40000 triangles in a row, one to a leaf. */
static struct fuzz_trial row(void)
{
    enum { COUNT = 40000 };
    struct fuzz_trial trial;
    trial_make(3, 1, 16, 16, 1, &trial);
    trial.builder = builder_find("median");
    trial.build.leaf = 1;
    scene_free(&trial.scene);
    assert_int_equal(scene_make(3 * COUNT, COUNT, &trial.scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * COUNT; i++) {
        trial.scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            trial.scene.vertex[3 * i + k] = (float)(k == 0 ? i / 3 : 0) + 0.5f * (i % 3 == k);
    }
    return trial;
}

static void the_most_frequent_fault_is_the_cause(void **state)
{
    (void)state;
    struct layout layout = *layout_find("f32");
    layout.name = "harmed";
    layout.pack = harming_pack;
    const struct layout *of[] = {&layout};
    const struct engine *engine = engine_find("cpu");
    const struct engine_options options = {.device = -1, .threads = 1};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason;
    struct fuzz_trial trial = row();
    if (fuzz_field_make(&engine, 1, of, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    for (int a = 0; a < HARMS; a++)
        for (int b = a; b < HARMS; b++) {
            memset(harmed, 0, sizeof harmed);
            harmed[a] = 2;
            harmed[b] += a == b ? 0 : 1 + (uint32_t)(a + b) % 3; /* fewer, as many, more */
            int most = harmed[b] > harmed[a] ? b : a;
            if (a != b && harmed[a] == harmed[b]) /* the first of equal ones */
                most = harm_cause[a] < harm_cause[b] ? a : b;
            enum cause is = cause_of(player, &trial);
            if (is != harm_cause[most])
                fail_msg("%u of %s, %u of %s: %s", harmed[a], cause_name(harm_cause[a]), harmed[b],
                         cause_name(harm_cause[b]), is < CAUSE_COUNT ? cause_name(is) : "none");
        }
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bound_that_is_wrong_has_its_cause),
        cmocka_unit_test(the_most_frequent_fault_is_the_cause),
    };
    return cmocka_run_group_tests_name("fuzz_tree_causes", tests, NULL, NULL) ? 1 : 0;
}

/* RTRS's faults come up in a campaign: of the stream of trials on its layouts each shows as a
 * signature of its own, with its own cause, and nothing is left unexplained. */
#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

/* With another version of the generators the large trials that F9 needs, 1 in 2048, lie elsewhere:
 * then another seed. */
#define SEED 3u
#define MOST 3072u /* trials in which all must have been seen */

struct seed_known {
    const char *fault, *signature;
};

/* docs/rtrs-faults.md, is this table. */
static const struct seed_known required[] = {
    {"F2", "cpu.rtrs_rf.missed.index_shifted"},
    {"F3", "cpu.rtrs_direct.missed.wrong_item"},
    {"F5", "cpu.rtrs_rf.missed.cut_box"},
    {"F5", "cpu.rtrs_direct.missed.cut_box"},
    {"F6", "cpu.rtrs_rf.refused.item_as_node"},
    {"F7", "cpu.rtrs_rf.missed.slot_not_read"},
    {"F8", "cpu.rtrs_rf.refused.leaf_overfull"},
    {"F9", "cpu.rtrs_rf.missed.reference_truncated"},
    {"F11", "cpu.rtrs_rf.missed.rounded_inward"},
    {"F12", "cpu.rtrs_rf.missed.half_overflow"},
    {"F14", "cpu.rtrs_rf.missed.strict_comparison"},
    {"F14", "cpu.rtrs_direct.missed.strict_comparison"},
    {"F16", "cpu.rtrs_rf.missed.determinant_threshold"},
    {"F16", "cpu.rtrs_direct.missed.determinant_threshold"},
};

/* Other ways in which they show. F2 on its own: the null triangle that shifts all others is slot 0
 * of the direct layout, and with hardly any triangles nothing tells a shift from an empty slot. F3
 * where the tree keeps the order: only the shift is left; where the tree is split it has more slots
 * than RTRS has triangles. F10 needs 65537 triangles. */
static const struct seed_known other[] = {
    {"F2", "cpu.rtrs_rf.tree.index_shifted"},        {"F2", "cpu.rtrs_rf.tree.sentinel"},
    {"F2", "cpu.rtrs_rf.missed.sentinel"},           {"F2", "cpu.rtrs_direct.tree.sentinel"},
    {"F2", "cpu.rtrs_direct.missed.sentinel"},       {"F2", "cpu.rtrs_direct.tree.index_shifted"},
    {"F2", "cpu.rtrs_direct.missed.index_shifted"},  {"F3", "cpu.rtrs_direct.tree.wrong_item"},
    {"F10", "cpu.rtrs_rf.missed.index_truncated"},   {"F15", "cpu.rtrs_rf.missed.parallel_axis"},
    {"F15", "cpu.rtrs_direct.missed.parallel_axis"}, {"F3", "cpu.rtrs_direct.missed.slot_not_read"},
};

static size_t find(const struct seed_known *known, size_t count, const char *signature)
{
    size_t i = 0;
    while (i < count && strcmp(known[i].signature, signature) != 0)
        i++;
    return i;
}

struct seed_campaign {
    struct fuzz_player *player;
    struct gen_options options;
    struct fuzz_trial trial[FUZZ_BATCH];
    struct fuzz_result result[FUZZ_BATCH];
    bool seen[ARRAY_COUNT(required)];
    size_t left, findings;
};

static void campaign_open(struct seed_campaign *c, const char *a, const char *b, bool faithful)
{
    const struct engine *engine = engine_find("cpu");
    const struct layout *layout[] = {layout_find(a), layout_find(b)};
    const struct engine_options options = {.threads = 1};
    struct fuzz_field field;
    struct reason reason;
    *c = (struct seed_campaign){
        .options = {.triangles_least = 16, .triangles_most = 64, .rays = 500, .faithful = faithful},
        .left = ARRAY_COUNT(required)};
    if (fuzz_field_make(&engine, 1, layout, 2, &options, &field, &reason) ||
        fuzz_player_open(&field, &c->player, &reason))
        fail_msg("%s", reason.text);
}

static void take(struct seed_campaign *c, const struct fuzz_trial *trial,
                 struct fuzz_finding *finding)
{
    struct reason reason;
    char signature[FUZZ_SIGNATURE_MOST];
    if (fuzz_explain(c->player, trial, finding, &reason))
        fail_msg("%s", reason.text);
    fuzz_signature_print(&finding->signature, signature);
    c->findings++;
    size_t at = find(required, ARRAY_COUNT(required), signature);
    if (at < ARRAY_COUNT(required)) {
        c->left -= !c->seen[at];
        c->seen[at] = true;
    } else if (find(other, ARRAY_COUNT(other), signature) == ARRAY_COUNT(other)) {
        fail_msg("trial %llu, ray %u: %s is no fault of RTRS",
                 (unsigned long long)trial->origin.index, finding->ray, signature);
    }
}

static void play(struct seed_campaign *c, uint64_t first)
{
    struct reason reason;
    for (size_t i = 0; i < FUZZ_BATCH; i++)
        if (gen_trial(SEED, first + i, &c->options, &c->trial[i], &reason))
            fail_msg("%s", reason.text);
    if (fuzz_play(c->player, c->trial, FUZZ_BATCH, c->result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < FUZZ_BATCH; i++) {
        for (size_t k = 0; k < c->result[i].finding_count; k++)
            take(c, &c->trial[i], &c->result[i].finding[k]);
        fuzz_trial_free(&c->trial[i]);
    }
}

static struct seed_campaign campaign;

static void each_fault_is_a_signature_with_its_cause(void **state)
{
    (void)state;
    struct seed_campaign *c = &campaign;
    campaign_open(c, "rtrs_rf", "rtrs_direct", true);
    for (uint64_t first = 0; first < MOST && c->left > 0; first += FUZZ_BATCH)
        play(c, first);
    for (size_t i = 0; i < ARRAY_COUNT(required); i++)
        if (!c->seen[i])
            fail_msg("%s, %s: not seen in %u trials", required[i].fault, required[i].signature,
                     MOST);
    assert_true(c->findings > 1000);
    fuzz_player_close(c->player);
}

/* The same engine and stream: it is the layouts and members that have the faults. */
static void repaired_ones_have_none(void **state)
{
    (void)state;
    struct seed_campaign *c = &campaign;
    campaign_open(c, "f32", "rf16", false);
    for (uint64_t first = 0; first < 128; first += FUZZ_BATCH)
        play(c, first);
    assert_int_equal(c->findings, 0);
    fuzz_player_close(c->player);
}

/* What rf16 and the paper's record refuse is their documented limit. */
static void an_end_is_a_finding_only_of_the_layout_that_has_it(void **state)
{
    (void)state;
    struct seed_campaign *c = &campaign;
    size_t refused = 0;
    campaign_open(c, "rf16", "rtrs_rf_paper", true);
    struct reason reason;
    for (uint64_t i = 0; i < FUZZ_BATCH; i++)
        if (gen_trial(SEED, i, &c->options, &c->trial[i], &reason))
            fail_msg("%s", reason.text);
    if (fuzz_play(c->player, c->trial, FUZZ_BATCH, c->result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < FUZZ_BATCH; i++) {
        refused += c->result[i].refused;
        for (size_t k = 0; k < c->result[i].finding_count; k++)
            assert_int_not_equal(c->result[i].finding[k].signature.kind, FUZZ_KIND_REFUSED);
        fuzz_trial_free(&c->trial[i]);
    }
    assert_true(refused > 0);
    fuzz_player_close(c->player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fault_is_a_signature_with_its_cause),
        cmocka_unit_test(repaired_ones_have_none),
        cmocka_unit_test(an_end_is_a_finding_only_of_the_layout_that_has_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Who meets whom: which pairs can, that the rarest are drawn, and what the drawn trials are. */
#include "fuzz/feedback/pair_coverage.h"

#include "fuzz/play/trial_tree.h"
#include "fuzz/campaign/worker.h"

#include <setjmp.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/fuzz/pair_fixture.h"
#include "ref/packed/packed_check.h"

static bool can(const struct pair_coverage *m, enum pair_factor a, const char *x,
                enum pair_factor b, const char *y)
{
    bool possible = pair_coverage_of_pair(m, a, named(m, a, x), b, named(m, b, y))->possible;
    assert_int_equal(possible,
                     pair_coverage_of_pair(m, b, named(m, b, y), a, named(m, a, x))->possible);
    return possible;
}

static void what_rules_refuse_cannot_meet(void **state)
{
    (void)state;
    struct pair_coverage *m = open_all();
    assert_true(can(m, MEET_ENGINE, "cpu", MEET_LAYOUT, "bvh8_u8_node"));
    assert_true(can(m, MEET_ENGINE, "cpu_stackless", MEET_LAYOUT, "f32"));
    assert_false(can(m, MEET_ENGINE, "cpu_stackless", MEET_LAYOUT, "bvh8_u8_node"));
    assert_false(can(m, MEET_ENGINE, "brute", MEET_LAYOUT, "f32"));
    assert_false(can(m, MEET_ENGINE, "brute", MEET_BUILDER, "median"));
    assert_true(can(m, MEET_ENGINE, "brute", MEET_TRI, "pluecker"));
    assert_false(can(m, MEET_ENGINE, "embree_robust", MEET_TRI, "mt"));
    assert_false(can(m, MEET_ENGINE, "fast", MEET_TRI, "mt"));
    assert_true(can(m, MEET_ENGINE, "fast", MEET_STORE, "compact"));
    assert_false(can(m, MEET_LAYOUT, "rf16", MEET_STORE, "gathered"));
    assert_true(can(m, MEET_LAYOUT, "f32", MEET_STORE, "gathered"));
    assert_false(can(m, MEET_STORE, "edges", MEET_TRI, "woop"));
    assert_true(can(m, MEET_STORE, "edges", MEET_TRI, "mt"));
    assert_false(can(m, MEET_STORE, "quantised", MEET_MOTION, "moved"));
    assert_true(can(m, MEET_STORE, "compact", MEET_MOTION, "moved"));
    pair_coverage_close(m);
}

/* A pair is of two members that some engine here runs: Embree runs none of the tables, and is drawn
 * for itself where motions are. */
static void what_no_engine_runs_cannot_meet(void **state)
{
    (void)state;
    struct pair_coverage *all = open_all(), *m;
    struct pair_tables tables = all->tables;
    tables.member[MEET_ENGINE][0] = engine_find("embree");
    tables.count[MEET_ENGINE] = 1;
    tables.count[MEET_MOTION] = 1;
    assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_OK);
    assert_int_equal(pair_coverage_summarize(m, 0).possible, 0);
    pair_coverage_close(m);
    tables.count[MEET_MOTION] = 2;
    assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_OK);
    assert_int_equal(pair_coverage_summarize(m, 0).possible, 1);
    assert_true(can(m, MEET_ENGINE, "embree", MEET_MOTION, "still"));
    pair_coverage_close(m);
    tables.member[MEET_ENGINE][0] = engine_find("fast"); /* walks trees with tests of its own */
    assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_OK);
    assert_true(can(m, MEET_LAYOUT, "f32", MEET_BUILDER, "median"));
    assert_false(can(m, MEET_LAYOUT, "f32", MEET_TRI, "mt"));
    assert_false(can(m, MEET_BUILDER, "median", MEET_BOX, "robust"));
    pair_coverage_close(m);
    pair_coverage_close(all);
}

/* What is drawn can be traced, and every pair that is possible comes up equally often. */
static void rarest_pairs_are_drawn(void **state)
{
    (void)state;
    struct pair_coverage *m = open_all();
    const struct pair_tables *t = pair_coverage_tables(m);
    const uint32_t trials = 64, wanted = 4 * trials;
    uint32_t turns = 0;
    for (; turns < 4000 && pair_coverage_summarize(m, wanted).below > 0; turns++) {
        struct combination drawn;
        pair_coverage_draw(m, 7, turns, trials, &drawn);
        const struct engine *engine = t->member[MEET_ENGINE][drawn.member[MEET_ENGINE]];
        struct combination met =
            pair_coverage_of(m, engine, t->member[MEET_LAYOUT][drawn.member[MEET_LAYOUT]],
                             t->member[MEET_BUILDER][drawn.member[MEET_BUILDER]],
                             t->member[MEET_STORE][drawn.member[MEET_STORE]],
                             t->member[MEET_TRI][drawn.member[MEET_TRI]],
                             t->member[MEET_BOX][drawn.member[MEET_BOX]],
                             drawn.member[MEET_OPTIMIZE], drawn.member[MEET_MOTION] > 0);
        for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
            for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++)
                if (met.member[a] != MEET_NONE && met.member[b] != MEET_NONE)
                    assert_true(
                        pair_coverage_of_pair(m, a, met.member[a], b, met.member[b])->possible);
        for (uint32_t i = 0; i < trials; i++)
            pair_coverage_add(m, &met);
    }
    struct pair_coverage_summary sum = pair_coverage_summarize(m, wanted);
    assert_true(sum.possible > 1000 && sum.met == sum.possible && sum.below == 0);
    /* Those of layout and builder are the most pairs of two factors; chance takes four times. */
    assert_true(turns <= 4 * t->count[MEET_LAYOUT] * t->count[MEET_BUILDER] * 5 / 4);
    pair_coverage_close(m);
}

/* An engine whose tree and tests are its own meets nothing that varies, and comes up all the same,
 * as often as a pair does. */
static void engines_with_all_their_own_are_drawn(void **state)
{
    (void)state;
    struct pair_coverage *all = open_all(), *m;
    struct pair_tables tables = all->tables;
    uint32_t drawn_of[2] = {0, 0}, turns = 0;
    tables.member[MEET_ENGINE][0] = engine_find("embree");
    tables.member[MEET_ENGINE][1] = engine_find("cpu");
    tables.count[MEET_ENGINE] = 2;
    assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_OK);
    for (; turns < 4000 && pair_coverage_summarize(m, 128).below > 0; turns++) {
        struct combination drawn;
        pair_coverage_draw(m, 7, turns, 64, &drawn);
        const struct engine *engine = tables.member[MEET_ENGINE][drawn.member[MEET_ENGINE]];
        drawn_of[drawn.member[MEET_ENGINE]]++;
        for (enum pair_factor f = 0; f < MEET_FACTORS; f++)
            if (!pair_coverage_meets(engine, f))
                drawn.member[f] = MEET_NONE;
        for (uint32_t i = 0; i < 64; i++)
            pair_coverage_add(m, &drawn);
    }
    assert_true(turns < 4000 && drawn_of[0] >= 2 && drawn_of[0] < drawn_of[1] / 10);
    pair_coverage_close(m);
    pair_coverage_close(all);
}

static void draws_are_of_seed_turn_and_tally(void **state)
{
    (void)state;
    struct pair_coverage *a = open_all(), *b = open_all(), *c = open_all();
    uint32_t unlike = 0;
    for (uint32_t turn = 0; turn < 50; turn++) {
        struct combination x, y, z;
        pair_coverage_draw(a, 1, turn, 64, &x);
        pair_coverage_draw(b, 1, turn, 64, &y);
        pair_coverage_draw(c, 2, turn, 64, &z);
        assert_memory_equal(&x, &y, sizeof x);
        unlike += memcmp(&x, &z, sizeof x) != 0;
    }
    assert_true(unlike > 40);
    pair_coverage_close(a);
    pair_coverage_close(b);
    pair_coverage_close(c);
}

/* Where engines are few they are chosen last: the row has storage and tests already when it meets
 * what the engine has compiled. */
static void what_was_compiled_can_be_traced(void **state)
{
    (void)state;
    static struct pair_tables tables;
    struct pair_coverage *m;
    tables = all_tables();
    tables.count[MEET_ENGINE] = 1;
    tables.member[MEET_ENGINE][0] = engine_find("vulkan");
    assert_int_equal(pair_coverage_open(&tables, &m, &reason), STATUS_OK);
    for (uint32_t turn = 0; turn < 2000; turn++) {
        struct combination x;
        pair_coverage_draw(m, 3, turn, 64, &x);
        for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
            for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++)
                assert_true(pair_coverage_of_pair(m, a, x.member[a], b, x.member[b])->possible);
    }
    pair_coverage_close(m);
}

/* A pair that is always refused comes up again, but does not starve the others. */
static void refused_pairs_do_not_starve_others(void **state)
{
    (void)state;
    struct pair_coverage *m = open_all();
    const uint32_t refused = named(m, MEET_LAYOUT, "tiny8");
    uint32_t again = 0;
    for (uint32_t turn = 0; turn < 3000; turn++) {
        struct combination drawn;
        pair_coverage_draw(m, 3, turn, 64, &drawn);
        bool bad = drawn.member[MEET_LAYOUT] == refused;
        again += bad;
        if (bad)
            pair_coverage_missed(m, &drawn, 64, 0);
        else
            pair_coverage_add(m, &drawn);
    }
    /* One of 51 layouts would have come up 59 times. */
    assert_true(again > 100 && again < 1200);
    pair_coverage_close(m);
}

/* --- what is drawn, as trials ------------------------------------------------------------------
 */

#define TRIALS 24u

static const struct work_rules rules = {
    .seed = 11, .gen = {.triangles_least = 8, .triangles_most = 30, .rays = 40}};

static struct work_draw draw_of(const char *layout, const char *builder, const char *store,
                                uint32_t optimized, bool moved)
{
    return (struct work_draw){.on = true,
                              .layout = layout_find(layout),
                              .builder = builder_find(builder),
                              .store = tri_store_find(store),
                              .tri = tri_tests[0],
                              .box = box_tests[0],
                              .optimized = optimized,
                              .moved = moved};
}

static void make_drawn(const struct work_draw *draw, uint32_t i, struct fuzz_trial *out)
{
    const struct work_order order = {.stream = WORK_GEN, .first = 100, .draw = *draw};
    if (work_trial_ordered(&rules, &order, i, NULL, out, &reason))
        fail_msg("%s", reason.text);
}

/* The packed tree is one of the scene that is traced, whatever it has gone through. */
static void moved_trees_are_trees_of_the_scene(void **state)
{
    (void)state;
    static const char *const layout[] = {"f32", "bvh8_u8_node", "bvh4_f16_scene", "half4"};
    static const char *const store[] = {"indexed", "gathered", "compact", "edges"};
    uint32_t refitted = 0, rebuilt = 0;
    for (uint32_t i = 0; i < TRIALS; i++)
        for (size_t l = 0; l < ARRAY_COUNT(layout); l++) {
            const struct work_draw draw = draw_of(layout[l], i % 4 == 3 ? "sbvh" : "sah_binned",
                                                  store[(i + l) % 4], i % 2, true);
            struct fuzz_trial trial, again;
            struct bvh bvh;
            struct packed packed;
            enum trial_motion motion;
            make_drawn(&draw, i, &trial);
            make_drawn(&draw, i, &again);
            assert_int_equal(fuzz_trial_hash(&trial), fuzz_trial_hash(&again));
            fuzz_trial_free(&again);
            assert_true(trial.move > 0);
            enum status status =
                fuzz_trial_tree(&trial, draw.layout, &bvh, &packed, &motion, &reason);
            if (status != STATUS_LIMIT) {
                assert_int_equal(status, STATUS_OK);
                if (packed_check(&packed, &trial.scene, NULL, &reason) ||
                    bvh_check(&bvh, &trial.scene, &reason))
                    fail_msg("%s, trial %u: %s", layout[l], i, reason.text);
                refitted += motion == TRIAL_REFITTED;
                rebuilt += motion == TRIAL_REBUILT;
                packed_free(&packed);
                bvh_free(&bvh);
            }
            fuzz_trial_free(&trial);
        }
    assert_true(refitted > 40 && rebuilt > 5);
}

/* What is on a grid, the storage can hold. */
static void quantised_trials_are_on_a_grid(void **state)
{
    (void)state;
    const struct work_draw draw = draw_of("f32", "ploc", "quantised", false, false);
    uint32_t held = 0;
    for (uint32_t i = 0; i < TRIALS; i++) {
        struct fuzz_trial trial;
        struct bvh bvh;
        struct packed packed;
        make_drawn(&draw, i, &trial);
        trial.build.leaf = 4;
        if (!fuzz_trial_tree(&trial, draw.layout, &bvh, &packed, NULL, &reason)) {
            held++;
            packed_free(&packed);
            bvh_free(&bvh);
        }
        fuzz_trial_free(&trial);
    }
    assert_true(held > TRIALS * 3 / 4);
}

/* A finding's file plays alone: all that was drawn stands in it. */
static void drawn_trials_come_back_from_their_file(void **state)
{
    (void)state;
    static const char *const store[] = {"compact", "quantised", "edges", "indexed"};
    for (uint32_t i = 0; i < TRIALS; i++) {
        const struct work_draw draw = draw_of("f32", "ploc", store[i % 4], i % 3, i % 2);
        struct finding_file file = {.has_signature = false}, again;
        char *bytes;
        size_t size;
        make_drawn(&draw, i, &file.trial);
        assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
        if (finding_file_parse("a trial", bytes, size, &again, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(fuzz_trial_hash(&file.trial), fuzz_trial_hash(&again.trial));
        assert_ptr_equal(again.trial.store, draw.store);
        assert_int_equal(work_optimized(&again.trial.build), draw.optimized);
        assert_int_equal(again.trial.move > 0, draw.moved);
        assert_true(again.trial.build.presplit == file.trial.build.presplit);
        free(bytes);
        finding_file_free(&file);
        finding_file_free(&again);
    }
}

/* One trial in eight has parts of triangles, but none that a builder would not take. */
static void parts_are_for_builders_that_take_them(void **state)
{
    (void)state;
    static const char *const name[] = {NULL, "ploc", "sbvh", "rtrs", "hploc"};
    for (size_t b = 0; b < ARRAY_COUNT(name); b++) {
        struct work_rules by = rules;
        uint32_t some = 0, drawn = 0;
        by.builder_count = name[b] != NULL;
        by.builder[0] = name[b] ? builder_find(name[b]) : NULL;
        for (uint32_t i = 0; i < 400; i++) {
            struct fuzz_trial trial;
            assert_int_equal(work_trial_make(&by, WORK_GEN, i, NULL, &trial, &reason), STATUS_OK);
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("%s", reason.text);
            some += trial.build.presplit > 0;
            fuzz_trial_free(&trial);
            const struct work_draw draw =
                draw_of("f32", name[b] ? name[b] : "lbvh", "indexed", 0, 0);
            make_drawn(&draw, i, &trial);
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("%s", reason.text);
            drawn += trial.build.presplit > 0;
            fuzz_trial_free(&trial);
        }
        assert_in_range(some, b < 2 ? 15 : 0, b < 2 ? 75 : 0);
        assert_in_range(drawn, b < 2 ? 15 : 0, b < 2 ? 75 : 0);
    }
}

static void parts_tell_trials_apart_and_weigh(void **state)
{
    (void)state;
    const struct work_draw draw = draw_of("f32", "sah_sweep", "indexed", 0, false);
    static const float share[] = {0, 1, 0.3f}, bad[] = {-1, NAN, INFINITY, FUZZ_PRESPLIT_MOST + 1};
    struct fuzz_trial trial;
    struct fuzz_trial_size before = {0};
    make_drawn(&draw, 0, &trial);
    for (size_t i = 0; i < ARRAY_COUNT(share); i++) {
        trial.build.presplit = share[i];
        struct fuzz_trial_size size = fuzz_trial_size(&trial);
        assert_true(size.bits > before.bits && size.hash != before.hash);
        assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_OK);
        before = size;
    }
    trial.builder = builder_find("sbvh");
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "takes no parts"));
    trial.builder = draw.builder;
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        trial.build.presplit = bad[i];
        assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_INPUT);
    }
    fuzz_trial_free(&trial);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rules_refuse_cannot_meet),
        cmocka_unit_test(what_no_engine_runs_cannot_meet),
        cmocka_unit_test(rarest_pairs_are_drawn),
        cmocka_unit_test(engines_with_all_their_own_are_drawn),
        cmocka_unit_test(draws_are_of_seed_turn_and_tally),
        cmocka_unit_test(what_was_compiled_can_be_traced),
        cmocka_unit_test(refused_pairs_do_not_starve_others),
        cmocka_unit_test(moved_trees_are_trees_of_the_scene),
        cmocka_unit_test(quantised_trials_are_on_a_grid),
        cmocka_unit_test(drawn_trials_come_back_from_their_file),
        cmocka_unit_test(parts_are_for_builders_that_take_them),
        cmocka_unit_test(parts_tell_trials_apart_and_weigh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

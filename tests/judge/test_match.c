/* Laws of ref/match/match.h: rows say what happened, and a wrong answer of anybody shows. */
#include "ref/match/match.h"
#include "ref/outside/recorded.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/matched.h"

#include <stdlib.h>
#include <string.h>

static void brute_and_cpu_agree_and_their_counts_add_up(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "rf16"};
    struct fixture *f = play("soup:n=500", "median", 4);
    run(f, "brute");
    assert_agrees(f);
    assert_null(f->row.layout);
    assert_int_equal(f->row.node_bytes + f->row.item_bytes, 0);
    assert_true(f->row.count[VERDICT_RIGHT] > RAYS * 9 / 10);
    assert_true(f->row.worst_over > 0.05 && f->row.worst_over <= 1.0);
    assert_int_equal(f->row.displacement.count, 0); /* the formula is known */
    assert_int_equal(f->row.brute, RAYS);
    assert_int_equal(f->row.tris, 500 * RAYS);
    size_t hits = f->row.hits;
    uint64_t closest_tris = 0;
    for (size_t l = 0; l < ARRAY_COUNT(names); l++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            pack(f, names[l]);
            match_set(&f->match, box_tests[0], (enum query)query);
            run(f, "cpu");
            assert_agrees(f);
            assert_true(f->row.judged);
            assert_ptr_equal(f->row.layout, layout_find(names[l]));
            assert_int_equal(f->row.options.query, query);
            assert_true(query == QUERY_CLOSEST || f->row.tris < closest_tris);
            closest_tris = f->row.tris;
            assert_int_equal(f->row.hits, hits);
            assert_true(f->row.count[VERDICT_RIGHT] > RAYS * 9 / 10);
            assert_int_equal(f->row.node_bytes, 4 * f->match.packed.word_count);
            assert_int_equal(f->row.item_bytes, l == 0 ? 4 * 500 : 0);
            assert_true(f->row.tris < 500 * RAYS / 10);
            assert_true(f->row.memory_bytes >= f->row.node_bytes + f->row.item_bytes);
        }
    done(f);
}

static void speeds_are_least_median_and_most(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=500", "median", 4);
    for (unsigned repeats = 1; repeats <= 6; repeats++) {
        f->match.options.repeats = repeats;
        run(f, "cpu");
        assert_agrees(f);
        assert_true(f->row.mrays[1] > 0);
        assert_true(f->row.mrays[1] <= f->row.mrays[0] && f->row.mrays[0] <= f->row.mrays[2]);
        assert_false(f->row.device_clock);
    }
    done(f);
}

static void a_partial_brute_budget_leaves_the_rest_to_the_oracles_tree(void **state)
{
    (void)state;
    static const size_t affordable[] = {0, 1, 1234, RAYS, RAYS + 1};
    struct oracle_answer *complete = NULL;
    for (size_t i = ARRAY_COUNT(affordable); i-- > 0;) {
        struct fixture *f = prepare("soup:n=500", "median", 4);
        f->options.brute_budget = 500 * affordable[i] + 499;
        start(f);
        pack(f, "rf16");
        size_t brute = affordable[i] < RAYS ? affordable[i] : RAYS;
        assert_int_equal(f->match.brute_count, brute);
        run(f, "cpu");
        assert_agrees(f);
        assert_int_equal(f->row.brute, brute);
        run(f, "brute"); /* as many rays as it was given work for; all if none */
        assert_int_equal(f->row.rays, brute ? brute : RAYS);
        assert_int_equal(f->row.differences, 0);
        if (!complete) {
            complete = calloc(RAYS, sizeof *complete);
            assert_non_null(complete);
            memcpy(complete, f->match.truth, RAYS * sizeof *complete);
        }
        assert_memory_equal(f->match.truth, complete, RAYS * sizeof *complete);
        done(f);
    }
    free(complete);
}

static void another_tree_keeps_the_truth(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=500", "median", 4);
    struct build_options build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct oracle_answer *truth = f->match.truth;
    uint32_t nodes = f->match.stats.node_count;
    run(f, "cpu");
    size_t hits = f->row.hits;
    assert_int_equal(
        match_rebuild(&f->match, builder_find("median"), &build, tri_test_find("woop"), &f->reason),
        STATUS_OK);
    assert_ptr_equal(f->match.truth, truth);
    assert_true(f->match.stats.node_count > nodes);
    assert_null(f->match.packed.layout);
    run(f, "cpu"); /* nothing is packed */
    assert_int_equal(f->row.status, ROW_FAILED);
    pack(f, "f32");
    run(f, "cpu");
    assert_agrees(f);
    assert_string_equal(f->row.options.tri->name, "woop");
    assert_int_equal(f->row.options.build.leaf, 2);
    assert_true(f->row.hits != hits); /* another test at the edges */
    build.eps = 0;
    for (uint32_t i = 0; i < 9 * 500; i++)
        f->scene.vertex[i] = (float)(i % 9);
    assert_int_equal(
        match_rebuild(&f->match, builder_find("rtrs"), &build, tri_tests[0], &f->reason),
        STATUS_LIMIT);
    done(f);
}

static void no_rays_and_far_scenes_are_fine(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=50", "median", 4);
    assert_int_equal(match_make(&f->scene, NULL, 0, &f->options, &f->pool, &f->match, &f->reason),
                     STATUS_OK);
    pack(f, "f32");
    run(f, "cpu");
    assert_int_equal(f->row.status, ROW_VACUOUS);
    assert_int_equal(verdicts(&f->row), 0);
    match_free(&f->match);
    /* One coordinate beyond 2^40 puts the scene out of contract, at 2^40 it is within. */
    for (int over = 0; over < 2; over++) {
        f->scene.vertex[0] = over ? 0x1.000002p40f : 0x1p40f;
        start(f);
        pack(f, "f32");
        run(f, "cpu");
        assert_int_equal(f->row.differences, 0);
        assert_int_equal(f->row.count[VERDICT_OUT_OF_CONTRACT] == RAYS, over);
        match_free(&f->match);
    }
    done(f);
}

static void rays_that_all_miss_are_vacuous(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=500", "median", 4);
    for (size_t i = 0; i < RAYS; i++)
        f->ray[i] = (struct ray){{100, 100, 100 + (float)i}, 0, {1, 0.5f, 0.25f}, 1e30f};
    start(f);
    pack(f, "f32");
    static const char *const names[] = {"brute", "cpu"};
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        run(f, names[e]);
        assert_int_equal(f->row.status, ROW_VACUOUS);
        assert_true(row_failed(&f->row));
        assert_int_equal(f->row.differences, 0);
        assert_string_equal(f->row.reason.text, "vacuous: 0 hits of 3000 rays prove nothing");
    }
    pack(f, "rtrs_rf"); /* nothing was to be proved */
    run(f, "cpu");
    assert_int_equal(f->row.status, ROW_OK);
    done(f);
}

/* An engine whose answers are all misses is WRONG where there are hits: that is a fault, and more
 * than a result that proves nothing. */
static void misses_where_there_are_hits_are_wrong_and_not_vacuous(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=500", "median", 4);
    struct hit *miss = alloc_zeroed(RAYS, sizeof *miss);
    assert_non_null(miss);
    for (size_t i = 0; i < RAYS; i++)
        miss[i].prim = ABI_NO_PRIM;
    const struct recorded answers = {.ray = f->ray, .hit = miss, .count = RAYS};
    const struct engine *engine;
    assert_int_equal(recorded_engine(&answers, &engine, &f->reason), STATUS_OK);
    start(f);
    match_run(&f->match, engine, &f->row);
    assert_int_equal(f->row.hits, 0);
    assert_true(f->row.count[VERDICT_WRONG] > RAYS / 10);
    assert_int_equal(f->row.status, ROW_OK);
    assert_true(row_failed(&f->row));
    done(f);
    free(miss);
}

static void a_layout_that_refuses_leaves_a_usable_match(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=500", "median", 20);
    enum status cause = match_pack(&f->match, layout_find("rf16"), &f->reason);
    assert_int_equal(cause, STATUS_LIMIT);
    assert_null(f->match.packed.layout);
    match_refused(&f->match, layout_find("rf16"), engine_find("cpu"), cause, &f->reason, &f->row);
    assert_int_equal(f->row.status, ROW_REFUSED);
    assert_int_equal(f->row.cause, STATUS_LIMIT);
    assert_string_equal(f->row.layout->name, "rf16");
    assert_non_null(strstr(f->row.reason.text, "rf16: a leaf holds at most 8 items"));
    assert_false(row_failed(&f->row));
    assert_int_equal(f->row.stats.largest_leaf, f->match.stats.largest_leaf);
    run(f, "brute");
    assert_agrees(f);
    char refused[400];
    assert_int_equal(match_pack_auto(&f->match, refused, sizeof refused, &f->reason), STATUS_OK);
    assert_string_equal(f->match.packed.layout->name, "cwbvh80");
    assert_non_null(strstr(refused, "rf16: a leaf holds at most 8 items"));
    run(f, "cpu");
    assert_agrees(f);
    done(f);
}

static void a_builder_that_never_ends_is_refused_without_a_match(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=500", "rtrs", 4);
    f->options.build.eps = 0;
    for (uint32_t i = 0; i < 9 * 500; i++)
        f->scene.vertex[i] = (float)(i % 9);
    assert_int_equal(
        match_make(&f->scene, f->ray, RAYS, &f->options, &f->pool, &f->match, &f->reason),
        STATUS_LIMIT);
    assert_non_null(strstr(f->reason.text, "F19"));
    assert_null(f->match.truth);
    done(f);
}

static void an_empty_scene_is_all_misses_for_everybody(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=500", "median", 4);
    scene_free(&f->scene);
    assert_int_equal(scene_make(0, 0, &f->scene), STATUS_OK);
    start(f);
    pack(f, "rf16");
    run(f, "cpu");
    assert_int_equal(f->row.status, ROW_VACUOUS);
    assert_int_equal(f->row.count[VERDICT_RIGHT], RAYS);
    done(f);
}

/* --- spoilt trees: what is judged must not be believed --------------------------------------- */

static void a_flipped_sign_of_a_stored_bound_is_found(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "rf16"};
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        struct fixture *f = play("soup:n=500", "median", 4);
        pack(f, names[l]);
        run(f, "cpu");
        assert_agrees(f);
        /* An upper bound of node 1, which is record 1, on an axis where it is positive. */
        uint32_t k = 0;
        while (f->match.bvh.node[1].bounds.hi[k] < 0.1f)
            assert_true(++k < 3);
        f->match.packed.word[l == 0 ? 8 + 4 + k : 4 + k] ^= 0x80000000u;
        run(f, "cpu");
        assert_differs(f, true);                           /* from the sound tree's hits, too */
        match_set(&f->match, box_tests[0], QUERY_CLOSEST); /* forgets them */
        run(f, "cpu");
        assert_differs(f, false);
        done(f);
    }
}

static void two_swapped_items_are_found(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=40", "median", 4);
    uint32_t *item = f->match.packed.item, first = item[0];
    item[0] = item[39];
    item[39] = first;
    run(f, "cpu");
    assert_differs(f, false);
    done(f);
    f = play("soup:n=40", "median", 4);
    pack(f, "rf16");
    uint32_t record = 0, last = f->match.packed.node_count - 1; /* of items */
    while (!(f->match.packed.word[4 * record + 3] >> 31))
        record++;
    uint32_t *a = &f->match.packed.word[4 * (record + 1)], *b = &f->match.packed.word[4 * last];
    uint32_t low = *a & 0xFFFF;
    *a = (*a & 0xFFFF0000u) | (*b & 0xFFFF);
    *b = (*b & 0xFFFF0000u) | low;
    run(f, "cpu");
    assert_differs(f, false);
    done(f);
}

static void a_lost_item_is_found_by_any_hit_too(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=20", "median", 1);
    match_set(&f->match, box_tests[0], QUERY_ANY);
    f->match.packed.item[7] = ABI_NO_PRIM;
    run(f, "cpu");
    assert_differs(f, false);
    done(f);
}

/* --- members as published -------------------------------------------------------------------- */

static void rows_with_a_faithful_member_are_counted_not_judged(void **state)
{
    (void)state;
    struct fixture *f = play("soup:n=500", "median", 4);
    pack(f, "rtrs_rf");
    run(f, "cpu");
    assert_int_equal(f->row.status, ROW_OK);
    assert_false(f->row.judged);
    assert_true(f->row.count[VERDICT_WRONG] > 0); /* F2 */
    assert_int_equal(f->row.differences, 0);
    assert_int_equal(f->row.finding_count, 0);
    assert_false(row_failed(&f->row));
    assert_int_equal(verdicts(&f->row), RAYS);
    pack(f, "f32");
    match_set(&f->match, box_test_find("rtrs"), QUERY_CLOSEST);
    run(f, "cpu");
    assert_false(f->row.judged);
    run(f, "brute"); /* has no part in it */
    assert_true(f->row.judged);
    done(f);
    f = play("soup:n=500", "rtrs", 2);
    run(f, "cpu");
    assert_false(f->row.judged);
    done(f);
}

static void a_faithful_triangle_test_is_judged_against_itself(void **state)
{
    (void)state;
    struct fixture *f = prepare("soup:n=500", "median", 4);
    f->options.tri = tri_test_find("mt_rtrs");
    start(f);
    pack(f, "rf16");
    run(f, "cpu");
    assert_agrees(f);
    assert_true(f->row.judged);
    done(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brute_and_cpu_agree_and_their_counts_add_up),
        cmocka_unit_test(speeds_are_least_median_and_most),
        cmocka_unit_test(a_partial_brute_budget_leaves_the_rest_to_the_oracles_tree),
        cmocka_unit_test(another_tree_keeps_the_truth),
        cmocka_unit_test(no_rays_and_far_scenes_are_fine),
        cmocka_unit_test(rays_that_all_miss_are_vacuous),
        cmocka_unit_test(misses_where_there_are_hits_are_wrong_and_not_vacuous),
        cmocka_unit_test(a_layout_that_refuses_leaves_a_usable_match),
        cmocka_unit_test(a_builder_that_never_ends_is_refused_without_a_match),
        cmocka_unit_test(an_empty_scene_is_all_misses_for_everybody),
        cmocka_unit_test(a_flipped_sign_of_a_stored_bound_is_found),
        cmocka_unit_test(two_swapped_items_are_found),
        cmocka_unit_test(a_lost_item_is_found_by_any_hit_too),
        cmocka_unit_test(rows_with_a_faithful_member_are_counted_not_judged),
        cmocka_unit_test(a_faithful_triangle_test_is_judged_against_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The fuzzer's recipes: every scene is valid and is what its recipe says. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/gen_recipes.h"
#include "ref/base/half.h"
#include "ref/layout.h"

#include <cmocka.h>

#include "tests/support/counted.h"
#include "tests/fuzz/fuzz_gen_trials.h"

#define TIMES 100u

/* --- drawing one recipe ------------------------------------------------------------------------
 */

/* What `draw` makes by itself, nothing filled in, nothing edited. */
static struct fuzz_trial drawn(draw_fn *draw, uint64_t seed, uint32_t goal)
{
    struct fuzz_trial trial;
    struct rng rng = rng_make(seed, 41);
    assert_int_equal(fuzz_trial_make(3 * goal, goal, 0, &trial, NULL), STATUS_OK);
    struct sketch sketch = {
        .rng = &rng, .vertex = trial.scene.vertex, .index = trial.scene.index, .goal = goal};
    draw(&sketch);
    assert_true(sketch.tri_count <= goal && sketch.vertex_count <= 3 * goal);
    trial.scene.vertex_count = sketch.vertex_count;
    trial.scene.tri_count = sketch.tri_count;
    if (sketch.leaf)
        trial.build.leaf = sketch.leaf;
    return trial;
}

static void every_recipe_draws_valid_scenes(void **state)
{
    (void)state;
    for (uint32_t r = 0; recipes[r].name; r++)
        for (uint32_t i = 0; i < TIMES; i++) {
            struct rng rng = rng_make(i, 43);
            uint32_t goal = recipes[r].goal ? recipes[r].goal(&rng) : 1 + rng_below(&rng, 64);
            if (goal > 1000 && i > 4)
                break;
            if (goal == 0)
                continue;
            struct fuzz_trial trial = drawn(recipes[r].draw, i, goal);
            struct reason reason = {""};
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("%s %u: %s", recipes[r].name, i, reason.text);
            fuzz_trial_free(&trial);
        }
}

static void the_table_is_whole(void **state)
{
    (void)state;
    uint32_t weights = 0, seen[64] = {0};
    for (uint32_t r = 0; recipes[r].name; r++) {
        weights += recipes[r].weight;
        assert_true(strlen(recipes[r].summary) > 5);
        for (uint32_t other = 0; other < r; other++)
            assert_string_not_equal(recipes[r].name, recipes[other].name);
    }
    assert_int_equal(weights, RECIPE_WEIGHTS);
    for (uint32_t i = 0; i < 20000; i++) {
        static const struct gen_options short_ones = {
            .triangles_least = 16, .triangles_most = 64, .rays = 1};
        struct fuzz_trial trial = trial_of(47, i, &short_ones);
        struct reason reason = {""};
        uint32_t r = 0;
        while (!is_recipe(&trial, recipes[r].name))
            r++;
        seen[r]++;
        if (fuzz_trial_check(&trial, &reason))
            fail_msg("trial %u, %s: %s", i, trial.origin.recipe, reason.text);
        fuzz_trial_free(&trial);
    }
    for (uint32_t r = 0; recipes[r].name; r++)
        assert_true(seen[r] > 0);
}

/* --- laws of single recipes --------------------------------------------------------------------
 */

/* Edges that are not shared by two triangles, each in one direction. */
static uint32_t open_edges(const struct scene *scene)
{
    uint32_t open = 0, corners = 3 * scene->tri_count;
    for (uint32_t e = 0; e < corners; e++) {
        uint32_t a = scene->index[e], b = scene->index[e % 3 == 2 ? e - 2 : e + 1], back = 0;
        for (uint32_t f = 0; f < corners; f++)
            back += scene->index[f] == b && scene->index[f % 3 == 2 ? f - 2 : f + 1] == a;
        open += back != 1;
    }
    return open;
}

static void closed_recipes_are_closed(void **state)
{
    (void)state;
    static draw_fn *const closed[] = {draw_boxes, draw_tetrahedra, draw_balls, draw_fan,
                                      draw_nested};
    for (uint32_t r = 0; r < ARRAY_COUNT(closed); r++)
        for (uint32_t i = 0; i < TIMES; i++) {
            struct fuzz_trial trial = drawn(closed[r], i, 16 + i % 49);
            assert_true(trial.scene.tri_count >= 12);
            assert_int_equal(open_edges(&trial.scene), 0);
            trial.scene.index[0] = trial.scene.index[1]; /* the check sees a hole */
            assert_true(open_edges(&trial.scene) > 0);
            fuzz_trial_free(&trial);
        }
}

/* Sum of the corners of a triangle: three times its centroid. */
static void corner_sum(const struct scene *scene, uint32_t tri, double out[3])
{
    float v[3][3];
    scene_tri(scene, tri, v);
    for (int k = 0; k < 3; k++)
        out[k] = (double)v[0][k] + (double)v[1][k] + (double)v[2][k];
}

static void concentric_triangles_have_one_centroid(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < TIMES; i++) {
        struct fuzz_trial trial = drawn(draw_concentric, i, 64);
        for (uint32_t t = 0; t < trial.scene.tri_count; t++) {
            double sum[3];
            corner_sum(&trial.scene, t, sum);
            for (int k = 0; k < 3; k++)
                assert_true(sum[k] == 0);
        }
        fuzz_trial_free(&trial);
    }
}

static void duplicates_repeat_and_sheets_are_flat(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < TIMES; i++) {
        struct fuzz_trial trial = drawn(draw_duplicates, i, 48);
        uint32_t repeated = 0;
        for (uint32_t t = 1; t < 48; t++) {
            struct box a = scene_tri_bounds(&trial.scene, t - 1);
            struct box b = scene_tri_bounds(&trial.scene, t);
            repeated += memcmp(&a, &b, sizeof a) == 0;
        }
        assert_true(repeated >= 24);
        fuzz_trial_free(&trial);
        trial = drawn(i % 2 ? draw_walls : draw_sheets, i, 48);
        for (uint32_t t = 0; t < trial.scene.tri_count; t++) {
            struct box box = scene_tri_bounds(&trial.scene, t);
            assert_true(box.lo[0] == box.hi[0] || box.lo[1] == box.hi[1] || box.lo[2] == box.hi[2]);
        }
        fuzz_trial_free(&trial);
    }
}

static uint32_t depth_of(draw_fn *draw, uint64_t seed)
{
    struct fuzz_trial trial = drawn(draw, seed, 60);
    struct bvh bvh;
    trial.build.leaf = 1;
    assert_int_equal(builder_find("median")->build(&trial.scene, &trial.build, &bvh, NULL),
                     STATUS_OK);
    uint32_t depth = bvh_counted(&bvh, &trial.scene).depth;
    bvh_free(&bvh);
    fuzz_trial_free(&trial);
    return depth;
}

static void chains_are_deep(void **state)
{
    (void)state;
    uint32_t deep = 0, soup = 0;
    for (uint32_t i = 0; i < TIMES; i++) {
        deep += depth_of(draw_chain, i) >= 24;
        soup += depth_of(draw_soup, i) >= 24;
    }
    assert_true(deep > TIMES * 9 / 10);
    assert_int_equal(soup, 0);
}

/* Coordinates at most two float32 steps from a float16, and from the middle of two. */
static void count_halves(draw_fn *draw, uint32_t *codes, uint32_t *middles, uint32_t *all)
{
    *codes = *middles = *all = 0;
    for (uint32_t i = 0; i < TIMES; i++) {
        struct fuzz_trial trial = drawn(draw, i, 32);
        for (uint32_t n = 0; n < 3 * trial.scene.vertex_count; n++) {
            bool code = false, middle = false;
            for (int step = -2; step <= 2; step++) {
                float x = float_step(trial.scene.vertex[n], step);
                float lo = half_to_float(half_down(x)), hi = half_to_float(half_up(x));
                code = code || lo == hi;
                middle = middle || (lo < hi && x - lo == hi - x);
            }
            ++*all;
            *codes += code;
            *middles += middle;
        }
        fuzz_trial_free(&trial);
    }
}

static void codes_and_midpoints_are_such(void **state)
{
    (void)state;
    uint32_t codes, middles, all;
    count_halves(draw_codes, &codes, &middles, &all);
    print_message("codes: %u of %u on float16s, %u on midpoints\n", codes, all, middles);
    assert_true(codes > all * 2 / 3);
    count_halves(draw_midpoints, &codes, &middles, &all);
    print_message("midpoints: %u of %u on midpoints, %u on float16s\n", middles, all, codes);
    assert_true(middles > all / 2);
    count_halves(draw_soup, &codes, &middles, &all);
    assert_true(codes < all / 50 && middles < all / 50);
}

/* --- limits ------------------------------------------------------------------------------------
 */

static enum status packs(draw_fn *draw, uint32_t goal, struct reason *reason)
{
    struct fuzz_trial trial = drawn(draw, goal, goal);
    struct bvh bvh;
    struct packed packed;
    assert_int_equal(trial.scene.tri_count, goal);
    assert_int_equal(builder_find("median")->build(&trial.scene, &trial.build, &bvh, NULL),
                     STATUS_OK);
    enum status status = packed_make(layout_find("rf16"), &bvh, &trial.scene, &packed, reason);
    if (!status)
        packed_free(&packed);
    bvh_free(&bvh);
    fuzz_trial_free(&trial);
    return status;
}

/* The largest scenes stand on both sides of each limit of the 16-byte layout. */
static void limits_are_met_exactly(void **state)
{
    (void)state;
    struct reason reason;
    assert_int_equal(packs(draw_records, 10923, &reason), STATUS_OK);
    assert_int_equal(packs(draw_records, 10924, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "record"));
    assert_int_equal(packs(draw_items, 32768, &reason), STATUS_OK);
    assert_int_equal(packs(draw_items, 65536, &reason), STATUS_OK);
    assert_int_equal(packs(draw_items, 65537, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "triangle index"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_recipe_draws_valid_scenes),
        cmocka_unit_test(the_table_is_whole),
        cmocka_unit_test(closed_recipes_are_closed),
        cmocka_unit_test(concentric_triangles_have_one_centroid),
        cmocka_unit_test(duplicates_repeat_and_sheets_are_flat),
        cmocka_unit_test(chains_are_deep),
        cmocka_unit_test(codes_and_midpoints_are_such),
        cmocka_unit_test(limits_are_met_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

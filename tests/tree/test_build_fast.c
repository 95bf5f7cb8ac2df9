/* Laws of the builders by cost and by order: form, bounds, limits, and the same tree for any number
 * of threads. */
#include "ref/build/links.h"
#include "ref/builders/reinsert.h"
#include "ref/tree/bvh.h"
#include "ref/base/rng.h"
#include "ref/tree/tree_quality.h"
#include "tests/support/counted.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

/* Builders whose trees keep all laws. */
static bool is_lawful(const struct builder *builder)
{
    return !builder->faithful;
}

static void check_one(const struct builder *builder, const struct scene *scene, uint32_t leaf,
                      const char *what)
{
    for (uint32_t how = 0; how < 3; how++) {
        const uint32_t passes = how > 0 ? 2 : 0;
        struct build_options options = {.leaf = leaf, .passes = passes, .rotates = how > 1};
        struct reason reason = {""};
        struct bvh bvh;
        if (bvh_build(builder, scene, &options, &bvh, &reason) || bvh_check(&bvh, scene, &reason))
            fail_msg("%s, %s, leaf %u, %u passes: %s", builder->name, what, leaf, passes,
                     reason.text);
        struct bvh_stats stats = bvh_counted(&bvh, scene);
        if (stats.largest_leaf > leaf || stats.depth > 60 || stats.loose_count > 0)
            fail_msg("%s, %s, leaf %u, %u passes: a leaf of %u, depth %u, %u loose", builder->name,
                     what, leaf, passes, stats.largest_leaf, stats.depth, stats.loose_count);
        bvh_free(&bvh);
    }
}

static void trees_are_well_formed_and_contain_their_triangles(void **state)
{
    (void)state;
    for (size_t i = 0; i < BUILT_SCENES; i++) {
        const char *what;
        struct scene scene = built_scene(i, &what);
        for (size_t b = 0; builders_all[b]; b++)
            for (uint32_t leaf = 1; leaf <= 17 && is_lawful(builders_all[b]);
                 leaf += leaf < 4 ? 1 : 13)
                check_one(builders_all[b], &scene, leaf, what);
        scene_free(&scene);
    }
}

static void few_triangles_of_any_number(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 40; n++) {
        struct scene scene = built_soup(n, n);
        for (size_t b = 0; builders_all[b]; b++)
            for (uint32_t leaf = 1; leaf <= 9 && is_lawful(builders_all[b]); leaf += 2)
                check_one(builders_all[b], &scene, leaf, "few");
        scene_free(&scene);
    }
}

/* A scene large enough that ranges are divided by all threads, with a part where all are equal. */
static struct scene large_scene(void)
{
    struct scene scene = built_soup(90000, 3);
    for (size_t i = 0; i < (size_t)9 * 10000; i++)
        scene.vertex[i] = scene.vertex[i % 9];
    return scene;
}

/* Built again, and by more threads than the processor has, the tree is the same; `few`: only the
 * latter. */
static void check_threads(const struct builder *builder, const struct scene *scene,
                          struct build_options options, bool few)
{
    static const uint32_t threads[] = {1, 16, 1, 7};
    struct bvh first = {0};
    options.leaf = 3;
    for (size_t t = 0; t < (few ? 2 : ARRAY_COUNT(threads)); t++) {
        options.threads = threads[t];
        struct reason reason = {""};
        struct bvh bvh;
        if (bvh_build(builder, scene, &options, &bvh, &reason))
            fail_msg("%s: %s", builder->name, reason.text);
        if (t > 0 && !built_same(&first, &bvh))
            fail_msg("%s: %u threads build another tree", builder->name, threads[t]);
        if (t > 0)
            bvh_free(&bvh);
        else
            first = bvh;
    }
    bvh_free(&first);
}

static void the_tree_does_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = large_scene();
    for (size_t b = 0; builders_all[b]; b++)
        if (is_lawful(builders_all[b]))
            check_threads(builders_all[b], &scene, (struct build_options){0}, false);
    scene_free(&scene);
}

/* Nor do reinsertion and rotations, whatever built the tree. */
static void passes_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = built_soup(17000, 3); /* so many are built by several threads */
    for (size_t b = 0; builders_all[b]; b++) {
        const struct builder *builder = builders_all[b];
        if (builder->compare || builder->faithful)
            continue;
        check_threads(builder, &scene, (struct build_options){.passes = 2}, true);
        check_threads(builder, &scene, (struct build_options){.passes = 1, .rotates = true}, true);
    }
    scene_free(&scene);
}

static double sah_of(const char *builder, const struct scene *scene,
                     const struct build_options *options)
{
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder_find(builder), scene, options, &bvh, &reason))
        fail_msg("%s: %s", builder, reason.text);
    double sah = tree_sah(&bvh);
    bvh_free(&bvh);
    return sah;
}

static void costs_are_in_the_order_of_the_effort(void **state)
{
    (void)state;
    struct scene scene = built_soup(5000, 8);
    const struct build_options usual = {.leaf = 4};
    const struct build_options few_bins = {.leaf = 4, .bins = 2};
    const struct build_options near = {.leaf = 4, .radius = 1};
    const struct build_options moved = {.leaf = 4, .passes = 4};
    double sweep = sah_of("sah_sweep", &scene, &usual);
    double binned = sah_of("sah_binned", &scene, &usual);
    double lbvh = sah_of("lbvh", &scene, &usual), ploc = sah_of("ploc", &scene, &usual);
    assert_true(sweep < 1.01 * binned);
    assert_true(binned < sah_of("sah_binned", &scene, &few_bins));
    assert_true(binned < 0.95 * sah_of("median", &scene, &usual));
    assert_true(binned < 0.95 * lbvh);
    assert_true(ploc < 0.95 * lbvh);
    assert_true(ploc != sah_of("ploc", &scene, &near));
    assert_true(sah_of("ploc", &scene, &moved) < 1.05 * sweep);
    assert_true(sah_of("lbvh", &scene, &moved) < 1.05 * sweep);
    assert_true(sah_of("sah_sweep", &scene, &moved) < sweep);
    scene_free(&scene);
}

/* The middle triangle of three belongs to the nearer one; each leaf costs its area. */
static void the_cost_of_a_tree_by_hand(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(1, v);
    const struct build_options options = {.leaf = 1};
    assert_true(sah_of("sah_binned", &scene, &options) == 1);
    scene_free(&scene);
    scene = trees_grid(3); /* [0, 1/8] x [0, 1/8], again from 1/4 and 1/2 on */
    double one = 0.125 * 0.125, two = 0.375 * 0.125, all = 0.625 * 0.125;
    assert_true(sah_of("sah_binned", &scene, &options) == (all + two + 3 * one) / all);
    struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED); /* 2 in one leaf, 1 in another */
    assert_true(tree_sah(&bvh) == (all + 2 * two + one) / all);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Two pairs of neighbours, far apart, in leaves that mix them: one move mends it. */
static void a_misplaced_triangle_is_moved(void **state)
{
    (void)state;
    static const float at[] = {0, 100, 1, 101, 50, 51};
    struct scene scene = trees_grid(6);
    for (uint32_t i = 0; i < 54; i++)
        scene.vertex[i] = (i % 3 == 0 ? at[i / 9] : 0) + (i % 9 == 3 || i % 9 == 7 ? 0.5f : 0);
    struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
    double before = tree_sah(&bvh);
    assert_int_equal(tree_reinsert(&bvh, 20, 1), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
    assert_true(tree_sah(&bvh) < 0.6 * before);
    const struct build_options options = {.leaf = 1};
    assert_true(tree_sah(&bvh) <= sah_of("sah_sweep", &scene, &options));
    bvh_free(&bvh);
    scene_free(&scene);
}

static void leaves_stay_as_they_are_when_they_move(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3000); /* in rows, which are long and thin */
    struct bvh bvh = trees_make(&scene, 3, TREES_BALANCED);
    double before = tree_sah(&bvh);
    assert_int_equal(tree_reinsert(&bvh, 2, 0), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
    assert_int_equal(bvh.node_count, 1999);
    assert_true(trees_leaves_are_whole(&bvh));
    double after = tree_sah(&bvh);
    assert_true(after < 0.7 * before);
    assert_int_equal(tree_reinsert(&bvh, 1, 0), STATUS_OK);
    assert_true(tree_sah(&bvh) <= after);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void leaves_are_made_where_they_cost_less(void **state)
{
    (void)state;
    struct scene scene = built_soup(2000, 6);
    for (size_t c = 0; c < (size_t)9 * 1000; c++) /* some triangles twice */
        scene.vertex[9 * 1000 + c] = scene.vertex[c];
    const struct build_options options = {.leaf = 1};
    struct bvh bvh;
    assert_int_equal(builder_find("lbvh")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    double before = tree_sah(&bvh);
    assert_int_equal(tree_collapse(&bvh, 4), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
    assert_in_range(bvh_counted(&bvh, &scene).largest_leaf, 2, 4);
    double after = tree_sah(&bvh);
    assert_true(after < before);
    uint32_t nodes = bvh.node_count;
    assert_int_equal(tree_collapse(&bvh, 4), STATUS_OK);
    assert_int_equal(bvh.node_count, nodes);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void as_published_is_not_optimized(void **state)
{
    (void)state;
    struct scene scene = trees_grid(30);
    const struct build_options options = {.leaf = 2, .eps = 0.02f, .passes = 1};
    struct reason reason = {""};
    struct bvh bvh;
    assert_int_equal(bvh_build(builder_find("rtrs"), &scene, &options, &bvh, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "rtrs"));
    assert_int_equal(bvh.node_count, 0);
    scene_free(&scene);
}

/* Sizes fall along the curve, so that every cluster would join the next one and only the last two
 * choose each other. */
static void sizes_that_fall_along_the_curve_do_not_stop_ploc(void **state)
{
    (void)state;
    struct scene scene = trees_grid(20000);
    for (size_t i = 0; i < (size_t)9 * 20000; i++) {
        float size = 1 - (float)(i / 9) / 20001;
        scene.vertex[i] =
            i % 3 == 0 ? (float)(i / 9) / 4096 + 100 * size * (i % 9 == 3) : size * (i % 9 == 7);
    }
    check_one(builder_find("ploc"), &scene, 4, "falling sizes");
    scene_free(&scene);
}

static void codes_cut_where_their_highest_bit_changes(void **state)
{
    (void)state;
    /* Cells 0, 1, 2 and 7 of 8 along x: 0 to 2 share the first bit, 0 and 1 the second. */
    static const float at[] = {0, 1, 2, 7};
    struct scene scene = trees_grid(4);
    for (uint32_t i = 0; i < 36; i++)
        scene.vertex[i] = i % 3 ? 0 : at[i / 9];
    const struct build_options options = {.leaf = 1};
    struct bvh bvh;
    assert_int_equal(builder_find("lbvh")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    static const uint32_t snd[] = {6, 5, 4, 0, 0, 0, 0};
    assert_int_equal(bvh.node_count, 7);
    for (uint32_t i = 0; i < 7; i++)
        assert_int_equal(bvh.node[i].snd, snd[i]);
    for (uint32_t i = 0; i < 4; i++)
        assert_int_equal(bvh.prim[i], i);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_well_formed_and_contain_their_triangles),
        cmocka_unit_test(few_triangles_of_any_number),
        cmocka_unit_test(the_tree_does_not_depend_on_the_number_of_threads),
        cmocka_unit_test(passes_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(costs_are_in_the_order_of_the_effort),
        cmocka_unit_test(the_cost_of_a_tree_by_hand),
        cmocka_unit_test(a_misplaced_triangle_is_moved),
        cmocka_unit_test(leaves_stay_as_they_are_when_they_move),
        cmocka_unit_test(leaves_are_made_where_they_cost_less),
        cmocka_unit_test(as_published_is_not_optimized),
        cmocka_unit_test(sizes_that_fall_along_the_curve_do_not_stop_ploc),
        cmocka_unit_test(codes_cut_where_their_highest_bit_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

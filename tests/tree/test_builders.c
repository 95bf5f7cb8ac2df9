/* Laws of ref/builders/: what every builder keeps, what median promises, what RTRS does. */
#include "ref/tree/bvh.h"
#include "ref/base/rng.h"
#include "tests/support/counted.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

static struct bvh build(const char *builder, const struct scene *scene, uint32_t leaf, float eps)
{
    struct bvh bvh;
    struct reason reason = {""};
    struct build_options options = {.leaf = leaf, .eps = eps};
    enum status status = builder_find(builder)->build(scene, &options, &bvh, &reason);
    if (status)
        fail_msg("%s: status %d, %s", builder, status, reason.text);
    return bvh;
}

/* Triangles whose distances from the origin halve: the middle splits off one at a time. */
static struct scene halving(uint32_t count)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++)
        for (int c = 0; c < 9; c++)
            scene.vertex[9 * (size_t)i + (size_t)c] = c % 3 == 0 ? ldexpf(1, 126 - (int)i) : 0;
    return scene;
}

/* All finite extremes: bounds whose extent overflows a float. */
static struct scene extremes(void)
{
    struct scene scene = built_soup(64, 5);
    for (int c = 0; c < 9 * 64; c++)
        scene.vertex[c] = scene.vertex[c] < 0 ? -3.4e38f : 3.4e38f;
    return scene;
}

/* A floor of quads x quads unit squares at height y, two triangles each. */
static struct scene floor_of(uint32_t quads, float y)
{
    struct scene scene;
    uint32_t side = quads + 1;
    assert_int_equal(scene_make(side * side, 2 * quads * quads, &scene), STATUS_OK);
    for (uint32_t i = 0; i < side * side; i++) {
        scene.vertex[3 * i] = (float)(i % side);
        scene.vertex[3 * i + 1] = y;
        scene.vertex[3 * i + 2] = (float)(i / side);
    }
    uint32_t *index = scene.index;
    for (uint32_t q = 0; q < quads * quads; q++) {
        uint32_t a = q / quads * side + q % quads;
        const uint32_t corner[] = {a, a + 1, a + side + 1, a, a + side + 1, a + side};
        memcpy(index, corner, sizeof corner);
        index += 6;
    }
    return scene;
}

static void builders_keep_every_triangle_once(void **state)
{
    (void)state;
    for (size_t b = 0; builders_all[b]; b++)
        for (uint32_t n = 1; n <= 2000; n = n < 20 ? n + 1 : n * 3) {
            struct scene scene = built_soup(n, n);
            struct bvh bvh = build(builders_all[b]->name, &scene, 4, 0.02f);
            struct reason reason = {""};
            if (bvh_check_form(&bvh, &scene, &reason))
                fail_msg("%s, %u triangles: %s", builders_all[b]->name, n, reason.text);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

static void builders_make_an_empty_tree_of_no_triangles(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    for (size_t b = 0; builders_all[b]; b++) {
        struct bvh bvh = build(builders_all[b]->name, &scene, 4, 0.02f);
        assert_int_equal(bvh.node_count, 0);
        assert_int_equal(bvh.prim_count, 0);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

static void builders_refuse_a_leaf_of_zero(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    struct build_options options = {.leaf = 0, .eps = 0.02f};
    for (size_t b = 0; builders_all[b]; b++) {
        struct bvh bvh = {.node_count = 7};
        struct reason reason = {""};
        assert_int_equal(builders_all[b]->build(&scene, &options, &bvh, &reason), STATUS_INPUT);
        assert_int_equal(bvh.node_count, 0);
        assert_non_null(strstr(reason.text, "leaf size is 0"));
    }
    scene_free(&scene);
}

static void builders_are_found_by_name(void **state)
{
    (void)state;
    for (size_t b = 0; builders_all[b]; b++)
        assert_ptr_equal(builder_find(builders_all[b]->name), builders_all[b]);
    assert_null(builder_find("medial"));
    assert_string_equal(builders_all[0]->name, "median");
}

static void check_median(const struct scene *scene, const char *what)
{
    for (uint32_t leaf = 1; leaf <= 9; leaf++) {
        struct bvh bvh = build("median", scene, leaf, 0.02f);
        struct bvh_stats stats = bvh_counted(&bvh, scene);
        struct reason reason = {""};
        if (bvh_check(&bvh, scene, &reason))
            fail_msg("%s, leaf %u: %s", what, leaf, reason.text);
        assert_true(stats.largest_leaf <= leaf);
        assert_true(stats.depth <= 60);
        bvh_free(&bvh);
    }
}

static void median_has_tight_boxes_and_keeps_its_limits(void **state)
{
    (void)state;
    static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct scene scene[] = {built_soup(1, 1),      built_soup(5000, 2), halving(270),
                            trees_copies(37, one), floor_of(12, 0.1f),  extremes()};
    static const char *const what[] = {"one", "soup", "halving", "copies", "floor", "extremes"};
    for (size_t i = 0; i < ARRAY_COUNT(scene); i++) {
        check_median(&scene[i], what[i]);
        scene_free(&scene[i]);
    }
}

/* Without the bound the middle would give a chain as deep as the scene has triangles. */
static void median_halves_where_the_middle_would_grow_a_chain(void **state)
{
    (void)state;
    struct scene scene = halving(270);
    struct bvh bvh = build("median", &scene, 1, 0.02f);
    uint32_t depth = bvh_counted(&bvh, &scene).depth;
    assert_true(depth > 50 && depth <= 60);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void median_splits_copies_in_index_order(void **state)
{
    (void)state;
    static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(100, one);
    struct bvh bvh = build("median", &scene, 4, 0.02f);
    for (uint32_t i = 0; i < 100; i++)
        assert_int_equal(bvh.prim[i], i);
    assert_int_equal(bvh_counted(&bvh, &scene).depth, 5);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void median_is_the_same_every_time_and_ignores_eps(void **state)
{
    (void)state;
    struct scene scene = built_soup(3000, 9);
    struct bvh a = build("median", &scene, 3, 0.02f), b = build("median", &scene, 3, NAN);
    assert_int_equal(a.node_count, b.node_count);
    assert_memory_equal(a.node, b.node, a.node_count * sizeof *a.node);
    assert_memory_equal(a.prim, b.prim, a.prim_count * sizeof *a.prim);
    bvh_free(&a);
    bvh_free(&b);
    scene_free(&scene);
}

/* Where nothing is flat or empty both builders decide alike, but for the centroid's rounding. */
static void median_is_the_twin_of_rtrs_on_a_plain_grid(void **state)
{
    (void)state;
    struct scene scene = trees_grid(4096);
    struct bvh a = build("median", &scene, 4, 0.02f), b = build("rtrs", &scene, 4, 0.02f);
    assert_int_equal(a.node_count, b.node_count);
    assert_memory_equal(a.node, b.node, a.node_count * sizeof *a.node);
    assert_memory_equal(a.prim, b.prim, a.prim_count * sizeof *a.prim);
    bvh_free(&a);
    bvh_free(&b);
    scene_free(&scene);
}

/* F4: in the plane y = 0.1 the centroid rounds to 0.10000001, out of every half box. */
static void rtrs_cannot_split_a_floor_whose_centroids_round_up(void **state)
{
    (void)state;
    struct scene scene = floor_of(3, 0.1f);
    struct bvh bvh = build("rtrs", &scene, 4, 0.02f);
    static const float lo[3] = {2.994f, 0.1f, 2.994f}, hi[3] = {3, 0.1f, 3};
    assert_int_equal(bvh.node_count, 1);
    assert_int_equal(bvh.node[0].item_count, 18);
    for (int k = 0; k < 3; k++) {
        assert_true(fabsf(bvh.node[0].bounds.lo[k] - lo[k]) < 0.0005f);
        assert_true(bvh.node[0].bounds.hi[k] == hi[k]);
    }
    assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_INPUT);
    bvh_free(&bvh);
    scene_free(&scene);
    scene = floor_of(3, 0.5f); /* a height that survives the rounding */
    bvh = build("rtrs", &scene, 4, 0.02f);
    assert_true(bvh_counted(&bvh, &scene).largest_leaf <= 4);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* F5: five copies, so that every cut leaves one side empty, until eps ends it. */
static void rtrs_keeps_the_cut_box_of_a_leaf(void **state)
{
    (void)state;
    static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(5, one);
    struct bvh bvh = build("rtrs", &scene, 4, 0.02f);
    assert_int_equal(bvh.node_count, 1);
    assert_int_equal(bvh.node[0].item_count, 5);
    for (int k = 0; k < 2; k++) {
        assert_true(bvh.node[0].bounds.lo[k] == 42.0f / 128);
        assert_true(bvh.node[0].bounds.hi[k] == 43.0f / 128);
    }
    assert_true(bvh.node[0].bounds.lo[2] == 0 && bvh.node[0].bounds.hi[2] == 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Returns whether rtrs ends on five copies of a triangle. */
static bool rtrs_ends_on(const float v[3][3], float eps)
{
    struct scene scene = trees_copies(5, v);
    struct bvh bvh;
    struct reason reason = {""};
    struct build_options options = {.leaf = 4, .eps = eps};
    enum status status = builder_find("rtrs")->build(&scene, &options, &bvh, &reason);
    if (status) {
        assert_int_equal(status, STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "RTRS never ends here (fault F19,"));
        assert_null(bvh.node);
    }
    bvh_free(&bvh);
    scene_free(&scene);
    return status == STATUS_OK;
}

/* The same for a right triangle of this size at (at, at, 0). */
static bool rtrs_ends(float at, float size, float eps)
{
    const float v[3][3] = {{at, at, 0}, {at + size, at, 0}, {at, at + size, 0}};
    return rtrs_ends_on(v, eps);
}

static void rtrs_refuses_where_the_seed_never_ends(void **state)
{
    (void)state;
    assert_false(rtrs_ends(0, 1, 0));
    assert_false(rtrs_ends(0, 1, -1));
    assert_false(rtrs_ends(0, 1, NAN));
    assert_true(rtrs_ends(0, 1, 1e-6f));
    assert_false(rtrs_ends(0, 1, 1e-9f)); /* below the distance of floats at 1/3 */
    assert_true(rtrs_ends(0, 1, INFINITY));
    assert_true(rtrs_ends(1e5f, 0.25f, 0.02f));
    assert_false(rtrs_ends(1e6f, 0.25f, 0.02f));
    assert_true(rtrs_ends(1e7f, 0.25f, 0.02f));
    static const float wide[3][3] = {{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 1, 0}};
    assert_false(rtrs_ends_on(wide, 0.02f)); /* the extent is infinite, and so is its half */
}

/* The numbers of the refusal: five of seven triangles from the third on, and a box whose half
 * rounds to itself. */
static void rtrs_says_where_the_seed_never_ends(void **state)
{
    (void)state;
    struct scene scene = trees_grid(7);
    for (size_t c = 0; c < 63; c++) {
        bool low = c % 9 == 4 || c % 9 == 6;
        scene.vertex[c] = (c < 18 ? 100 : 0) + (low ? 0.5f : c % 3 == 1 ? 1 : 0);
    }
    struct bvh bvh;
    struct reason reason = {""};
    const struct build_options options = {.leaf = 4, .eps = 1e-30f};
    assert_int_equal(builder_find("rtrs")->build(&scene, &options, &bvh, &reason), STATUS_LIMIT);
    unsigned count, first;
    char axis;
    float lo, hi, eps;
    assert_int_equal(sscanf(reason.text,
                            "rtrs: RTRS never ends here (fault F19, docs/rtrs-faults.md): "
                            "%u triangles, the first is %u, in a box whose half %c [%a, %a] is "
                            "itself; eps %g",
                            &count, &first, &axis, &lo, &hi, &eps),
                     6);
    assert_true(count == 5 && first == 2 && axis == 'y' && eps == 1e-30f);
    float middle = lo + (hi - lo) * 0.5f;
    assert_true(lo < hi && (middle == lo || middle == hi) && lo > 0.5f && hi < 1);
    scene_free(&scene);
}

/* Ties: x before y before z, and the middle belongs to the first child. */
static void rtrs_breaks_ties_as_the_seed_does(void **state)
{
    (void)state;
    struct scene scene = trees_grid(4);
    static const float centre[4][3] = {{3, 0, 3}, {0, 3, 0}, {0, 0, 3}, {3, 3, 0}};
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 9; c++)
            scene.vertex[9 * i + c] = centre[i][c % 3];
    struct bvh bvh = build("rtrs", &scene, 2, 0.02f);
    static const uint32_t by_x[] = {1, 2, 0, 3};
    assert_memory_equal(bvh.prim, by_x, sizeof by_x);
    bvh_free(&bvh);
    for (int c = 0; c < 9; c++) { /* 0: x exactly in the middle of 0 .. 3 */
        scene.vertex[c] = c % 3 == 0 ? 1.5f : 3;
        scene.vertex[27 + c] = 3;
    }
    bvh = build("rtrs", &scene, 3, 0.02f);
    static const uint32_t middle_first[] = {0, 1, 2, 3};
    assert_memory_equal(bvh.prim, middle_first, sizeof middle_first);
    assert_int_equal(bvh.node[1].item_count, 3);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(builders_keep_every_triangle_once),
        cmocka_unit_test(builders_make_an_empty_tree_of_no_triangles),
        cmocka_unit_test(builders_refuse_a_leaf_of_zero),
        cmocka_unit_test(builders_are_found_by_name),
        cmocka_unit_test(median_has_tight_boxes_and_keeps_its_limits),
        cmocka_unit_test(median_halves_where_the_middle_would_grow_a_chain),
        cmocka_unit_test(median_splits_copies_in_index_order),
        cmocka_unit_test(median_is_the_same_every_time_and_ignores_eps),
        cmocka_unit_test(median_is_the_twin_of_rtrs_on_a_plain_grid),
        cmocka_unit_test(rtrs_cannot_split_a_floor_whose_centroids_round_up),
        cmocka_unit_test(rtrs_keeps_the_cut_box_of_a_leaf),
        cmocka_unit_test(rtrs_refuses_where_the_seed_never_ends),
        cmocka_unit_test(rtrs_says_where_the_seed_never_ends),
        cmocka_unit_test(rtrs_breaks_ties_as_the_seed_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Trees in stages in C: laws of each stage, what a comparison names, and what is no tree. */
#include "ref/staged/staged.h"
#include "ref/tree/tree_quality.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static struct staged staged_of(enum staged_kind kind, const struct scene *scene)
{
    struct staged staged;
    struct reason reason = {""};
    if (staged_build(kind, scene, &staged, NULL, &reason))
        fail_msg("%s", reason.text);
    return staged;
}

static uint64_t code_at(const struct staged *staged, uint32_t place)
{
    return staged->code[staged->order[place]];
}

static void codes_are_in_order_and_equal_ones_by_number(void **state)
{
    (void)state;
    for (size_t i = 0; i < BUILT_SCENES; i++) {
        const char *what;
        struct scene scene = built_scene(i, &what);
        for (int k = 0; k < STAGED_KINDS; k++) {
            struct staged staged = staged_of((enum staged_kind)k, &scene);
            for (uint32_t p = 1; p < staged.count; p++) {
                uint64_t before = code_at(&staged, p - 1), after = code_at(&staged, p);
                assert_true(before < after ||
                            (before == after && staged.order[p - 1] < staged.order[p]));
                assert_int_equal(after >> (k == STAGED_LBVH30 ? 30 : 63), 0);
            }
            staged_free(&staged);
        }
        scene_free(&scene);
    }
}

/* A cell of the last of `bits` levels, from the interleaved code. */
static uint32_t cell_of(uint64_t code, uint32_t bits, uint32_t axis)
{
    uint32_t cell = 0;
    for (uint32_t b = 0; b < bits; b++)
        cell |= (uint32_t)(code >> (3 * b + 2 - axis) & 1) << b;
    return cell;
}

/* Triangles at whole numbers: a cell is the doubled centre less the scene's corner, in units of a
 * power of two that leaves more than half of the cells. */
static void cells_are_cubes_of_the_scene(void **state)
{
    (void)state;
    static const struct {
        float at[3];
        uint32_t cell30[3], cell63[3];
    } rows[] = {
        {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
        {{100, 0, 0}, {800, 0, 0}, {1638400, 0, 0}},
        {{50, 25, 0}, {400, 200, 0}, {819200, 409600, 0}},
        {{0, 0, 99}, {0, 0, 792}, {0, 0, 1622016}},
        {{1, 2, 3}, {8, 16, 24}, {16384, 32768, 49152}},
    };
    struct scene scene = trees_grid(ARRAY_COUNT(rows));
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++)
        for (size_t c = 0; c < 9; c++)
            scene.vertex[9 * i + c] = rows[i].at[c % 3] - 30;
    struct staged small = staged_of(STAGED_LBVH30, &scene), fine = staged_of(STAGED_HPLOC, &scene);
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++)
        for (uint32_t k = 0; k < 3; k++) {
            assert_int_equal(cell_of(small.code[i], 10, k), rows[i].cell30[k]);
            assert_int_equal(cell_of(fine.code[i], 21, k), rows[i].cell63[k]);
        }
    staged_free(&small);
    staged_free(&fine);
    scene_free(&scene);
}

/* Returns the places below a link, which must be one range; `end` is one past the last. */
static uint32_t range_of(const struct staged *staged, uint32_t link, uint32_t *end)
{
    if (link & STAGED_LEAF) {
        *end = (link & ~STAGED_LEAF) + 1;
        return link & ~STAGED_LEAF;
    }
    uint32_t middle, from;
    uint32_t first = range_of(staged, staged->child[link][0], &middle);
    from = range_of(staged, staged->child[link][1], end);
    assert_int_equal(from, middle);
    uint64_t a = code_at(staged, middle - 1), b = code_at(staged, middle);
    uint64_t all = code_at(staged, first) ^ code_at(staged, *end - 1);
    if (all)
        assert_int_equal(__builtin_clzll(a ^ b), __builtin_clzll(all));
    else
        assert_int_equal(__builtin_clz((middle - 1) ^ middle), __builtin_clz(first ^ (*end - 1)));
    assert_true(link == first || link == *end - 1);
    return first;
}

static void ranges_are_cut_at_the_highest_bit(void **state)
{
    (void)state;
    for (size_t i = 0; i < BUILT_SCENES; i++)
        for (int k = STAGED_LBVH30; k <= STAGED_LBVH63; k++) {
            const char *what;
            struct scene scene = built_scene(i, &what);
            struct staged staged = staged_of((enum staged_kind)k, &scene);
            uint32_t end;
            assert_int_equal(staged.root, 0);
            assert_int_equal(range_of(&staged, staged.root, &end), 0);
            assert_int_equal(end, staged.count);
            staged_free(&staged);
            scene_free(&scene);
        }
}

static double cost_of(enum staged_kind kind, const struct scene *scene)
{
    struct staged staged = staged_of(kind, scene);
    struct tree_quality quality;
    struct bvh bvh;
    struct reason reason = {""};
    if (staged_write(&staged, 4, &bvh, &reason) || bvh_check(&bvh, scene, &reason) ||
        tree_quality(&bvh, scene, &quality, &reason))
        fail_msg("%s", reason.text);
    bvh_free(&bvh);
    staged_free(&staged);
    return quality.sah;
}

static void merging_by_area_costs_less_than_cutting(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 10; seed++) {
        struct scene scene = built_soup(3000, seed);
        assert_true(cost_of(STAGED_HPLOC, &scene) < cost_of(STAGED_LBVH63, &scene));
        assert_true(cost_of(STAGED_LBVH63, &scene) < 1.02 * cost_of(STAGED_LBVH30, &scene));
        scene_free(&scene);
    }
}

/* At most 16 clusters are left of each half of the codes: at most 31 nodes have leaves of both. */
static void clusters_stay_in_their_ranges(void **state)
{
    (void)state;
    struct scene scene = built_soup(600, 1);
    struct staged codes = staged_of(STAGED_LBVH63, &scene), tree = staged_of(STAGED_HPLOC, &scene);
    uint32_t cut, crossing = 0;
    (void)range_of(&codes, codes.child[0][0], &cut);
    for (uint32_t i = 0; i + 1 < tree.count; i++) {
        bool low = false, high = false;
        uint32_t stack[64], open = 0;
        stack[open++] = i;
        while (open > 0) {
            uint32_t link = stack[--open];
            if (link & STAGED_LEAF) {
                low = low || (link & ~STAGED_LEAF) < cut;
                high = high || (link & ~STAGED_LEAF) >= cut;
            } else {
                stack[open++] = tree.child[link][0];
                stack[open++] = tree.child[link][1];
                assert_true(open < 62);
            }
        }
        crossing += low && high;
    }
    assert_true(crossing >= 1 && crossing <= 31);
    staged_free(&codes);
    staged_free(&tree);
    scene_free(&scene);
}

static void a_difference_is_named_by_stage_and_element(void **state)
{
    (void)state;
    struct scene scene = built_soup(100, 2);
    struct staged mine = staged_of(STAGED_HPLOC, &scene), other = staged_of(STAGED_HPLOC, &scene);
    assert_null(staged_compare(&mine, &other).stage);
    assert_int_equal(staged_compare(&mine, &other).count, 0);
    mine.root = 5;
    assert_string_equal(staged_compare(&mine, &other).stage, "links");
    assert_int_equal(staged_compare(&mine, &other).count, 1);
    mine.root = other.root;
    other.box[198][5] ^= 1;
    struct staged_difference at = staged_compare(&mine, &other);
    assert_string_equal(at.stage, "boxes");
    assert_int_equal(at.element, 198);
    other.box[3][0] ^= 1;
    at = staged_compare(&mine, &other);
    assert_int_equal(at.element, 3);
    assert_int_equal(at.count, 2);
    mine.child[98][1] = STAGED_LEAF | 7;
    other.child[98][1] = 6;
    at = staged_compare(&mine, &other);
    assert_string_equal(at.stage, "links");
    assert_int_equal(at.element, 98);
    assert_non_null(strstr(at.text, "leaf 7, not "));
    assert_non_null(strstr(at.text, "node 6"));
    mine.order[99] = 12;
    other.order[99] = 13;
    at = staged_compare(&mine, &other);
    assert_string_equal(at.stage, "order");
    assert_int_equal(at.element, 99);
    assert_string_equal(at.text, "triangle 12, not triangle 13");
    mine.code[0] = 0x123456789ABCull;
    other.code[0] = 1;
    at = staged_compare(&mine, &other);
    assert_string_equal(at.stage, "codes");
    assert_int_equal(at.element, 0);
    assert_string_equal(at.text, "0x123456789abc, not 0x1");
    staged_free(&mine);
    staged_free(&other);
    scene_free(&scene);
}

static void refuse(const struct staged *staged, const char *rule)
{
    struct bvh bvh;
    struct reason reason = {""};
    assert_int_equal(staged_write(staged, 4, &bvh, &reason), STATUS_DEVICE);
    if (!strstr(reason.text, rule))
        fail_msg("'%s', not '%s'", reason.text, rule);
    assert_null(bvh.node);
    assert_int_equal(bvh.node_count, 0);
}

static void what_is_no_tree_is_refused(void **state)
{
    (void)state;
    struct scene scene = built_soup(50, 4);
    struct staged staged = staged_of(STAGED_LBVH63, &scene);
    const uint32_t fst = staged.child[0][0], snd = staged.child[0][1];
    const uint32_t order = staged.order[7];
    staged.root = 49;
    refuse(&staged, "node 49 is out of range");
    staged.root = STAGED_LEAF | 50;
    refuse(&staged, "leaf 50 is out of range");
    staged.root = STAGED_LEAF | 3;
    refuse(&staged, "1 of 99 nodes below the root");
    staged.root = fst;
    refuse(&staged, "of 99 nodes below the root");
    staged.root = 0;
    staged.child[0][1] = fst;
    refuse(&staged, "has two parents");
    staged.child[0][1] = 0;
    refuse(&staged, "node 0 has two parents");
    staged.child[0][1] = UINT32_MAX;
    refuse(&staged, "leaf 2147483647 is out of range");
    staged.child[0][1] = snd;
    staged.order[7] = 50;
    refuse(&staged, "leaf 7 names no triangle");
    staged.order[7] = staged.order[8];
    refuse(&staged, "twice");
    staged.order[7] = order;
    struct bvh bvh;
    assert_int_equal(staged_write(&staged, 4, &bvh, NULL), STATUS_OK);
    bvh_free(&bvh);
    staged_free(&staged);
    scene_free(&scene);
}

static void leaves_are_merged(void **state)
{
    (void)state;
    struct scene scene = built_soup(300, 6);
    uint32_t nodes[2];
    for (uint32_t leaf = 1; leaf <= 4; leaf += 3) {
        struct staged staged = staged_of(STAGED_HPLOC, &scene);
        struct bvh bvh;
        assert_int_equal(staged_write(&staged, leaf, &bvh, NULL), STATUS_OK);
        struct bvh_stats stats;
        assert_int_equal(bvh_count(&bvh, &scene, &stats, NULL), STATUS_OK);
        assert_true(leaf == 1 ? stats.largest_leaf == 1 : stats.largest_leaf > 1);
        nodes[leaf > 1] = bvh.node_count;
        bvh_free(&bvh);
        staged_free(&staged);
    }
    assert_int_equal(nodes[0], 599);
    assert_true(nodes[1] < nodes[0]);
    scene_free(&scene);
}

/* A chain of 200 levels becomes as shallow as every builder's tree; its boxes, which are wrong on
 * purpose, are kept in a shallow one. */
static void deep_trees_are_halved(void **state)
{
    (void)state;
    struct scene scene = built_soup(200, 5);
    struct staged staged = staged_of(STAGED_LBVH63, &scene);
    struct bvh bvh;
    struct reason reason = {""};
    staged.box[staged.root][0] = float_bits(-1000);
    assert_int_equal(staged_write(&staged, 4, &bvh, &reason), STATUS_OK);
    assert_true(bvh.node[0].bounds.lo[0] == -1000);
    bvh_free(&bvh);
    for (uint32_t i = 0; i < 199; i++) {
        staged.child[i][0] = STAGED_LEAF | i;
        staged.child[i][1] = i < 198 ? i + 1 : STAGED_LEAF | 199;
    }
    staged.root = 0;
    assert_int_equal(staged_write(&staged, 1, &bvh, &reason), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &scene, &reason), STATUS_OK);
    struct bvh_stats stats;
    assert_int_equal(bvh_count(&bvh, &scene, &stats, NULL), STATUS_OK);
    assert_true(stats.depth <= 60 && stats.depth >= 50);
    bvh_free(&bvh);
    staged_free(&staged);
    scene_free(&scene);
}

/* Each part takes some time, and together no more than there was; without a place for it, none is
 * told. Freed twice is freed once. */
static void times_are_told_part_by_part(void **state)
{
    (void)state;
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_open("sphere:n=40", 1, &scene, &reason), STATUS_OK);
    for (int k = 0; k < STAGED_KINDS; k++) {
        uint64_t ns[STAGED_PARTS], sum = 0, before = time_ns();
        struct staged staged;
        assert_int_equal(staged_build((enum staged_kind)k, &scene, &staged, ns, &reason),
                         STATUS_OK);
        const uint64_t whole = time_ns() - before;
        for (int part = 0; part < STAGED_PARTS; part++) {
            assert_true(ns[part] > 0);
            sum += ns[part];
        }
        assert_true(sum <= whole);
        staged_free(&staged);
        staged_free(&staged);
        assert_int_equal(staged.count, 0);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_in_order_and_equal_ones_by_number),
        cmocka_unit_test(cells_are_cubes_of_the_scene),
        cmocka_unit_test(ranges_are_cut_at_the_highest_bit),
        cmocka_unit_test(merging_by_area_costs_less_than_cutting),
        cmocka_unit_test(clusters_stay_in_their_ranges),
        cmocka_unit_test(a_difference_is_named_by_stage_and_element),
        cmocka_unit_test(what_is_no_tree_is_refused),
        cmocka_unit_test(leaves_are_merged),
        cmocka_unit_test(deep_trees_are_halved),
        cmocka_unit_test(times_are_told_part_by_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

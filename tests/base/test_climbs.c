/* Trees that are changed from below: treelets (trbvh) and rotations. What a round may not do is
 * tested on trees of every kind, what it must do on few triangles, where all trees can be tried. */
#include "ref/build/links.h"
#include "ref/builders/rotate.h"
#include "ref/builders/treelets.h"
#include "ref/tree/bvh.h"
#include "ref/tree/tree_quality.h"
#include "tests/support/built.h"
#include "tests/support/counted.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static struct bvh built_by(const char *builder, const struct scene *scene,
                           struct build_options options)
{
    struct reason reason = {""};
    struct bvh bvh;
    if (bvh_build(builder_find(builder), scene, &options, &bvh, &reason))
        fail_msg("%s: %s", builder, reason.text);
    return bvh;
}

/* Sum of areas: 1 for a node, as many as it has items for a leaf. */
static double cost_of(const struct bvh *bvh)
{
    double cost = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        cost += box_half_area(&bvh->node[i].bounds) *
                (bvh->node[i].item_count ? bvh->node[i].item_count : 1);
    return cost;
}

/* --- few triangles ---------------------------------------------------------------------------- */

/* The least cost of all trees of a set of triangles, each in a leaf of its own. */
static double least_of(const struct scene *scene, uint32_t set)
{
    struct box all = box_empty();
    for (uint32_t i = 0; i < scene->tri_count; i++)
        if (set >> i & 1) {
            struct box one = scene_tri_bounds(scene, i);
            box_add_box(&all, &one);
        }
    double least = INFINITY, area = box_half_area(&all);
    for (uint32_t part = (set - 1) & set; part > set - part; part = (part - 1) & set)
        least = fmin(least, area + least_of(scene, part) + least_of(scene, set - part));
    return set & (set - 1) ? least : area;
}

/* Of few coordinates, so that many boxes are much the same and leaves of several triangles cost
 * least. */
static struct scene coarse(uint32_t count, uint64_t seed)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(seed, 1);
    for (size_t i = 0; i < 9 * (size_t)count; i++)
        scene.vertex[i] = (float)rng_below(&rng, 3);
    return scene;
}

static void up_to_seven_triangles_cost_the_least(void **state)
{
    (void)state;
    for (uint32_t n = 1; n <= 7; n++)
        for (uint64_t seed = 0; seed < 60; seed++) {
            struct scene scene = seed % 2 ? coarse(n, seed) : built_soup(n, seed);
            struct bvh bvh = built_by("trbvh", &scene, (struct build_options){.leaf = 1});
            double cost = cost_of(&bvh), least = least_of(&scene, (1u << n) - 1);
            if (fabs(cost - least) > 1e-12 * least)
                fail_msg("%u triangles, seed %u: %.17g, not %.17g", n, (unsigned)seed, cost, least);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

/* Triangle 0 is beside the last of three in the codes' order, far from the first, of which each
 * tree that has them apart is dearer. */
static void a_child_and_a_grandchild_change_places(void **state)
{
    (void)state;
    static const float at[] = {50, 0, 52};
    struct scene scene = trees_grid(3);
    for (uint32_t i = 0; i < 27; i++)
        scene.vertex[i] = (i % 3 == 0 ? at[i / 9] : 0) + (i % 9 == 3 || i % 9 == 7 ? 1.0f : 0);
    for (int shape = TREES_LEFT; shape <= TREES_RIGHT; shape++) {
        struct bvh bvh = trees_make(&scene, 1, (enum trees_shape)shape);
        assert_int_equal(tree_rotate(&bvh, 1, 1), STATUS_OK);
        assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
        assert_true(cost_of(&bvh) == 53.0 + 3 + 3 * 1); /* [0, 53], [50, 53], 3 of 1 */
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* Triangles 0 and 1 lie between 2 and 3: to put them beside the nearer one gains most, in whatever
 * order. */
static void the_best_of_four_is_taken(void **state)
{
    (void)state;
    for (int order = 0; order < 4; order++) {
        const float at[2][2] = {{40, 42}, {order % 2 ? 100 : 0, order % 2 ? 0 : 100}};
        struct scene scene = trees_grid(4);
        for (uint32_t i = 0; i < 36; i++)
            scene.vertex[i] = (i % 3 == 0 ? at[(i / 18) ^ (uint32_t)(order / 2)][i / 9 % 2] : 0) +
                              (i % 9 == 3 || i % 9 == 7 ? 1.0f : 0);
        struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
        assert_int_equal(tree_rotate(&bvh, 1, 1), STATUS_OK);
        assert_true(cost_of(&bvh) == 101.0 + 43 + 3 + 4 * 1); /* [0, 101], [0, 43], [40, 43] */
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* --- the cost --------------------------------------------------------------------------------- */

/* Long thin triangles side by side, as many as `built_scene` has; and a pile of one triangle. */
static struct scene needles(uint32_t count)
{
    struct scene scene = trees_grid(count);
    struct rng rng = rng_make(5, 0);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float *v = scene.vertex + 9 * i + k;
            v[0] = rng_range(&rng, -1, 1);
            v[3] = rng_range(&rng, -1, 1);
            v[6] = v[0] + rng_range(&rng, -0.01f, 0.01f);
        }
    return scene;
}

#define KINDS (BUILT_SCENES + 2u)

static struct scene kind_of_scene(size_t i, const char **what)
{
    *what = i == BUILT_SCENES ? "needles" : "pile";
    if (i == BUILT_SCENES)
        return needles(1000);
    if (i > BUILT_SCENES)
        return trees_copies(700, (const float[3][3]){{0, 0, 0}, {1, 0, 0}, {0, 1, 2}});
    return built_scene(i, what);
}

enum climbing { TREELETS, ROTATIONS };

static enum status changed(enum climbing change, struct bvh *bvh, uint32_t leaf, uint32_t rounds)
{
    return change == TREELETS ? tree_treelets(bvh, leaf, rounds, 1) : tree_rotate(bvh, rounds, 1);
}

/* The cost after so many rounds; with leaves as treelets count them. */
static double cost_after(const char *builder, const struct scene *scene, enum climbing change,
                         uint32_t leaf, uint32_t rounds)
{
    struct bvh bvh = built_by(builder, scene, (struct build_options){.leaf = 1});
    assert_int_equal(changed(change, &bvh, leaf, rounds), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, scene, NULL), STATUS_OK);
    assert_in_range(bvh_counted(&bvh, scene).depth, 0, 60);
    assert_int_equal(bvh.node_count, 2 * scene->tri_count - 1);
    if (change == TREELETS)
        assert_int_equal(tree_collapse(&bvh, leaf), STATUS_OK);
    double cost = cost_of(&bvh);
    bvh_free(&bvh);
    return cost;
}

static void no_round_raises_the_cost(void **state)
{
    static const char *const names[] = {"lbvh", "ploc", "sah_sweep", "median"};
    (void)state;
    for (size_t i = 0; i < KINDS * ARRAY_COUNT(names); i++)
        for (uint32_t c = 0; c < 6; c++) {
            const char *what, *builder = names[i % ARRAY_COUNT(names)];
            const uint32_t leaf = 1 + c / 2 * 3;
            struct scene scene = kind_of_scene(i / ARRAY_COUNT(names), &what);
            double before = cost_after(builder, &scene, c % 2, leaf, 0);
            for (uint32_t rounds = 1; rounds <= 5; rounds++) {
                double after = cost_after(builder, &scene, c % 2, leaf, rounds);
                if (!(after <= before))
                    fail_msg("%s, %s of %s, leaf %u, round %u: from %.17g to %.17g", what,
                             c % 2 ? "rotations" : "treelets", builder, leaf, rounds, before,
                             after);
                before = after;
            }
            scene_free(&scene);
        }
}

static void rounds_lower_the_cost(void **state)
{
    (void)state;
    struct scene scene = built_soup(3000, 1);
    for (int change = TREELETS; change <= ROTATIONS; change++) {
        double before = cost_after("lbvh", &scene, (enum climbing)change, 1, 0);
        double one = cost_after("lbvh", &scene, (enum climbing)change, 1, 1);
        double three = cost_after("lbvh", &scene, (enum climbing)change, 1, 3);
        assert_true(one < (change == TREELETS ? 0.95 : 0.98) * before);
        assert_true(three < 0.999 * one);
    }
    assert_true(cost_after("lbvh", &scene, TREELETS, 1, 3) <
                cost_after("lbvh", &scene, ROTATIONS, 1, 3));
    scene_free(&scene);
}

/* Treelets that know which small subtrees will be leaves end cheaper than those that do not,
 * however often these are made. */
static void treelets_count_leaves_as_they_will_be(void **state)
{
    (void)state;
    double known = 0, unknown = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct scene scene = coarse(60, seed);
        double least = INFINITY;
        for (uint32_t rounds = 0; rounds <= 3; rounds++) {
            struct bvh bvh = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
            assert_int_equal(tree_treelets(&bvh, 1, rounds, 1), STATUS_OK);
            assert_int_equal(tree_collapse(&bvh, 8), STATUS_OK);
            least = fmin(least, cost_of(&bvh));
            bvh_free(&bvh);
        }
        unknown += least;
        known += cost_after("lbvh", &scene, TREELETS, 8, 3);
        scene_free(&scene);
    }
    assert_true(known < 0.999 * unknown);
}

/* trbvh is lbvh after three rounds that count leaves as they will be. */
static void trbvh_is_three_rounds(void **state)
{
    (void)state;
    struct scene scene = built_soup(3000, 2);
    for (uint32_t leaf = 1; leaf <= 9; leaf += 4) {
        struct bvh bvh = built_by("trbvh", &scene, (struct build_options){.leaf = leaf});
        double cost = cost_of(&bvh);
        assert_true(cost == cost_after("lbvh", &scene, TREELETS, leaf, 3));
        assert_true(cost < cost_after("lbvh", &scene, TREELETS, leaf, 2));
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* --- what is kept ----------------------------------------------------------------------------- */

/* Equal triangles: all trees cost the same. */
static void equal_costs_keep_what_was_there(void **state)
{
    (void)state;
    static const float flat[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (uint32_t n = 1; n <= 200; n += 1 + n / 3) {
        struct scene scene = trees_copies(n, flat);
        struct bvh was = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
        for (int change = TREELETS; change <= ROTATIONS; change++) {
            struct bvh bvh = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
            assert_int_equal(changed((enum climbing)change, &bvh, 1, 3), STATUS_OK);
            assert_true(built_same(&was, &bvh));
            bvh_free(&bvh);
        }
        bvh_free(&was);
        scene_free(&scene);
    }
}

/* Equal triangles beside others whose trees are changed. */
static void equal_costs_are_kept_beside_others(void **state)
{
    (void)state;
    struct scene scene = built_soup(90, 3);
    for (size_t c = 0; c < 9 * (size_t)40; c++)
        scene.vertex[c] = (c % 3 == 0 ? 1e4f : 0) + (float)(c % 9 == 3 || c % 9 == 7);
    for (int change = TREELETS; change <= ROTATIONS; change++) {
        struct bvh was = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
        struct bvh bvh = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
        assert_int_equal(changed((enum climbing)change, &bvh, 1, 3), STATUS_OK);
        assert_false(built_same(&was, &bvh));
        /* The second half of the root's, the last 79 nodes. */
        uint32_t first = bvh.node_count - 79;
        assert_int_equal(was.node[0].snd, first);
        assert_int_equal(bvh.node[0].snd, first);
        assert_memory_equal(&was.node[first], &bvh.node[first], 79 * sizeof *bvh.node);
        assert_memory_equal(&was.prim[50], &bvh.prim[50], 40 * sizeof *bvh.prim);
        bvh_free(&was);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* What node `up`, a child of `other`, and `down`, the sibling of `other`, would save by changing
 * places. */
static double saved(const struct bvh *bvh, uint32_t other, uint32_t down, uint32_t up)
{
    const struct bvh_node *node = &bvh->node[other];
    struct box box = bvh->node[down].bounds;
    box_add_box(&box, &bvh->node[node->fst == up ? node->snd : node->fst].bounds);
    return box_half_area(&node->bounds) - box_half_area(&box);
}

/* Rounds go on as long as there is something to gain. */
static void where_rotations_end_no_node_gains(void **state)
{
    (void)state;
    struct scene scene = built_soup(400, 4);
    struct bvh bvh = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
    assert_int_equal(tree_rotate(&bvh, 1000, 1), STATUS_OK);
    for (uint32_t i = 0; i < bvh.node_count; i++) {
        const struct bvh_node *node = &bvh.node[i];
        const uint32_t child[2] = {node->fst, node->snd};
        for (int k = 0; k < 2 && node->item_count == 0; k++) {
            const struct bvh_node *other = &bvh.node[child[!k]];
            if (other->item_count > 0)
                continue;
            assert_true(saved(&bvh, child[!k], child[k], other->fst) <= 0);
            assert_true(saved(&bvh, child[!k], child[k], other->snd) <= 0);
        }
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Leaves of several triangles, which stay together. */
static void leaves_stay_as_they_are(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3000);
    struct bvh bvh = trees_make(&scene, 3, TREES_BALANCED);
    double before = cost_of(&bvh);
    assert_int_equal(tree_rotate(&bvh, 3, 0), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
    assert_int_equal(bvh.node_count, 1999);
    assert_true(trees_leaves_are_whole(&bvh));
    assert_true(cost_of(&bvh) < 0.95 * before);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Subtrees climbed by different threads, and what is above them. */
static void changes_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = built_soup(30000, 9);
    for (int change = TREELETS; change <= ROTATIONS; change++) {
        struct bvh one = {0};
        for (uint32_t threads = 1; threads <= 5; threads += 2) {
            struct bvh bvh = built_by("lbvh", &scene, (struct build_options){.leaf = 1});
            assert_int_equal(change == TREELETS ? tree_treelets(&bvh, 4, 2, threads)
                                                : tree_rotate(&bvh, 2, threads),
                             STATUS_OK);
            assert_true(threads == 1 || built_same(&one, &bvh));
            if (threads == 1)
                one = bvh;
            else
                bvh_free(&bvh);
        }
        bvh_free(&one);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(up_to_seven_triangles_cost_the_least),
        cmocka_unit_test(a_child_and_a_grandchild_change_places),
        cmocka_unit_test(the_best_of_four_is_taken),
        cmocka_unit_test(no_round_raises_the_cost),
        cmocka_unit_test(rounds_lower_the_cost),
        cmocka_unit_test(treelets_count_leaves_as_they_will_be),
        cmocka_unit_test(trbvh_is_three_rounds),
        cmocka_unit_test(equal_costs_keep_what_was_there),
        cmocka_unit_test(equal_costs_are_kept_beside_others),
        cmocka_unit_test(where_rotations_end_no_node_gains),
        cmocka_unit_test(leaves_stay_as_they_are),
        cmocka_unit_test(changes_do_not_depend_on_the_number_of_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

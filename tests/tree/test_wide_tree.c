/* Laws of ref/tree/wide_tree.h. */
#include "ref/tree/wide_tree.h"
#include "scenes/scenes.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

/* --- every tree is one --------------------------------------------------------------------------
 */

/* Whether the tree is what ref/tree/wide_tree.h says: ranges, order, boxes, limits, stack. */
static bool is_well_formed(const struct wide_tree *tree, const struct bvh *bvh,
                           const struct scene *scene, const struct wide_rule *rule)
{
    uint32_t item = 0, next = 1, stack = 0;
    uint32_t *waiting = calloc(tree->node_count, sizeof *waiting);
    uint8_t *seen = calloc(bvh->prim_count, 1);
    bool good = waiting && seen;
    for (uint32_t n = 0; n < tree->node_count && good; n++) {
        const struct wide_node *node = &tree->node[n];
        good = node->count >= 1 && node->count <= rule->width &&
               (node->count > 1 || tree->node_count == 1);
        uint32_t deeper = waiting[n] + node->count - 1;
        stack = deeper > stack ? deeper : stack;
        uint32_t expected = 0;
        for (uint32_t i = 0; i < node->count && good; i++) {
            const struct wide_child *child = &tree->child[node->first + i];
            if (child->count == 0) {
                good = child->first > n && child->first < tree->node_count &&
                       (expected == 0 || child->first == expected);
                expected = child->first + 1;
                waiting[child->first] = deeper;
                next++;
                continue;
            }
            good = child->count <= rule->leaf_most;
            for (uint32_t k = 0; k < child->count && good; k++) {
                uint32_t at = child->first + k;
                struct box tri = scene_tri_bounds(scene, bvh->prim[at]);
                good =
                    at < bvh->prim_count && !seen[at]++ && box_contains_box(&child->bounds, &tri);
                item++;
            }
        }
    }
    free(waiting);
    free(seen);
    return good && item == bvh->prim_count && next == tree->node_count && stack == tree->stack_need;
}

static float five_for_at_most_three(void *self, const uint32_t *prim, uint32_t count)
{
    (void)self, (void)prim;
    return count <= 3 ? 5.0f : INFINITY;
}

static void wide_trees_hold_every_item_once(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=300", "sphere:n=8", "grid:n=6", "needles"};
    for (size_t s = 0; s < ARRAY_COUNT(scenes); s++) {
        struct scene scene;
        assert_int_equal(scene_open(scenes[s], 1, &scene, NULL), STATUS_OK);
        for (uint32_t leaf = 1; leaf <= 16; leaf *= 4) {
            struct build_options options = {.leaf = leaf};
            struct bvh bvh;
            assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
            for (uint32_t width = 2; width <= WIDE_TREE_MOST; width *= 2)
                for (uint32_t most = 1; most <= 9; most += 4) {
                    struct wide_rule rule = {.width = width, .leaf_most = most, .node_cost = 1};
                    struct wide_tree tree;
                    rule.leaf_cost = most == 5 ? five_for_at_most_three : NULL;
                    assert_int_equal(wide_tree_make(&bvh, &scene, &rule, &tree, NULL), STATUS_OK);
                    assert_true(is_well_formed(&tree, &bvh, &scene, &rule));
                    wide_tree_free(&tree);
                    assert_null(tree.node);
                }
            bvh_free(&bvh);
        }
        scene_free(&scene);
    }
}

static void small_trees_are_small(void **state)
{
    (void)state;
    struct wide_rule rule = {.width = 8, .leaf_most = 1, .node_cost = 1};
    for (uint32_t count = 0; count <= 8; count++) {
        struct scene scene = trees_grid(count);
        struct build_options options = {.leaf = 1};
        struct bvh bvh;
        struct wide_tree tree;
        assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
        assert_int_equal(wide_tree_make(&bvh, &scene, &rule, &tree, NULL), STATUS_OK);
        assert_int_equal(tree.node_count, count ? 1 : 0);
        assert_int_equal(tree.child_count, count);
        assert_int_equal(tree.stack_need, count ? count - 1 : 0);
        wide_tree_free(&tree);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* A thousand copies of one triangle, and a flat scene without area: no chain. */
static void trees_without_area_are_shallow(void **state)
{
    (void)state;
    const float point[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    struct scene scene = trees_copies(1000, point);
    struct build_options options = {.leaf = 4};
    struct wide_rule rule = {.width = 8, .leaf_most = 4, .node_cost = 1};
    struct bvh bvh;
    struct wide_tree tree;
    assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
    assert_int_equal(wide_tree_make(&bvh, &scene, &rule, &tree, NULL), STATUS_OK);
    assert_true(is_well_formed(&tree, &bvh, &scene, &rule));
    assert_true(tree.stack_need <= 28);
    wide_tree_free(&tree);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* As layouts decode them that round outward: costs overflow, leaves stay leaves of the rule. */
static void boxes_far_larger_than_the_root_make_no_large_leaves(void **state)
{
    (void)state;
    struct scene scene = trees_grid(20);
    struct build_options options = {.leaf = 10};
    struct wide_rule rule = {
        .width = 8, .leaf_most = 8, .node_cost = 1, .leaf_cost = five_for_at_most_three};
    struct bvh bvh;
    struct wide_tree tree;
    assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
    bvh.node[0].bounds = (struct box){{0, 0, 0}, {0x1p-126f, 0x1p-126f, 0x1p-126f}};
    assert_int_equal(wide_tree_make(&bvh, &scene, &rule, &tree, NULL), STATUS_OK);
    for (uint32_t i = 0; i < tree.child_count; i++)
        assert_true(tree.child[i].count <= 3);
    wide_tree_free(&tree);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* --- none is cheaper: every choice of nodes is tried
 * ---------------------------------------------- */

static double area(const struct box *box, const struct box *root)
{
    double side[2][3];
    const struct box *of[2] = {box, root};
    for (int b = 0; b < 2; b++)
        for (int k = 0; k < 3; k++)
            side[b][k] = (double)of[b]->hi[k] - (double)of[b]->lo[k];
    double half[2];
    for (int b = 0; b < 2; b++)
        half[b] = side[b][0] * side[b][1] + side[b][1] * side[b][2] + side[b][2] * side[b][0];
    return half[0] / half[1] + 0x1p-20;
}

/* Cost of the subtree where bit i of `kept` keeps inner node i as a node, `leaf` makes it a leaf;
 * *roots is how many roots it is; INFINITY if a rule is broken. */
static double chosen_cost(const struct bvh *bvh, const struct wide_rule *rule, uint32_t at,
                          uint32_t kept, uint32_t leaf, uint32_t *roots, uint32_t *items)
{
    const struct bvh_node *node = &bvh->node[at];
    double own = area(&node->bounds, &bvh->node[0].bounds);
    *roots = 1;
    *items = node->item_count;
    if (node->item_count)
        return own * node->item_count;
    uint32_t r[2], n[2];
    double cost = chosen_cost(bvh, rule, node->fst, kept, leaf, &r[0], &n[0]) +
                  chosen_cost(bvh, rule, node->snd, kept, leaf, &r[1], &n[1]);
    *items = n[0] + n[1];
    if (leaf >> at & 1)
        return *items <= rule->leaf_most ? own * *items : INFINITY;
    *roots = r[0] + r[1];
    if (!(kept >> at & 1))
        return cost;
    if (*roots > rule->width)
        return INFINITY;
    *roots = 1;
    return cost + own * (double)rule->node_cost;
}

static double least_cost(const struct bvh *bvh, const struct wide_rule *rule)
{
    double least = INFINITY;
    uint32_t inner = 0, roots, items;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        inner |= bvh->node[i].item_count ? 0 : 1u << i;
    for (uint32_t kept = inner;; kept = (kept - 1) & inner) {
        for (uint32_t leaf = inner & ~kept;; leaf = (leaf - 1) & inner & ~kept) {
            double cost = chosen_cost(bvh, rule, 0, kept, leaf, &roots, &items);
            if (roots == 1 && cost < least)
                least = cost;
            if (leaf == 0)
                break;
        }
        if (kept == 0)
            return least;
    }
}

static double tree_cost(const struct wide_tree *tree, const struct bvh *bvh,
                        const struct wide_rule *rule)
{
    const struct box *root = &bvh->node[0].bounds;
    double cost = tree->child[0].count && tree->child_count == 1
                      ? 0
                      : area(root, root) * (double)rule->node_cost;
    for (uint32_t i = 0; i < tree->child_count; i++) {
        const struct wide_child *child = &tree->child[i];
        double each = child->count ? (double)child->count : (double)rule->node_cost;
        cost += area(&child->bounds, root) * each;
    }
    return cost;
}

static void no_collapse_is_cheaper(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        struct scene scene;
        assert_int_equal(scene_open("soup:n=9", seed, &scene, NULL), STATUS_OK);
        struct build_options options = {.leaf = 1};
        struct bvh bvh;
        assert_int_equal(builders[0]->build(&scene, &options, &bvh, NULL), STATUS_OK);
        for (uint32_t width = 2; width <= 4; width++) {
            struct wide_rule rule = {.width = width,
                                     .leaf_most = (uint32_t)(seed % 4 + 1),
                                     .node_cost = 0.5f * (float)(seed % 5 + 1)};
            struct wide_tree tree;
            assert_int_equal(wide_tree_make(&bvh, &scene, &rule, &tree, NULL), STATUS_OK);
            double least = least_cost(&bvh, &rule), cost = tree_cost(&tree, &bvh, &rule);
            assert_true(fabs(cost - least) <= 1e-5 * least);
            wide_tree_free(&tree);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wide_trees_hold_every_item_once),
        cmocka_unit_test(small_trees_are_small),
        cmocka_unit_test(trees_without_area_are_shallow),
        cmocka_unit_test(boxes_far_larger_than_the_root_make_no_large_leaves),
        cmocka_unit_test(no_collapse_is_cheaper),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

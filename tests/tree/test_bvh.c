/* Laws of ref/tree/bvh.h. */
#include "ref/tree/bvh.h"
#include "tests/support/counted.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

static void bvh_accepts_a_well_formed_tree(void **state)
{
    (void)state;
    for (int shape = TREES_BALANCED; shape <= TREES_RIGHT; shape++) {
        struct scene scene = trees_grid(10);
        struct bvh bvh = trees_make(&scene, 2, (enum trees_shape)shape);
        assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
        bvh_free(&bvh);
        assert_null(bvh.node);
        scene_free(&scene);
    }
}

static void bvh_accepts_an_empty_tree_of_an_empty_scene_only(void **state)
{
    (void)state;
    struct scene none, one = trees_grid(1);
    struct bvh bvh = {0};
    struct reason reason;
    assert_int_equal(scene_make(0, 0, &none), STATUS_OK);
    assert_int_equal(bvh_check(&bvh, &none, NULL), STATUS_OK);
    assert_int_equal(bvh_counted(&bvh, &none).node_count, 0);
    assert_int_equal(bvh_check(&bvh, &one, &reason), STATUS_INPUT);
    uint32_t prim = 0;
    bvh = (struct bvh){.prim = &prim, .prim_count = 1, .tri_count = 1};
    assert_int_equal(bvh_check(&bvh, &one, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "no node"));
    scene_free(&none);
    scene_free(&one);
}

/* One way to spoil the balanced tree of 10 triangles, leaf 2: nodes 0 .. 8, leaf nodes 2, 3, 5, 7
 * and 8. `where` is the offset of the uint32_t that is replaced in node `node`, or in prim. */
struct bvh_spoilt {
    const char *what;
    uint32_t node;
    size_t where;
    uint32_t value;
    const char *reason;
};

#define IN_PRIM UINT32_MAX

static const struct bvh_spoilt spoilt[] = {
    {"child out of range", 0, offsetof(struct bvh_node, snd), 9,
     "tree node 0: second child is 9, must be node 4 of 9, the first after the first child's "
     "subtree"},
    {"child far out of range", 4, offsetof(struct bvh_node, fst), 0xFFFFFFFF,
     "tree node 4: first child is 4294967295, must be the next of 9 nodes"},
    {"cycle to the root", 6, offsetof(struct bvh_node, snd), 0,
     "tree node 6: second child is 0, must be node 8 of 9, the first after the first child's "
     "subtree"},
    {"own child", 1, offsetof(struct bvh_node, snd), 1,
     "tree node 1: second child is 1, must be node 3 of 9, the first after the first child's "
     "subtree"},
    {"shared child", 4, offsetof(struct bvh_node, snd), 5,
     "tree node 4: second child is 5, must be node 6 of 9, the first after the first child's "
     "subtree"},
    {"first child not next", 1, offsetof(struct bvh_node, fst), 3,
     "tree node 1: first child is 3, must be the next of 9 nodes"},
    {"skipped subtree", 0, offsetof(struct bvh_node, snd), 6,
     "tree node 0: second child is 6, must be node 4 of 9, the first after the first child's "
     "subtree"},
    {"leaf with a child", 2, offsetof(struct bvh_node, fst), 3,
     "tree node 2: a leaf with children 3 and 0"},
    {"leaf without items", 8, offsetof(struct bvh_node, item_count), 0,
     "tree node 8: first child is 0, must be the next of 9 nodes"},
    {"leaf with one item less", 8, offsetof(struct bvh_node, item_count), 1,
     "the tree's leaves hold 9 of its 10 items"},
    {"leaf with one item more", 8, offsetof(struct bvh_node, item_count), 3,
     "tree node 8: items 8 to 10, but the tree has 10 items"},
    {"leaf with 2^32 - 1 items", 8, offsetof(struct bvh_node, item_count), UINT32_MAX,
     "tree node 8: items 8 to 4294967302, but the tree has 10 items"},
    {"overlapping leaf", 3, offsetof(struct bvh_node, item_first), 1,
     "tree node 3: first item is 1, but 2 items come before it"},
    {"wrong item count before inner", 4, offsetof(struct bvh_node, item_first), 3,
     "tree node 4: first item is 3, but 4 items come before it"},
    {"triangle out of range", IN_PRIM, 7, 10, "tree item 7: triangle 10, but the scene has 10"},
    {"leaf with a second child", 7, offsetof(struct bvh_node, snd), 4,
     "tree node 7: a leaf with children 0 and 4"},
    {"triangle twice, another lost", IN_PRIM, 0, 9, "tree item 9: triangle 9 is there twice"},
    {"triangle twice", IN_PRIM, 7, 3, "tree item 7: triangle 3 is there twice"},
};

static void bvh_refuses_every_malformed_tree(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(spoilt); i++) {
        const struct bvh_spoilt *s = &spoilt[i];
        struct scene scene = trees_grid(10);
        struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
        struct reason reason = {""};
        if (s->node == IN_PRIM)
            bvh.prim[s->where] = s->value;
        else
            memcpy((char *)&bvh.node[s->node] + s->where, &s->value, sizeof s->value);
        enum status status = bvh_check_form(&bvh, &scene, &reason);
        if (status != STATUS_INPUT || strcmp(reason.text, s->reason) != 0)
            fail_msg("%s: status %d, reason '%s'", s->what, status, reason.text);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

static void bvh_refuses_a_tree_of_another_scene(void **state)
{
    (void)state;
    struct scene scene = trees_grid(10), other = trees_grid(11);
    struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
    struct reason reason = {""};
    assert_int_equal(bvh_check_form(&bvh, &other, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "the tree holds 10 triangles, the scene has 11");
    bvh.prim_count = 9;
    assert_int_equal(bvh_check_form(&bvh, &scene, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "the tree holds 9 items for 10 triangles");
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&other);
}

static void bvh_finds_each_loose_bound(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 9; n++)
        for (int k = 0; k < 6; k++) {
            struct scene scene = trees_grid(10);
            struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
            struct reason reason = {""};
            float *bound = k < 3 ? &bvh.node[n].bounds.lo[k] : &bvh.node[n].bounds.hi[k - 3];
            *bound += k < 3 ? 0x1p-20f : -0x1p-20f;
            bool inner = bvh.node[n].item_count == 0;
            assert_int_equal(bvh_check_form(&bvh, &scene, &reason), STATUS_OK);
            assert_int_equal(bvh_check(&bvh, &scene, &reason), STATUS_INPUT);
            const struct box *box = &bvh.node[n].bounds;
            float moved = k < 3 ? 0x1p-20f : -0x1p-20f;
            float lo = k < 3 ? *bound - moved : box->lo[k % 3];
            float hi = k < 3 ? box->hi[k % 3] : *bound - moved;
            char expected[200];
            snprintf(expected, sizeof expected,
                     "tree node %u: %c bounds [%a, %a] do not contain its triangles' [%a, %a]", n,
                     "xyz"[k % 3], (double)box -> lo[k % 3], (double)box -> hi[k % 3], (double)lo,
                     (double)hi);
            assert_string_equal(reason.text, expected);
            assert_int_equal(bvh_counted(&bvh, &scene).loose_count, inner ? 1 : 0);
            *bound = float_from_bits(0x7FC00000);
            assert_int_equal(bvh_check(&bvh, &scene, &reason), STATUS_INPUT);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

static void bvh_counts_nodes_leaves_and_depth(void **state)
{
    (void)state;
    static const uint32_t depth[] = {3, 5, 5};
    for (int shape = TREES_BALANCED; shape <= TREES_RIGHT; shape++) {
        struct scene scene = trees_grid(11);
        struct bvh bvh = trees_make(&scene, 2, (enum trees_shape)shape);
        struct bvh_stats stats = bvh_counted(&bvh, &scene);
        assert_int_equal(stats.node_count, 11);
        assert_int_equal(stats.leaf_count, 6);
        assert_int_equal(stats.depth, depth[shape]);
        assert_int_equal(stats.largest_leaf, 2);
        assert_int_equal(stats.loose_count, 0);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bvh_accepts_a_well_formed_tree),
        cmocka_unit_test(bvh_accepts_an_empty_tree_of_an_empty_scene_only),
        cmocka_unit_test(bvh_refuses_every_malformed_tree),
        cmocka_unit_test(bvh_refuses_a_tree_of_another_scene),
        cmocka_unit_test(bvh_finds_each_loose_bound),
        cmocka_unit_test(bvh_counts_nodes_leaves_and_depth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

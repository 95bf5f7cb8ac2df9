/* What an explanation knows of a tree, found again from the tree alone: exact bounds, parents,
 * leaves and records, of every builder and of binary and wide layouts. */
#include "ref/explain/tree.h"
#include "ref/store.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* Bounds of the triangles below a node; and how many leaves have more than so many items. */
static struct box below(const struct explain_tree *tree, uint32_t node,
                        uint32_t used[EXPLAIN_SLOTS])
{
    const struct bvh_node *at = &tree->bvh->node[node];
    struct box all = box_empty();
    for (uint32_t k = 0; k < at->item_count; k++) {
        struct box one = scene_tri_bounds(tree->scene, tree->bvh->prim[at->item_first + k]);
        box_add_box(&all, &one);
        used[k < EXPLAIN_SLOTS ? k : EXPLAIN_SLOTS - 1] += k < EXPLAIN_SLOTS;
    }
    if (at->item_count > 0)
        return all;
    struct box fst = below(tree, at->fst, used), snd = below(tree, at->snd, used);
    box_add_box(&fst, &snd);
    return fst;
}

static bool leaf_has(const struct bvh *bvh, uint32_t leaf, uint32_t prim)
{
    for (uint32_t k = 0; k < bvh->node[leaf].item_count; k++)
        if (bvh->prim[bvh->node[leaf].item_first + k] == prim)
            return true;
    return false;
}

/* The record of a binary layout leads to those of the children, or has the items. */
static void check_record(const struct explain_tree *tree, uint32_t i)
{
    const struct bvh_node *node = &tree->bvh->node[i];
    struct wide wide;
    assert_true(tree->record[i] != EXPLAIN_NONE);
    tree->packed->layout->load(tree->packed, tree->record[i], &wide);
    assert_int_equal(wide.child_count, node->item_count ? 0 : 2);
    if (wide.child_count) {
        assert_int_equal(wide.child[0], tree->record[node->fst]);
        assert_int_equal(wide.child[1], tree->record[node->snd]);
    }
    for (uint32_t s = 0; s < node->item_count; s++)
        assert_int_equal(packed_item(tree->packed, &wide, s),
                         tree->bvh->prim[node->item_first + s]);
}

static void check_node(const struct explain_tree *tree, uint32_t i, bool split)
{
    const struct bvh *bvh = tree->bvh;
    const struct bvh_node *node = &bvh->node[i];
    uint32_t used[EXPLAIN_SLOTS] = {0};
    struct box exact = split ? node->bounds : below(tree, i, used), named;
    assert_memory_equal(&tree->exact[i], &exact, sizeof exact);
    if (node->item_count == 0) {
        assert_int_equal(tree->parent[node->fst], i);
        assert_int_equal(tree->parent[node->snd], i);
    }
    if (!layout_is_wide(tree->packed->layout))
        check_record(tree, i);
    if (tree->record[i] == EXPLAIN_NONE)
        return;
    assert_int_equal(tree->node[tree->record[i]], i);
    assert_int_equal(explain_ref_fault(tree, i), REF_OK);
    uint32_t leaf = i; /* its first triangle is named there, and bounds are of all that are */
    while (bvh->node[leaf].item_count == 0)
        leaf = bvh->node[leaf].snd;
    assert_true(
        explain_names(tree, tree->record[i], bvh->prim[bvh->node[leaf].item_first], &named));
    if (!split)
        assert_memory_equal(&named, &exact, sizeof exact);
}

/* Returns how many nodes have a record. */
static uint32_t check_tree(const struct scene *scene, const struct bvh *bvh,
                           const struct packed *packed)
{
    struct explain_tree tree;
    struct reason reason = {""};
    uint32_t used[EXPLAIN_SLOTS] = {0}, records = 0;
    const bool split = bvh_is_split(bvh);
    if (explain_tree_make(scene, bvh, packed, &tree, &reason))
        fail_msg("%s: %s", packed->layout->name, reason.text);
    assert_int_equal(tree.parent[0], EXPLAIN_NONE);
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        check_node(&tree, i, split);
        records += tree.record[i] != EXPLAIN_NONE;
    }
    for (uint32_t prim = 0; prim < scene->tri_count; prim++)
        assert_true(leaf_has(bvh, tree.leaf[prim], prim));
    (void)below(&tree, 0, used);
    for (uint32_t s = 0; s < EXPLAIN_SLOTS && !layout_is_wide(packed->layout); s++) {
        assert_int_equal(tree.slot_used[s], used[s]);
        assert_int_equal(tree.slot_lost[s], 0);
    }
    assert_false(tree.shifted || tree.zero_twice);
    explain_tree_free(&tree);
    return records;
}

static void a_tree_is_known_as_it_is(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=90", "needles:n=60", "sphere:n=5", "soup:n=1"};
    static const char *const names[] = {"f32", "rf16", "half4", "cwbvh80", "obb8"};
    size_t splits = 0;
    for (size_t n = 0; n < ARRAY_COUNT(specs); n++) {
        struct scene scene;
        assert_int_equal(scene_open(specs[n], 2, &scene, NULL), STATUS_OK);
        for (size_t b = 0; builders_all[b]; b++) {
            const struct build_options options = {
                .leaf = 1 + (uint32_t)b % 3, .eps = BUILD_EPS_DEFAULT, .split_alpha = -1};
            struct bvh bvh;
            if (builders_all[b]->build(&scene, &options, &bvh, NULL))
                continue;
            const bool split = bvh_is_split(&bvh);
            splits += split;
            for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
                struct packed packed;
                if (packed_make(layout_find(names[l]), &bvh, &scene, &packed, NULL))
                    continue;
                const uint32_t records = check_tree(&scene, &bvh, &packed);
                assert_true(records > 0);
                packed_free(&packed);
            }
            bvh_free(&bvh);
        }
        scene_free(&scene);
    }
    assert_true(splits > 0);
}

/* However few the triangles, the record of the root is the root, also where all that a wide one has
 * is one leaf. */
static void the_root_is_known_of_the_smallest_trees(void **state)
{
    (void)state;
    size_t made = 0;
    for (uint32_t count = 1; count < 10; count++)
        for (uint32_t leaf = 1; leaf <= 4; leaf *= 4) {
            const struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
            struct scene scene;
            struct bvh bvh;
            char spec[32];
            snprintf(spec, sizeof spec, "soup:n=%u", count);
            assert_int_equal(scene_open(spec, 1, &scene, NULL), STATUS_OK);
            assert_int_equal(bvh_build(builder_find("median"), &scene, &options, &bvh, NULL), 0);
            for (size_t l = 0; layouts_all[l]; l++) {
                struct packed packed;
                struct explain_tree tree;
                if (layouts_all[l]->width == 2 ||
                    packed_make(layouts_all[l], &bvh, &scene, &packed, NULL))
                    continue;
                assert_int_equal(explain_tree_make(&scene, &bvh, &packed, &tree, NULL), 0);
                assert_int_equal(tree.record[0], packed.root);
                explain_tree_free(&tree);
                packed_free(&packed);
                made++;
            }
            bvh_free(&bvh);
            scene_free(&scene);
        }
    assert_true(made > 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_tree_is_known_as_it_is),
                                       cmocka_unit_test(the_root_is_known_of_the_smallest_trees)};
    return cmocka_run_group_tests_name("explain: trees", tests, NULL, NULL);
}

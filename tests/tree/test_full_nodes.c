/* Every layout with nodes of all numbers of children, leaves of all numbers of items in each slot,
 * and nodes in each slot: what was packed is found again, by the walk, by packed_check and by rays,
 * item for item. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/packed/packed_file.h"
#include "ref/packed/packed_unpack.h"
#include "ref/packed/packed_walk.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/groups.h"

/* --- what was met ----------------------------------------------------------------------------- */

struct nodes_met {
    uint32_t leaf[WIDE_MAX + 1][WIDE_MAX][ITEMS_MOST + 1]; /* children, slot, items */
    uint32_t inner[WIDE_MAX + 1][WIDE_MAX];                /* children, slot */
};

/* Each leaf has items of a group, in their order. */
static void expect_leaf(const struct packed *packed, const struct groups *g,
                        const struct wide *leaf)
{
    uint32_t first = packed_item(packed, leaf, 0), end = 0, group = 0;
    while (group < g->count && end <= first)
        end += g->items[group++];
    if (first >= end || leaf->item_count == 0 || first + leaf->item_count > end)
        fail_msg("%s: a leaf of %u items from triangle %u on is not of one group",
                 packed->layout->name, leaf->item_count, first);
    for (uint32_t i = 0; i < leaf->item_count; i++)
        assert_int_equal(packed_item(packed, leaf, i), first + i);
}

static void expect_nodes(const struct packed *packed, const struct groups *g, struct nodes_met *met)
{
    struct packed_walk walk;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    assert_int_equal(walk.bad_refs + walk.repeats, 0);
    assert_int_equal(walk.stack_most, packed->stack_need);
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        if (node.child_count == 0)
            expect_leaf(packed, g, &node);
        for (uint32_t s = 0; s < node.child_count; s++) {
            struct wide child;
            packed->layout->load(packed, node.child[s], &child);
            if (child.child_count > 0)
                met->inner[node.child_count][s]++;
            else
                met->leaf[node.child_count][s][child.item_count]++;
        }
    }
    packed_walk_free(&walk);
}

static void expect_hits(const struct packed *packed, const struct groups *g)
{
    for (uint32_t i = 0; i < g->total; i++) {
        struct ray ray = groups_ray(g, i);
        struct job job = {.scene = &g->scene,
                          .packed = packed,
                          .box = box_tests[0],
                          .tri = tri_tests[0],
                          .query = QUERY_CLOSEST};
        struct hit hit;
        assert_int_equal(trace_ray(&job, &ray, &hit, NULL), STATUS_OK);
        if (hit.prim != i)
            fail_msg("%s: a ray at triangle %u finds %d", packed->layout->name, i, (int)hit.prim);
    }
}

/* Written to a file and read, it has the same words. */
static void expect_file(const struct packed *packed, const struct groups *g)
{
    char *bytes = NULL;
    size_t size = 0;
    struct packed again;
    struct packed_faults faults, none = {0};
    struct reason reason = {""};
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    packed_file_write(packed, stream);
    assert_int_equal(fclose(stream), 0);
    if (packed_file_read("file", bytes, size, &g->scene, &again, &faults, &reason))
        fail_msg("%s: %s", packed->layout->name, reason.text);
    assert_memory_equal(&faults, &none, sizeof none);
    assert_ptr_equal(again.layout, packed->layout);
    assert_int_equal(again.root, packed->root);
    assert_int_equal(again.word_count, packed->word_count);
    assert_memory_equal(again.word, packed->word, 4 * (size_t)packed->word_count);
    assert_int_equal(again.item_count, packed->item_count);
    if (packed->item_count)
        assert_memory_equal(again.item, packed->item, 4 * (size_t)packed->item_count);
    packed_free(&again);
    free(bytes);
}

/* Of a binary layout it is the tree again, with all leaves, and packs to the same words. */
static void expect_unpacked(const struct packed *packed, const struct groups *g)
{
    struct bvh bvh;
    struct packed again;
    struct reason reason = {""};
    if (layout_is_wide(packed->layout))
        return;
    if (packed_unpack(packed, &g->scene, &bvh, &reason) ||
        packed_make(packed->layout, &bvh, &g->scene, &again, &reason))
        fail_msg("%s: %s", packed->layout->name, reason.text);
    assert_int_equal(bvh.node_count, g->bvh.node_count);
    assert_int_equal(bvh.prim_count, g->bvh.prim_count);
    assert_memory_equal(bvh.prim, g->bvh.prim, bvh.prim_count * sizeof *bvh.prim);
    for (uint32_t i = 0; i < bvh.node_count; i++) {
        const struct bvh_node *got = &bvh.node[i], *want = &g->bvh.node[i];
        assert_int_equal(got->item_count, want->item_count);
        assert_int_equal(got->item_first, want->item_first);
        assert_true(box_contains_box(&got->bounds, &want->bounds));
        assert_true(want->item_count > 0 || (got->fst == want->fst && got->snd == want->snd));
    }
    assert_int_equal(again.word_count, packed->word_count);
    assert_memory_equal(again.word, packed->word, 4 * (size_t)packed->word_count);
    packed_free(&again);
    bvh_free(&bvh);
}

static void expect_tree(const struct layout *layout, struct groups *g, struct nodes_met *met)
{
    struct packed packed;
    struct reason reason = {""};
    groups_fill(g);
    groups_grow(g);
    if (packed_make(layout, &g->bvh, &g->scene, &packed, &reason) ||
        packed_check(&packed, &g->scene, NULL, &reason))
        fail_msg("%s: %s", layout->name, reason.text);
    expect_nodes(&packed, g, met);
    expect_hits(&packed, g);
    expect_file(&packed, g);
    expect_unpacked(&packed, g);
    /* Bounds written anew in every slot: higher, and where they were. */
    for (uint32_t turn = 0; turn < 2 && layout->rebound; turn++) {
        groups_lift(g, turn ? -0.25f : 0.25f);
        enum status status = packed_refit(&packed, &g->scene, &reason);
        if (status == STATUS_LIMIT)
            break; /* beyond the frame of the scene */
        if (status || packed_check(&packed, &g->scene, NULL, &reason))
            fail_msg("%s, refitted: %s", layout->name, reason.text);
        expect_nodes(&packed, g, met);
        expect_hits(&packed, g);
    }
    packed_free(&packed);
    groups_free(g);
}

/* --- the trees -------------------------------------------------------------------------------- */

/* A node of 2 to all children, a leaf of 1 to all items in each slot. */
static void leaves_of_all_sizes(const struct layout *layout, struct nodes_met *met)
{
    uint32_t most = groups_leaf_most(layout);
    for (uint32_t children = 2; children <= layout->width; children++)
        for (uint32_t s = 0; s < children; s++)
            for (uint32_t items = 1; items <= most; items++) {
                struct groups g = {0};
                groups_of_sizes(&g, children, s, items, most);
                expect_tree(layout, &g, met);
            }
}

static void nodes_in_all_slots(const struct layout *layout, struct nodes_met *met)
{
    for (uint32_t s = 0; s < layout->width; s++)
        for (uint32_t turn = 0; turn < 2; turn++) {
            struct groups g = {0};
            groups_in_slots(&g, layout, s, turn == 0);
            expect_tree(layout, &g, met);
        }
}

static void expect_all_met(const struct layout *layout, const struct nodes_met *met)
{
    for (uint32_t children = 2; children <= layout->width; children++)
        for (uint32_t s = 0; s < children; s++)
            for (uint32_t items = 1; items <= groups_leaf_most(layout); items++)
                if (met->leaf[children][s][items] == 0)
                    fail_msg("%s: no leaf of %u items in slot %u of %u", layout->name, items, s,
                             children);
    for (uint32_t s = 0; s < layout->width; s++)
        if (met->inner[layout->width][s] == 0)
            fail_msg("%s: no node in slot %u of %u", layout->name, s, layout->width);
}

static void every_layout_has_all_children_and_items_in_every_slot(void **state)
{
    (void)state;
    size_t played = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        struct nodes_met met = {0};
        if (layout->faithful)
            continue;
        leaves_of_all_sizes(layout, &met);
        nodes_in_all_slots(layout, &met);
        expect_all_met(layout, &met);
        played++;
    }
    assert_true(played >= 52);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_has_all_children_and_items_in_every_slot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

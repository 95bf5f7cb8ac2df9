/* Layouts from outside of four children: what an honest one packs is the tree, wherever the
 * children stand in a record; every lie is told by the record, a leaf's by the slot. */
#include "ref/packed/packed_walk.h"

static unsigned lie; /* enum lie */
#define LIE lie
#include "tests/peers/plugin_liar_wide.c"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/outside/plugin_stand.h"

static int stand_make(void **state)
{
    return stand_open(state, "liar4");
}

static void wide_plugin_that_lies_is_refused_by_the_record(void **state)
{
    static const struct lie_case cases[] = {
        {LIE_HONEST, NULL, PACKED_SOUND},
        {LIE_HOLE, NULL, PACKED_SOUND},
        {LIE_ULP, "liar4: record 4: x bounds", PACKED_BOUND},
        {LIE_LEAF_ULP, "liar4: record 84, slot 1: x bounds", PACKED_BOUND},
        {LIE_CHILD, "liar4: record 0: child 0 is reference 425 of 425", PACKED_REFERENCE},
        {LIE_SLOT, "liar4: record 0: child 0 is record 1, slot 1", PACKED_REFERENCE},
        {LIE_RECORD, "liar4: record 84: a leaf, not a child slot", PACKED_RECORD},
        {LIE_INNER, "liar4: record 84, slot 0: a child slot has children", PACKED_RECORD},
        {LIE_EMPTY, "liar4: record 84: a leaf without items", PACKED_RECORD},
        {LIE_CHILDREN, "liar4: record 0: 5 children, 4 at most", PACKED_RECORD},
    };
    stand_hears(*state, &lie, LIE_HONEST, cases, ARRAY_COUNT(cases));
}

/* A tree of one leaf has a root all the same. */
static void wide_plugin_packs_a_single_leaf(void **state)
{
    struct stand *s = *state;
    const struct build_options options = {.leaf = 512, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct packed packed;
    struct reason reason = {""};
    struct wide node;
    assert_int_equal(bvh_build(builder_find("median"), &s->scene, &options, &bvh, &reason), 0);
    assert_int_equal(bvh.node_count, 1);
    assert_int_equal(packed_make(s->layout, &bvh, &s->scene, &packed, &reason), STATUS_OK);
    s->layout->load(&packed, packed.root, &node);
    assert_int_equal(packed.node_count, 1);
    assert_int_equal(node.child_count, 1);
    assert_int_equal(node.child[0], 1);
    assert_string_equal(packed_name(&packed, 1).text, "record 0, slot 0");
    packed_free(&packed);
    bvh_free(&bvh);
}

/* The box of a child slot is the one that its record has there, that of a record holds them all:
 * also that of the first slot of the first record, which is the root's only child here. */
static void boxes_are_those_of_the_slots(void **state)
{
    struct stand *s = *state;
    static const uint32_t leaves[] = {512, 64, 4};
    for (size_t l = 0; l < ARRAY_COUNT(leaves); l++) {
        const struct build_options options = {.leaf = leaves[l], .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh;
        struct packed packed;
        uint32_t slots = 0;
        assert_int_equal(bvh_build(builder_find("median"), &s->scene, &options, &bvh, NULL), 0);
        assert_int_equal(packed_make(s->layout, &bvh, &s->scene, &packed, NULL), STATUS_OK);
        for (uint32_t ref = 0; ref < packed.node_count; ref++) {
            struct wide node;
            const struct box own = s->layout->box(&packed, ref);
            s->layout->load(&packed, ref, &node);
            for (uint32_t c = 0; c < node.child_count; c++) {
                assert_true(box_contains_box(&own, &node.box[c]));
                if (node.child[c] < packed.node_count)
                    continue;
                const struct box slot = s->layout->box(&packed, node.child[c]);
                assert_memory_equal(&slot, &node.box[c], sizeof slot);
                slots++;
            }
        }
        assert_true(slots > 0);
        packed_free(&packed);
        bvh_free(&bvh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wide_plugin_that_lies_is_refused_by_the_record),
        cmocka_unit_test(wide_plugin_packs_a_single_leaf),
        cmocka_unit_test(boxes_are_those_of_the_slots),
    };
    return cmocka_run_group_tests(tests, stand_make, stand_free);
}

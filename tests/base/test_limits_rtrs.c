/* How the faithful layouts wrap, garble or refuse at the borders that test_limits.c holds. */
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/held.h"

/* F7: items 7 and 8 are packed but not read. F6: a leaf's slots 7 and 8 are taken for child
 * indices. In a tree of 3 leaves of 7 (5 nodes) the items of slot 7 are 6, 13 and 20. */
static void rtrs_rf_panics_or_garbles_from_seven_items(void **state)
{
    (void)state;
    must_hold(hold("rtrs_rf", trees_grid(6), 6, TREES_BALANCED), false);
    must_refuse(hold("rtrs_rf", trees_grid(7), 7, TREES_BALANCED),
                "rtrs_rf: RTRS panics (fault F6, docs/rtrs-faults.md): record 1 holds item 6, "
                "taken for one of 1 nodes");
    must_refuse(hold("rtrs_rf", trees_grid(21), 7, TREES_BALANCED), "item 6, taken for one of 5");
    must_refuse(hold("rtrs_rf", trees_grid(8), 8, TREES_BALANCED), "RTRS panics (fault F6,");
    must_refuse(
        hold("rtrs_rf", trees_grid(9), 9, TREES_BALANCED),
        "rtrs_rf: RTRS panics (fault F8, docs/rtrs-faults.md): 9 items in a leaf of 8 slots");
    must_refuse(hold("rtrs_rf", trees_grid(13), 13, TREES_BALANCED),
                "RTRS panics (fault F8, docs/rtrs-faults.md): 13 items in a leaf of 8 slots");

    struct scene scene = trees_grid(80);
    struct held h = {.scene = scene, .bvh = trees_make(&scene, 8, TREES_RIGHT)};
    for (uint32_t i = 0; i < 80; i++) /* 10 leaves, 19 nodes: slots 7 and 8 get 0 .. 19 */
        h.bvh.prim[i] = i % 8 >= 6 ? i / 8 * 2 + i % 8 - 6 : 20 + i - i / 8 * 2;
    h.status = packed_make(layout_find("rtrs_rf"), &h.bvh, &h.scene, &h.packed, &h.reason);
    if (h.status)
        fail_msg("%s", h.reason.text);
    /* Leaf j is node 2 j + 1, record 3 j + 1. Items 2 j and 2 j + 1 become what nodes of that
     * index would: 2 j has the leaves 1, 3, .., 2 j - 1 before it, 2 j + 1 as many. */
    for (uint32_t j = 0; j < 9; j++)
        assert_int_equal(h.packed.word[4 * (3 * j + 2) + 3], (3 * j) | (3 * j + 1) << 16);
    assert_int_equal(slot(&h.packed, 1, 6), ABI_NO_PRIM); /* six slots are read */
    assert_int_equal(slot(&h.packed, 1, 5), 24);
    release(&h);
}

/* Item 7 from 32768 on has the leaf's bit 31 set in its record: left alone. */
static void rtrs_rf_leaves_an_eighth_item_from_32768_alone(void **state)
{
    (void)state;
    struct scene scene = trees_grid(32776);
    struct held h = {.scene = scene, .bvh = trees_make(&scene, 8, TREES_BALANCED)};
    /* All leaves but the last are cut to 6 items: only their words matter here. */
    for (uint32_t i = 0; i + 1 < h.bvh.node_count; i++)
        if (h.bvh.node[i].item_count > 0)
            h.bvh.node[i].item_count = 6;
    h.status = layout_find("rtrs_rf")->pack(layout_find("rtrs_rf"), &h.bvh, &h.scene, &h.packed,
                                            &h.reason);
    assert_int_equal(h.status, STATUS_OK);
    uint32_t last = h.packed.node_count - 1;
    assert_int_equal(h.packed.word[4 * last + 3], 32774u | 32775u << 16);
    release(&h);
}

/* F9. A left chain has its inner nodes first: node i is record i, its fst record i + 1. */
static void rtrs_rf_turns_nodes_into_leaves_from_record_32768(void **state)
{
    (void)state;
    struct held h = hold_words("rtrs_rf", trees_grid(32800), 1, TREES_LEFT);
    struct wide node;
    assert_int_equal(h.status, STATUS_OK);
    for (uint32_t i = 32764; i <= 32766; i++) {
        h.packed.layout->load(&h.packed, i, &node);
        assert_int_equal(node.item_count, 0);
        assert_int_equal(node.child[0], i + 1);
    }
    for (uint32_t i = 32767; i <= 32770; i++) {
        h.packed.layout->load(&h.packed, i, &node);
        assert_int_equal(node.child_count, 0);
        assert_int_equal(node.item_count, 6);
        assert_int_equal(h.packed.word[4 * i + 3] >> 31, 1);
    }
    release(&h);

    /* In a right chain inner node i is node 2 i, record 3 i: fst 32764 + 3 = 32767 by the fix-up,
     * 32770 would set bit 31 there although its node index is 21847. */
    h = hold_words("rtrs_rf", trees_grid(21900), 1, TREES_RIGHT);
    h.packed.layout->load(&h.packed, 32766, &node);
    assert_int_equal(node.child[0], 32767);
    assert_int_equal(node.child[1], 32769);
    assert_int_equal(h.packed.word[4 * 32769 + 3], 32770u << 16 | 32772u);
    h.packed.layout->load(&h.packed, 32769, &node);
    assert_int_equal(node.child_count, 0);
    release(&h);
}

/* F9 for snd: all 16 bits are kept, then they wrap. The root of a left chain of L leaves has the
 * last leaf for snd, record 3 L - 3. */
static void rtrs_rf_wraps_snd_from_record_65536(void **state)
{
    (void)state;
    struct held h = hold_words("rtrs_rf", trees_grid(21846), 1, TREES_LEFT);
    assert_int_equal(h.packed.word[3], 1u << 16 | 65535u);
    release(&h);
    h = hold_words("rtrs_rf", trees_grid(21847), 1, TREES_LEFT);
    assert_int_equal(h.packed.word[3], 1u << 16 | 2u);
    release(&h);
}

/* F10, with F2: stored items are cut to 16 bits, 0 is skipped and k names triangle k - 1. */
static void rtrs_rf_cuts_triangles_to_sixteen_bits(void **state)
{
    (void)state;
    struct held h = hold("rtrs_rf", trees_grid(65538), 6, TREES_BALANCED);
    assert_int_equal(h.status, STATUS_OK);
    uint32_t last = h.packed.node_count - 2; /* items 65532 .. 65537 */
    assert_int_equal(slot(&h.packed, last, 2), 65533);
    assert_int_equal(slot(&h.packed, last, 3), 65534);       /* 65535 */
    assert_int_equal(slot(&h.packed, last, 4), ABI_NO_PRIM); /* 65536 */
    assert_int_equal(slot(&h.packed, last, 5), 0);           /* 65537 */
    struct packed_faults faults;
    assert_int_equal(packed_check(&h.packed, &h.scene, &faults, NULL), STATUS_INPUT);
    /* 0 is tested twice, by items 1 and 65537; 65535 and 65536 never, nor the last, 65537. */
    assert_int_equal(faults.double_prims, 1);
    assert_int_equal(faults.lost_prims, 3);
    release(&h);
}

static void rtrs_rf_rounds_bounds_to_nearest_and_overflows(void **state)
{
    (void)state;
    static const struct {
        float x;
        uint32_t half;
    } border[] = {{65504, 0x7BFF}, {65505, 0x7BFF}, {65519.99f, 0x7BFF},
                  {65520, 0x7C00}, {0.1f, 0x2E66},  {1e-6f, 0x0011}};
    static const char *const faithful[] = {"rtrs_rf", "rtrs_rf_paper"};
    for (size_t l = 0; l < ARRAY_COUNT(faithful); l++)
        for (size_t i = 0; i < ARRAY_COUNT(border); i++) {
            struct held h = hold(faithful[l], reaching(border[i].x, 2), 1, TREES_BALANCED);
            assert_int_equal(h.status, STATUS_OK);
            assert_int_equal(h.packed.word[2], border[i].half << 16);
            release(&h);
        }
}

static void rtrs_rf_paper_reads_eight_slots_and_refuses_nine(void **state)
{
    (void)state;
    must_refuse(hold("rtrs_rf_paper", trees_grid(9), 9, TREES_BALANCED),
                "rtrs_rf_paper: the paper's record has 8 slots, this tree has a leaf of 9");
    must_refuse(hold("rtrs_rf_paper", trees_grid(35), 9, TREES_BALANCED), /* not the root */
                "rtrs_rf_paper: the paper's record has 8 slots, this tree has a leaf of 9");
    for (uint32_t n = 7; n <= 8; n++) {
        struct held h = hold("rtrs_rf_paper", trees_grid(n), 8, TREES_BALANCED);
        assert_int_equal(slot(&h.packed, 0, 0), ABI_NO_PRIM); /* triangle 0 */
        for (uint32_t s = 1; s < n; s++)
            assert_int_equal(slot(&h.packed, 0, s), s);
        assert_int_equal(slot(&h.packed, 0, n), ABI_NO_PRIM);
        release(&h);
    }
}

static void rtrs_rf_paper_cuts_children_to_fifteen_bits(void **state)
{
    (void)state;
    struct held h = hold_words("rtrs_rf_paper", trees_grid(32800), 1, TREES_LEFT);
    static const uint32_t read[][2] = {{32765, 32766}, {32766, 32767}, {32767, 0}, {32768, 1}};
    for (size_t i = 0; i < ARRAY_COUNT(read); i++) {
        struct wide node;
        h.packed.layout->load(&h.packed, read[i][0], &node);
        assert_int_equal(node.child_count, 2);
        assert_int_equal(node.child[0], read[i][1]);
    }
    release(&h);
}

/* The two items in the tag have 15 bits, the other six 16; every slot gets every number. What reads
 * as 0 is an empty slot. */
static void rtrs_rf_paper_cuts_triangles_by_slot(void **state)
{
    (void)state;
    static const uint32_t stored[8] = {1, 32767, 32768, 32769, 65534, 65535, 65536, 65537};
    static const uint32_t read[2][8] = {
        {1, 32767, ABI_NO_PRIM, 1, 32766, 32767, ABI_NO_PRIM, 1},
        {1, 32767, 32768, 32769, 65534, 65535, ABI_NO_PRIM, 1},
    };
    struct scene scene = trees_grid(65540);
    for (uint32_t turn = 0; turn < 8; turn++) {
        struct held h = {.scene = scene, .bvh = trees_make(&scene, 8, TREES_BALANCED)};
        for (uint32_t s = 0; s < 8; s++)
            h.bvh.prim[s] = stored[(s + turn) % 8];
        h.status =
            packed_make(layout_find("rtrs_rf_paper"), &h.bvh, &h.scene, &h.packed, &h.reason);
        assert_int_equal(h.status, STATUS_OK);
        uint32_t first = 0; /* the first leaf's record: the first with the leaf bit */
        while (h.packed.word[4 * first + 3] != 0x80000000u)
            first++;
        for (uint32_t s = 0; s < 8; s++)
            assert_int_equal(slot(&h.packed, first, s), read[s >= 2][(s + turn) % 8]);
        packed_free(&h.packed);
        bvh_free(&h.bvh);
    }
    scene_free(&scene);
}

static void rtrs_direct_holds_everything(void **state)
{
    (void)state;
    must_hold(hold("rtrs_direct", trees_grid(65538), 13, TREES_BALANCED), false);
    must_hold(hold("rtrs_direct", trees_grid(40000), 1, TREES_BALANCED), false);
    must_hold(hold("rtrs_direct", reaching(3e38f, 0), 1, TREES_BALANCED), false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rtrs_rf_panics_or_garbles_from_seven_items),
        cmocka_unit_test(rtrs_rf_leaves_an_eighth_item_from_32768_alone),
        cmocka_unit_test(rtrs_rf_turns_nodes_into_leaves_from_record_32768),
        cmocka_unit_test(rtrs_rf_wraps_snd_from_record_65536),
        cmocka_unit_test(rtrs_rf_cuts_triangles_to_sixteen_bits),
        cmocka_unit_test(rtrs_rf_rounds_bounds_to_nearest_and_overflows),
        cmocka_unit_test(rtrs_rf_paper_reads_eight_slots_and_refuses_nine),
        cmocka_unit_test(rtrs_rf_paper_cuts_children_to_fifteen_bits),
        cmocka_unit_test(rtrs_rf_paper_cuts_triangles_by_slot),
        cmocka_unit_test(rtrs_direct_holds_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

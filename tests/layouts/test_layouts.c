/* Laws of ref/layouts/: the words of one small tree in every layout, and what each node reads as.
 */
#include "ref/base/half.h"
#include "ref/layout.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/any_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Five triangles in three leaves, prim reordered. Nodes: 0 inner (1, 2), 1 leaf {4, 0},
 * 2 inner (3, 4), 3 leaf {3}, 4 leaf {1, 2}. */
static void golden_tree(struct scene *scene, struct bvh *bvh)
{
    static const float x[5] = {0.1f, -2, -1, 1000, 1e-6f}; /* of each triangle's first vertex */
    static const uint32_t prim[5] = {4, 0, 3, 1, 2};
    *scene = trees_grid(5);
    for (int i = 0; i < 5; i++)
        for (int c = 0; c < 3; c++) {
            scene->vertex[9 * i + 3 * c] = x[i] + (c == 1 ? 0.25f : 0);
            scene->vertex[9 * i + 3 * c + 1] = c == 2 ? 0.5f : 0;
            scene->vertex[9 * i + 3 * c + 2] = -3.0009765625f;
        }
    *bvh = trees_make(scene, 2, TREES_RIGHT);
    memcpy(bvh->prim, prim, sizeof prim);
    bvh->node[3].item_count = 1;
    bvh->node[4].item_count = 2;
    bvh->node[4].item_first = 3;
    trees_fit(bvh, scene);
    assert_int_equal(bvh_check(bvh, scene, NULL), STATUS_OK);
}

/* The bits of -3.0009765625, the z of all vertices. */
#define Z 0xC0401000u

struct golden {
    const char *layout;
    uint32_t word_count;
    const uint32_t *word;
    uint32_t item_count;
    const uint32_t *item;
};

static const uint32_t golden_f32[] = {
    /* lo, first, hi, count */
    0xC0000000, 0x00000000, Z, 2, 0x447A1000, 0x3F000000, Z, 0, /* 0: x -2 .. 1000.25 */
    0x358637BD, 0x00000000, Z, 0, 0x3EB33333, 0x3F000000, Z, 2, /* 1: x 1e-6 .. 0.35 */
    0xC0000000, 0x00000000, Z, 4, 0x447A1000, 0x3F000000, Z, 0, /* 2 */
    0x447A0000, 0x00000000, Z, 2, 0x447A1000, 0x3F000000, Z, 1, /* 3: x 1000 .. 1000.25 */
    0xC0000000, 0x00000000, Z, 3, 0xBF400000, 0x3F000000, Z, 2, /* 4: x -2 .. -0.75 */
};
static const uint32_t golden_items[] = {4, 0, 3, 1, 2};

/* Halves: -2 C000, 1000 63D0, 1000.25 between 63D0 (1000) and 63D1 (1000.5), 0.35 between 3599 and
 * 359A, 1e-6 subnormal, 0.5 3800, -0.75 BA00, -3.0009765625 halfway between C200 and C201. */
static const uint32_t golden_rf16[] = {
    0x63D1C000, 0x38000000, 0xC200C201, 0x00010003, /* 0 inner: fst record 1, snd record 3 */
    0x359A0000, 0x38000000, 0xC200C201, 0x80000002, /* 1 leaf of 2 */
    0x00000004, 0x00000000, 0x00000000, 0x00000000, /*   items 4, 0 */
    0x63D1C000, 0x38000000, 0xC200C201, 0x00040006, /* 3 inner */
    0x63D163D0, 0x38000000, 0xC200C201, 0x80000001, /* 4 leaf of 1 */
    0x00000003, 0x00000000, 0x00000000, 0x00000000, /*   item 3 */
    0xBA00C000, 0x38000000, 0xC200C201, 0x80000002, /* 6 leaf of 2 */
    0x00020001, 0x00000000, 0x00000000, 0x00000000, /*   items 1, 2 */
};

static const uint32_t golden_rtrs_direct[] = {
    /* fst, snd, item_first, item_count, lo, pad, hi, pad */
    1, 2, 0, 0, 0xC0000000, 0x00000000, Z, 0, 0x447A1000, 0x3F000000, Z, 0, /* 0 */
    0, 0, 0, 2, 0x358637BD, 0x00000000, Z, 0, 0x3EB33333, 0x3F000000, Z, 0, /* 1 */
    3, 4, 2, 0, 0xC0000000, 0x00000000, Z, 0, 0x447A1000, 0x3F000000, Z, 0, /* 2 */
    0, 0, 2, 1, 0x447A0000, 0x00000000, Z, 0, 0x447A1000, 0x3F000000, Z, 0, /* 3 */
    0, 0, 3, 2, 0xC0000000, 0x00000000, Z, 0, 0xBF400000, 0x3F000000, Z, 0, /* 4 */
};

/* Nearest: 1e-6 is 17 * 2^-24 (0011), 1000.25 a tie to 63D0, 0.35 359A, z a tie to C200. */
static const uint32_t golden_rtrs_rf[] = {
    0x63D0C000, 0x38000000, 0xC200C200, 0x00010003, /* 0 */
    0x359A0011, 0x38000000, 0xC200C200, 0x80000000, /* 1 */
    0x00000004, 0x00000000, 0x00000000, 0x00000000,
    0x63D0C000, 0x38000000, 0xC200C200, 0x00040006, /* 3 */
    0x63D063D0, 0x38000000, 0xC200C200, 0x80000000, /* 4 */
    0x00000003, 0x00000000, 0x00000000, 0x00000000,
    0xBA00C000, 0x38000000, 0xC200C200, 0x80000000, /* 6 */
    0x00020001, 0x00000000, 0x00000000, 0x00000000,
};

/* As rtrs_rf, but fst in the low half and the first two items in the tag. */
static const uint32_t golden_rtrs_rf_paper[] = {
    0x63D0C000, 0x38000000, 0xC200C200, 0x00030001, /* 0 */
    0x359A0011, 0x38000000, 0xC200C200, 0x80000000, /* 1 */
    0x00000000, 0x00000000, 0x00000000, 0x00000004,
    0x63D0C000, 0x38000000, 0xC200C200, 0x00060004, /* 3 */
    0x63D063D0, 0x38000000, 0xC200C200, 0x80000000, /* 4 */
    0x00000000, 0x00000000, 0x00000000, 0x00000003,
    0xBA00C000, 0x38000000, 0xC200C200, 0x80000000, /* 6 */
    0x00000000, 0x00000000, 0x00000000, 0x00020001,
};

static const struct golden golden[] = {
    {"f32", ARRAY_COUNT(golden_f32), golden_f32, 5, golden_items},
    {"rf16", ARRAY_COUNT(golden_rf16), golden_rf16, 0, NULL},
    {"rtrs_direct", ARRAY_COUNT(golden_rtrs_direct), golden_rtrs_direct, 0, NULL},
    {"rtrs_rf", ARRAY_COUNT(golden_rtrs_rf), golden_rtrs_rf, 0, NULL},
    {"rtrs_rf_paper", ARRAY_COUNT(golden_rtrs_rf_paper), golden_rtrs_rf_paper, 0, NULL},
};

static struct packed pack(const char *layout, const struct bvh *bvh, const struct scene *scene)
{
    struct packed packed;
    struct reason reason = {""};
    if (packed_make(layout_find(layout), bvh, scene, &packed, &reason))
        fail_msg("%s", reason.text);
    return packed;
}

static void layouts_write_the_golden_words(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh;
    golden_tree(&scene, &bvh);
    for (size_t l = 0; layouts[l]; l++)
        assert_true(layouts[l]->width > 2 || l < ARRAY_COUNT(golden));
    for (size_t g = 0; g < ARRAY_COUNT(golden); g++) {
        struct packed packed = pack(golden[g].layout, &bvh, &scene);
        assert_int_equal(packed.word_count, golden[g].word_count);
        assert_int_equal(packed.word_count, packed.node_count * packed.layout->node_bytes / 4);
        for (uint32_t i = 0; i < packed.word_count; i++)
            if (packed.word[i] != golden[g].word[i])
                fail_msg("%s word %u: %08X, not %08X", golden[g].layout, i, packed.word[i],
                         golden[g].word[i]);
        assert_int_equal(packed.item_count, golden[g].item_count);
        if (golden[g].item_count)
            assert_memory_equal(packed.item, golden[g].item, 4 * golden[g].item_count);
        else
            assert_null(packed.item);
        assert_int_equal(packed.root, 0);
        assert_int_equal(packed.tri_count, 5);
        assert_int_equal(packed.stack_need, 2);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Appends what the subtree `ref` reads as: "(first second)" for inner nodes in load order, the
 * items of leaves in slot order with "-" for an empty slot. */
static void read_tree(const struct packed *packed, uint32_t ref, char *text, size_t bytes)
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    size_t used = strlen(text);
    snprintf(text + used, bytes - used, node.child_count ? "(" : "[");
    for (uint32_t c = 0; c < node.child_count; c++)
        read_tree(packed, node.child[c], text, bytes);
    for (uint32_t s = 0; node.child_count == 0 && s < node.item_count; s++) {
        uint32_t prim = packed_item(packed, &node, s);
        used = strlen(text);
        if (prim == ABI_NO_PRIM)
            snprintf(text + used, bytes - used, "-");
        else
            snprintf(text + used, bytes - used, "%u", prim);
    }
    used = strlen(text);
    snprintf(text + used, bytes - used, node.child_count ? ")" : "]");
}

static void layouts_read_back_what_they_wrote(void **state)
{
    (void)state;
    /* F2, F3: rtrs_direct tests items s - 1 .. s + c - 2 of the scene; rtrs_rf item k - 1 and none
     * for 0, of six slots; the paper's record k and none for 0, of eight. */
    static const char *const reads[][2] = {
        {"f32", "([40]([3][12]))"},
        {"rf16", "([40]([3][12]))"},
        {"rtrs_direct", "([-0]([1][23]))"},
        {"rtrs_rf", "([3-----]([2-----][01----]))"},
        {"rtrs_rf_paper", "([4-------]([3-------][12------]))"},
    };
    struct scene scene;
    struct bvh bvh;
    golden_tree(&scene, &bvh);
    for (size_t i = 0; i < ARRAY_COUNT(reads); i++) {
        struct packed packed = pack(reads[i][0], &bvh, &scene);
        char text[200] = "";
        read_tree(&packed, packed.root, text, sizeof text);
        assert_string_equal(text, reads[i][1]);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

static void layouts_visit_in_their_order(void **state)
{
    (void)state;
    assert_int_equal(layout_find("f32")->order, VISIT_NEAR);
    assert_int_equal(layout_find("rf16")->order, VISIT_NEAR);
    assert_int_equal(layout_find("rtrs_direct")->order, VISIT_SND);
    assert_int_equal(layout_find("rtrs_rf")->order, VISIT_FST);
    assert_int_equal(layout_find("rtrs_rf_paper")->order, VISIT_SND);
    assert_null(layout_find("rf17"));
}

/* Every decoded box of f32 is the tree's; of rf16 it contains it, as closely as a half can. */
static void layouts_keep_boxes(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh;
    golden_tree(&scene, &bvh);
    struct packed f32 = pack("f32", &bvh, &scene), rf16 = pack("rf16", &bvh, &scene);
    static const uint32_t record[5] = {0, 1, 3, 4, 6};
    for (uint32_t i = 0; i < 5; i++) {
        struct box exact = f32.layout->box(&f32, i);
        struct box loose = rf16.layout->box(&rf16, record[i]);
        assert_memory_equal(&exact, &bvh.node[i].bounds, sizeof exact);
        for (int k = 0; k < 3; k++) {
            assert_true(loose.lo[k] == half_to_float(half_bound_down(exact.lo[k])));
            assert_true(loose.hi[k] == half_to_float(half_bound_up(exact.hi[k])));
        }
    }
    packed_free(&f32);
    packed_free(&rf16);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Whatever the words hold, load drops references out of range, and item knows no slot outside. */
static void layouts_never_read_outside_their_words(void **state)
{
    (void)state;
    struct scene scene = trees_grid(64);
    struct bvh bvh = trees_make(&scene, 4, TREES_BALANCED);
    for (size_t l = 0; layouts[l]; l++)
        any_words_are_safe(layouts[l], &bvh, &scene);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layouts_write_the_golden_words),
        cmocka_unit_test(layouts_read_back_what_they_wrote),
        cmocka_unit_test(layouts_visit_in_their_order),
        cmocka_unit_test(layouts_keep_boxes),
        cmocka_unit_test(layouts_never_read_outside_their_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

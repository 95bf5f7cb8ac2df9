/* What f32 and rf16 can hold, at both sides of every border, and how deep any tree may be. */
#include "ref/trace/trace.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/held.h"

#include <math.h>
#include <stdio.h>

static void rf16_holds_eight_items_in_a_leaf(void **state)
{
    (void)state;
    must_hold(hold("rf16", trees_grid(7), 7, TREES_BALANCED), true);
    must_hold(hold("rf16", trees_grid(20), 7, TREES_BALANCED), true);
    must_hold(hold("rf16", trees_grid(8), 8, TREES_BALANCED), true);
    must_hold(hold("f32", trees_grid(9), 9, TREES_BALANCED), true);
    must_hold(hold("f32", trees_grid(1000), 333, TREES_BALANCED), true);
    must_hold(hold("rf16", trees_grid(20), 8, TREES_BALANCED), true);
    must_refuse(hold("rf16", trees_grid(9), 9, TREES_BALANCED),
                "rf16: a leaf holds at most 8 items, this tree has one of 9; use --leaf 8");
    must_refuse(hold("rf16", trees_grid(40), 13, TREES_BALANCED), "one of 13");
    struct held h = hold("rf16", trees_grid(8), 8, TREES_BALANCED);
    for (uint32_t s = 0; s < 8; s++)
        assert_int_equal(slot(&h.packed, 0, s), s);
    release(&h);
}

/* The largest leaf is named, wherever it stands. */
static void rf16_names_the_largest_leaf(void **state)
{
    (void)state;
    static const uint32_t size[][3] = {{13, 11, 9}, {11, 13, 9}, {9, 11, 13}, {8, 9, 16}};
    for (size_t i = 0; i < ARRAY_COUNT(size); i++) {
        struct held h = {.scene = trees_grid(33)};
        uint32_t leaf = 0, first = 0;
        char text[80];
        h.bvh = trees_make(&h.scene, 11, TREES_BALANCED);
        for (uint32_t n = 0; n < h.bvh.node_count; n++)
            if (h.bvh.node[n].item_count > 0) {
                h.bvh.node[n].item_first = first;
                h.bvh.node[n].item_count = size[i][leaf++];
                first += h.bvh.node[n].item_count;
            }
        assert_true(leaf == 3 && first == 33);
        trees_fit(&h.bvh, &h.scene);
        (void)snprintf(text, sizeof text, "at most 8 items, this tree has one of %u;",
                       i == 3 ? 16 : 13);
        h.status = packed_make(layout_find("rf16"), &h.bvh, &h.scene, &h.packed, &h.reason);
        must_refuse(h, text);
    }
}

/* Nodes above the root whose children are both the node below: no tree has them, but they give the
 * last record any number. */
static struct held with_nodes_above(uint32_t above)
{
    struct held h = {.scene = trees_grid(10923)};
    struct bvh_node *node;
    h.bvh = trees_make(&h.scene, 1, TREES_BALANCED);
    node = calloc(h.bvh.node_count + above, sizeof *node);
    assert_non_null(node);
    memcpy(node + above, h.bvh.node, h.bvh.node_count * sizeof *node);
    free(h.bvh.node);
    h.bvh.node = node;
    h.bvh.node_count += above;
    for (uint32_t i = 0; i < h.bvh.node_count; i++) {
        node[i].fst += i < above ? i + 1 : node[i].item_count > 0 ? 0 : above;
        node[i].snd += i < above ? i + 1 : node[i].item_count > 0 ? 0 : above;
    }
    trees_fit(&h.bvh, &h.scene);
    h.status = packed_make(layout_find("rf16"), &h.bvh, &h.scene, &h.packed, &h.reason);
    return h;
}

static void rf16_ends_at_record_32767(void **state)
{
    (void)state;
    for (uint32_t above = 0; above < 4; above++) {
        struct held h = with_nodes_above(above);
        char text[200];
        (void)snprintf(text, sizeof text,
                       "rf16: a child record index is at most 32767, this tree needs %u (10923 "
                       "leaves, %u records); use a larger --leaf, or --layout auto",
                       32766 + above, 32768 + above);
        if (32766 + above > 32767) {
            must_refuse(h, text);
            continue;
        }
        assert_int_equal(h.status, STATUS_OK);
        assert_int_equal(h.packed.node_count, 32768 + above);
        assert_int_equal(slot(&h.packed, 32766 + above, 0), 10922);
        release(&h);
    }
}

/* The last node of a tree in pre-order is a leaf, record 3 L - 3 for L leaves: the largest child
 * record is 32766 for 10923 leaves and 32769 for 10924, whatever the shape; no tree has
 * 32767 or 32768. */
static void rf16_holds_child_records_up_to_32767(void **state)
{
    (void)state;
    for (int shape = TREES_BALANCED; shape <= TREES_RIGHT; shape++) {
        enum trees_shape s = (enum trees_shape)shape;
        struct held h = hold_words("rf16", trees_grid(10923), 1, s);
        assert_int_equal(h.status, STATUS_OK);
        assert_int_equal(h.packed.node_count, 32768);
        assert_int_equal(slot(&h.packed, 32766, 0), 10922);
        release(&h);
        must_refuse(hold_words("rf16", trees_grid(10924), 1, s),
                    "rf16: a child record index is at most 32767, this tree needs 32769 (10924 "
                    "leaves, 32771 records)");
    }
    must_hold(hold("rf16", trees_grid(10923), 1, TREES_BALANCED), true);
    must_hold(hold("f32", trees_grid(10924), 1, TREES_BALANCED), true);
}

static void rf16_reads_all_fifteen_bits_of_a_child_record(void **state)
{
    (void)state;
    struct held h = hold("rf16", trees_grid(10923), 1, TREES_BALANCED);
    static const uint32_t record[] = {1, 16384, 32766, 32767};
    for (size_t i = 0; i < ARRAY_COUNT(record); i++) {
        struct wide node;
        h.packed.word[3] = record[i] << 16 | record[i];
        h.packed.layout->load(&h.packed, 0, &node);
        assert_int_equal(node.child_count, 2);
        assert_int_equal(node.child[0], record[i]);
        assert_int_equal(node.child[1], record[i]);
    }
    release(&h);
}

static void rf16_holds_triangles_up_to_65535(void **state)
{
    (void)state;
    struct held h = hold("rf16", trees_grid(65536), 8, TREES_BALANCED);
    assert_int_equal(h.status, STATUS_OK);
    assert_int_equal(packed_check(&h.packed, &h.scene, NULL, NULL), STATUS_OK);
    uint32_t record = 0;
    for (uint32_t i = 0; i < h.bvh.node_count; i++) {
        const struct bvh_node *node = &h.bvh.node[i];
        for (uint32_t k = 0; k < node->item_count; k++)
            assert_int_equal(slot(&h.packed, record, k), node->item_first + k);
        record += node->item_count > 0 ? 2 : 1;
    }
    release(&h);
    must_refuse(hold("rf16", trees_grid(65537), 8, TREES_BALANCED),
                "rf16: a triangle index is at most 65535, the scene's last is 65536");
    must_hold(hold("f32", trees_grid(65537), 8, TREES_BALANCED), true);
}

static void rf16_holds_bounds_up_to_65504(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            float s = (float)sign;
            must_hold(hold("rf16", reaching(s * 65503.9f, k), 1, TREES_BALANCED), true);
            must_hold(hold("rf16", reaching(s * 65504.0f, k), 1, TREES_BALANCED), true);
            must_refuse(hold("rf16", reaching(s * 65504.004f, k), 1, TREES_BALANCED), "65504.0039");
            must_refuse(hold("rf16", reaching(s * 65505.0f, k), 1, TREES_BALANCED),
                        sign < 0 ? "rf16: a bound is at most 65504 in magnitude, tree node 0 has "
                                   "-65505; scale or move the scene"
                                 : "tree node 0 has 65505;");
            must_refuse(hold("rf16", reaching(s * 65520.0f, k), 1, TREES_BALANCED), "65520");
            must_refuse(hold("rf16", reaching(s * 3e38f, k), 1, TREES_BALANCED), "e+38");
            must_hold(hold("f32", reaching(s * 65505.0f, k), 1, TREES_BALANCED), true);
            must_hold(hold("f32", reaching(s * 3.4e38f, k), 1, TREES_BALANCED), true);
        }
}

/* Whichever node it is, and on whichever side: the first one is named. */
static void rf16_names_the_node_beyond(void **state)
{
    (void)state;
    struct held h = hold("rf16", trees_grid(9), 2, TREES_BALANCED);
    packed_free(&h.packed);
    assert_true(h.bvh.node_count > 5);
    for (uint32_t i = 0; i < h.bvh.node_count; i++)
        for (int side = 0; side < 6; side++) {
            struct box *bounds = &h.bvh.node[i].bounds;
            float *bound = side < 3 ? &bounds->lo[side] : &bounds->hi[side - 3], was = *bound;
            char text[64];
            *bound = side < 3 ? -65505 : 65505;
            snprintf(text, sizeof text, "tree node %u has %d;", i, side < 3 ? -65505 : 65505);
            h.status = packed_make(layout_find("rf16"), &h.bvh, &h.scene, &h.packed, &h.reason);
            assert_int_equal(h.status, STATUS_LIMIT);
            assert_non_null(strstr(h.reason.text, text));
            *bound = was;
        }
    bvh_free(&h.bvh);
    scene_free(&h.scene);
}

static void repaired_layouts_refuse_what_is_not_finite(void **state)
{
    (void)state;
    static const char *const repaired[] = {"f32", "rf16"};
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t l = 0; l < ARRAY_COUNT(repaired); l++)
        for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
            must_refuse(hold(repaired[l], reaching(bad[i], 1), 1, TREES_BALANCED),
                        "triangle 1 has a vertex that is not finite");
            struct held h = {.scene = trees_grid(2)};
            h.bvh = trees_make(&h.scene, 1, TREES_BALANCED);
            h.bvh.node[2].bounds.hi[0] = bad[i];
            h.status =
                packed_make(layout_find(repaired[l]), &h.bvh, &h.scene, &h.packed, &h.reason);
            must_refuse(h, "tree node 2 has a bound that is not finite");
        }
}

/* A right chain of depth + 1 triangles in planes z = 0, -1, ...: a ray from z = -1e3 along +z meets
 * the deepest first, so that one entry per level waits on the stack. */
static struct held chain(const char *layout, uint32_t depth)
{
    struct scene scene = trees_grid(depth + 1);
    for (uint32_t i = 0; i <= depth; i++)
        for (uint32_t c = 0; c < 3; c++) {
            scene.vertex[9 * i + 3 * c] = c == 1 ? 2 : 0;
            scene.vertex[9 * i + 3 * c + 1] = c == 2 ? 2 : 0;
            scene.vertex[9 * i + 3 * c + 2] = -(float)i;
        }
    return hold(layout, scene, 1, TREES_RIGHT);
}

static void every_layout_holds_a_depth_of_64(void **state)
{
    (void)state;
    for (size_t l = 0; layouts[l]; l++) {
        for (uint32_t depth = 62; depth <= 64; depth++) {
            struct held h = chain(layouts[l]->name, depth);
            assert_int_equal(h.status, STATUS_OK);
            assert_int_equal(h.packed.stack_need, depth);
            release(&h);
        }
        must_refuse(chain(layouts[l]->name, 65),
                    "the traversal stack holds 64 entries, this tree is 65 deep");
    }
}

/* Most entries of a wide layout's stack: the children of a node are pushed before one is popped. */
static uint32_t entries_of(const struct packed *packed, uint32_t ref, uint32_t before)
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    uint32_t most = before + node.child_count;
    for (uint32_t c = 0; c < node.child_count; c++) {
        uint32_t below = entries_of(packed, node.child[c], before + node.child_count - 1);
        most = below > most ? below : most;
    }
    return most;
}

/* Chains on both sides of the border: the text has the entries that there are, and those needed. */
static void wide_layouts_count_their_stack(void **state)
{
    (void)state;
    uint32_t held = 0, refused = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        uint32_t most = layout_stack_most(layout), at_border = 0;
        for (uint32_t depth = 4; depth < 2 * most && layout_is_wide(layout) && !layout->faithful;
             depth += layout->width == 2 && depth >= 250 && depth < 270 ? 1 : 41) {
            struct held words = hold_words(layout->name, trees_grid(depth + 1), 1, TREES_RIGHT);
            struct held h = hold(layout->name, trees_grid(depth + 1), 1, TREES_RIGHT);
            char text[200];
            assert_int_equal(words.status, STATUS_OK);
            uint32_t need = entries_of(&words.packed, words.packed.root, 0);
            (void)snprintf(text, sizeof text,
                           "%s: the traversal stack holds %u entries, this tree needs %u; use "
                           "builder median or a larger --leaf",
                           layout->name, most, need);
            assert_int_equal(h.status, need > most ? STATUS_LIMIT : STATUS_OK);
            assert_string_equal(h.reason.text, need > most ? text : "");
            if (!h.status)
                assert_int_equal(h.packed.stack_need, need);
            held += need <= most;
            refused += need > most;
            at_border += need == most;
            release(&words);
            release(&h);
        }
        assert_true(at_border > 0 || layout->width > 2 || !layout_is_wide(layout));
    }
    assert_true(held > 300 && refused > 100);
}

static void a_ray_can_use_the_whole_stack(void **state)
{
    (void)state;
    static const char *const repaired[] = {"f32", "rf16"};
    struct ray ray = {{0.5f, 0.5f, -1000}, 0, {0, 0, 1}, 1e30f};
    for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
        struct held h = chain(repaired[l], 64);
        struct hit hit;
        assert_int_equal(trace_ray(&(struct job){.scene = &h.scene,
                                                 .packed = &h.packed,
                                                 .box = box_test_find("robust"),
                                                 .tri = tri_test_find("mt"),
                                                 .query = QUERY_CLOSEST},
                                   &ray, &hit, NULL),
                         STATUS_OK);
        assert_int_equal(hit.prim, 64);
        assert_true(hit.t == 936);
        h.packed.stack_need = 63;
        assert_int_equal(trace_ray(&(struct job){.scene = &h.scene,
                                                 .packed = &h.packed,
                                                 .box = box_test_find("robust"),
                                                 .tri = tri_test_find("mt"),
                                                 .query = QUERY_CLOSEST},
                                   &ray, &hit, NULL),
                         STATUS_LIMIT);
        release(&h);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rf16_holds_eight_items_in_a_leaf),
        cmocka_unit_test(rf16_names_the_largest_leaf),
        cmocka_unit_test(rf16_ends_at_record_32767),
        cmocka_unit_test(rf16_holds_child_records_up_to_32767),
        cmocka_unit_test(rf16_reads_all_fifteen_bits_of_a_child_record),
        cmocka_unit_test(rf16_holds_triangles_up_to_65535),
        cmocka_unit_test(rf16_holds_bounds_up_to_65504),
        cmocka_unit_test(rf16_names_the_node_beyond),
        cmocka_unit_test(repaired_layouts_refuse_what_is_not_finite),
        cmocka_unit_test(every_layout_holds_a_depth_of_64),
        cmocka_unit_test(wide_layouts_count_their_stack),
        cmocka_unit_test(a_ray_can_use_the_whole_stack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

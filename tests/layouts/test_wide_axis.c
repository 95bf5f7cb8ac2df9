/* The parts of wide layouts by definition: the planes of an axis, which axis is the finest, and
 * which slots of a record are children, whatever its words are. */
#include "ref/layouts/wide_nodes.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/support/built.h"

/* --- axes ------------------------------------------------------------------------------------- */

#define LEAST (-100) /* of exponents */

static float signed_power(float sign, float part, int exponent)
{
    return sign * ldexpf(part, exponent);
}

/* The axis of an exponent, if its origin is an integer of at most 2^23 steps and its last plane is
 * at least hi. All is exact in the 64 bits of a long double. */
static bool axis_fits(float lo, float hi, uint32_t most, int exponent, long double *origin)
{
    long double step = ldexpl(1, exponent), first = floorl((long double)lo / step);
    *origin = first * step;
    return fabsl(first) <= 0x1p23L && (first + most) * step >= (long double)hi;
}

static void check_axis(float lo, float hi, uint32_t most)
{
    struct node_axis axis = node_axis_make(lo, hi, most);
    long double origin = 0;
    int exponent = LEAST;
    while (!axis_fits(lo, hi, most, exponent, &origin))
        exponent++;
    if (axis.exponent != exponent || (long double)axis.origin != origin ||
        (signbit(axis.origin) != 0) != (origin < 0))
        fail_msg("%a to %a, %u steps: %a and 2^%d, not %a and 2^%d", (double)lo, (double)hi, most,
                 (double)axis.origin, axis.exponent, (double)origin, exponent);
    for (uint32_t q = 0; q <= most; q += 1 + most / 4) {
        float plane = (float)(origin + q * ldexpl(1, exponent));
        assert_true(node_axis_plane(&axis, q) == plane);
        for (int way = -1; way <= 1; way++) {
            float x = way ? nextafterf(plane, (float)way * INFINITY) : plane;
            uint32_t below = 0, most_below = 0; /* planes below x; planes that are at most x */
            for (uint32_t p = 0; p <= most; p++) {
                long double other = origin + p * ldexpl(1, exponent);
                below += other < (long double)x;
                most_below += other <= (long double)x;
            }
            if (most_below == 0 || below > most)
                continue; /* it lies outside */
            assert_int_equal(node_axis_down(&axis, x), most_below - 1);
            assert_int_equal(node_axis_up(&axis, x), below);
        }
    }
}

static void the_finest_axis_that_fits_is_made(void **state)
{
    (void)state;
    static const float part[] = {0.5f, 0.500000059f, 0.75f, 0.996093750f, 0.999999940f};
    static const uint32_t most[] = {2, 3, 15, 254, 255, 4096};
    static const int exponent[] = {-99, -98, -93, -77, -60, -24, -1, 0,
                                   1,   7,   23,  24,  25,  66,  99, 100};
    float place[2 * ARRAY_COUNT(part) * ARRAY_COUNT(exponent) + 1];
    uint32_t count = 0;
    for (uint32_t e = 0; e < ARRAY_COUNT(exponent); e++)
        for (uint32_t p = 0; p < ARRAY_COUNT(part); p++)
            for (int side = -1; side < 2; side += 2)
                place[count++] = signed_power((float)side, part[p], exponent[e]);
    place[count++] = 0;
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = 0; b < count; b++)
            if (place[a] <= place[b])
                check_axis(place[a], place[b], most[(a + b) % ARRAY_COUNT(most)]);
}

/* Planes of any exponent that a byte holds are right, those of no axis that is made, too. */
static void planes_are_exact_at_every_exponent(void **state)
{
    (void)state;
    for (int exponent = -149; exponent <= 127; exponent++) {
        const struct node_axis axis = {0, exponent};
        assert_true(node_axis_plane(&axis, 1) == ldexpf(1, exponent));
    }
    const struct node_axis least = {0, -150}, most = {0, 128};
    assert_true(node_axis_plane(&least, 1) == 0 && isinf(node_axis_plane(&most, 1)));
}

/* --- slots ------------------------------------------------------------------------------------ */

#define REFS 9u /* references below it are nodes */

/* Slot s is empty, a leaf, or refers to the last node or to the first reference behind it. */
enum slot_kind { SLOT_NONE, SLOT_LEAF, SLOT_LAST, SLOT_BEHIND, SLOT_KINDS };

static struct wide_slot slot_of(enum slot_kind kind, uint32_t s)
{
    float at = (float)s;
    return (struct wide_slot){.there = kind != SLOT_NONE,
                              .first = kind == SLOT_LAST     ? REFS - 1
                                       : kind == SLOT_BEHIND ? REFS
                                                             : REFS + 3 + s,
                              .count = kind == SLOT_LEAF ? s + 1 : 0,
                              .box = {{at, at, at}, {at + 1, at + 1, at + 1}}};
}

/* Every record of three slots under a layout of three: the children, their boxes one for one, the
 * union of what is there; a fourth slot counts for nothing. */
static void slots_that_refer_to_no_node_are_no_children(void **state)
{
    (void)state;
    const struct layout three = {.name = "three", .width = 3};
    const struct packed packed = {.layout = &three};
    for (uint32_t code = 0; code < SLOT_KINDS * SLOT_KINDS * SLOT_KINDS; code++) {
        struct wide_slot slot[WIDE_MAX] = {0};
        struct wide node;
        struct box all = box_empty(), one[WIDE_MAX];
        const struct box *box[WIDE_MAX];
        uint32_t children = 0;
        for (uint32_t s = 0, rest = code; s < 4; s++, rest /= SLOT_KINDS)
            slot[s] = slot_of(s == 3 ? SLOT_LAST : (enum slot_kind)(rest % SLOT_KINDS), s);
        wide_nodes_children(&packed, slot, REFS, 100, &node);
        assert_true(node.item_first == 0 && node.item_count == 0);
        for (uint32_t s = 0; s < WIDE_MAX; s++)
            one[s] = (struct box){{(float)s}, {50}};
        struct wide moved = node;
        memcpy(moved.box, one, sizeof one);
        wide_nodes_boxes(&packed, slot, REFS, &moved, box);
        for (uint32_t s = 0; s < WIDE_MAX; s++) {
            bool child = s < 3 && slot[s].there && (slot[s].count > 0 || slot[s].first == REFS - 1);
            if (s < 3 && slot[s].there)
                box_add_box(&all, &slot[s].box);
            assert_true((box[s] != NULL) == child);
            if (!child)
                continue;
            assert_true(box[s] == &moved.box[children]);
            assert_int_equal(node.child[children], slot[s].count ? 100 + s : REFS - 1);
            assert_int_equal(node.leaf_first[children], slot[s].first);
            assert_int_equal(node.leaf_count[children], slot[s].count);
            assert_memory_equal(&node.box[children], &slot[s].box, sizeof slot[s].box);
            children++;
        }
        assert_int_equal(node.child_count, children);
        struct box got = wide_nodes_union(&packed, slot);
        assert_memory_equal(&got, &all, sizeof all);
        /* Fewer boxes than slots: those behind the last have none. */
        if (children > 0) {
            moved.child_count--;
            wide_nodes_boxes(&packed, slot, REFS, &moved, box);
            for (uint32_t s = 0, seen = 0; s < 3; s++) {
                bool child = slot[s].there && (slot[s].count > 0 || slot[s].first == REFS - 1);
                assert_true((box[s] != NULL) == (child && seen < moved.child_count));
                seen += child;
            }
        }
    }
}

/* Of a tree of one triangle every reference of a slot but the first is empty. */
static void empty_slots_hold_nothing(void **state)
{
    (void)state;
    static const char *const names[] = {"half4", "tiny8", "cwbvh80", "gfx12", "hpb64", "obb8"};
    for (uint32_t i = 0; i < ARRAY_COUNT(names); i++) {
        const struct layout *layout = layout_find(names[i]);
        struct scene scene = built_soup(1, 3);
        const struct build_options options = {.leaf = 1, .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh;
        struct packed packed;
        struct reason reason = {""};
        assert_non_null(layout);
        assert_int_equal(bvh_build(builder_find("median"), &scene, &options, &bvh, &reason), 0);
        assert_int_equal(packed_make(layout, &bvh, &scene, &packed, &reason), 0);
        assert_int_equal(packed.node_count, 1);
        for (uint32_t ref = 1; ref <= layout->width; ref++) {
            struct wide leaf;
            memset(&leaf, 0xAB, sizeof leaf);
            layout->load(&packed, ref, &leaf);
            assert_int_equal(leaf.child_count, 0);
            assert_int_equal(leaf.item_first, 0);
            assert_int_equal(leaf.item_count, ref == 1);
        }
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_finest_axis_that_fits_is_made),
        cmocka_unit_test(planes_are_exact_at_every_exponent),
        cmocka_unit_test(slots_that_refer_to_no_node_are_no_children),
        cmocka_unit_test(empty_slots_hold_nothing),
    };
    return cmocka_run_group_tests_name("wide_axis", tests, NULL, NULL) ? 1 : 0;
}

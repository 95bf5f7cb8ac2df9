/* Layouts gfx12: fields by their places in bits, bounds at the ends of every slot, and where the
 * encoder as published makes boxes that are too small. */
#include "ref/base/rng.h"
#include "ref/packed/packed_check.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "tests/layouts/records.h"

#define CHILDREN 8u

struct published {
    uint32_t code[6]; /* min x, y, z, max x, y, z */
    uint32_t type, size, flags, unused, mask;
};

static struct published child_of(const uint32_t *word, uint32_t s)
{
    const uint32_t at = 256 + 96 * s;
    return (struct published){{bits(word, at, 12), bits(word, at + 12, 12), bits(word, at + 32, 12),
                               bits(word, at + 44, 12), bits(word, at + 64, 12),
                               bits(word, at + 76, 12)},
                              .flags = bits(word, at + 24, 4),
                              .unused = bits(word, at + 28, 4),
                              .mask = bits(word, at + 56, 8),
                              .type = bits(word, at + 88, 4),
                              .size = bits(word, at + 92, 4)};
}

/* The box of a child, exactly. */
static void exact_box(const uint32_t *word, uint32_t s, long double lo[3], long double hi[3])
{
    const struct published child = child_of(word, s);
    for (uint32_t k = 0; k < 3; k++) {
        const long double origin = float_from_bits(bits(word, 96 + 32 * k, 32));
        const long double extent = ldexpl(1, (int)bits(word, 192 + 8 * k, 8) - 127);
        lo[k] = origin + child.code[k] * (extent / 4096);
        hi[k] = origin + (child.code[3 + k] + 1) * (extent / 4096);
    }
}

/* --- fields ----------------------------------------------------------------------------------- */

/* Of a record: what lies where. Returns its children that are nodes. */
static uint32_t check_record(const struct packed *packed, uint32_t record)
{
    const uint32_t *word = packed->word + 32 * (size_t)record;
    uint32_t count = bits(word, 220, 4) + 1, place[2] = {word[0], word[1]}, nodes = 0;
    struct wide node;
    packed->layout->load(packed, record, &node);
    assert_int_equal(node.child_count, count);
    assert_int_equal(word[2], 0);
    assert_int_equal(bits(word, 216, 4), 0);
    assert_int_equal(word[7], 0x7F);
    for (uint32_t s = 0; s < CHILDREN; s++) {
        const struct published child = child_of(word, s);
        const uint32_t none[3] = {0xFFFFFFFF, 0xFFF, 0};
        if (s >= count) {
            assert_memory_equal(word + 8 + 3 * s, none, sizeof none);
            continue;
        }
        bool inner = node.leaf_count[s] == 0;
        assert_int_equal(child.type, inner ? 5 : 0);
        assert_int_equal(child.size, inner ? 1 : node.leaf_count[s]);
        assert_int_equal(place[!inner], inner ? node.child[s] : node.leaf_first[s]);
        assert_true(child.flags == 0 && child.unused == 0 && child.mask == 0xFF);
        place[!inner] += child.size;
        nodes += inner;
    }
    return nodes;
}

static void fields_lie_where_they_are_published(void **state)
{
    (void)state;
    static const char *const layout[] = {"gfx12", "gfx12_mesa"};
    for (size_t l = 0; l < ARRAY_COUNT(layout); l++)
        for (uint32_t leaf = 1; leaf <= 8; leaf++) {
            struct packed packed;
            struct scene scene = copies(840, leaf); /* of whole leaves */
            uint32_t nodes = 0;
            pack(&packed, layout[l], &scene, leaf);
            assert_int_equal(packed_check(&packed, &scene, NULL, NULL), STATUS_OK);
            for (uint32_t r = 0; r < packed.node_count; r++)
                nodes += check_record(&packed, r);
            assert_int_equal(nodes, packed.node_count - 1);
            assert_true(nodes > 3);
            packed_free(&packed);
            scene_free(&scene);
        }
}

/* --- bounds ----------------------------------------------------------------------------------- */

static void check_held(const struct packed *packed, const struct box *box, uint32_t count)
{
    struct wide node;
    packed->layout->load(packed, 0, &node);
    for (uint32_t s = 0; s < count; s++) {
        long double lo[3], hi[3];
        exact_box(packed->word, s, lo, hi);
        for (int k = 0; k < 3; k++) {
            if (!(lo[k] <= box[s].lo[k] && hi[k] >= box[s].hi[k]))
                fail_msg("slot %u, axis %d: [%La, %La] does not hold [%a, %a]", s, k, lo[k], hi[k],
                         (double)box[s].lo[k], (double)box[s].hi[k]);
            assert_true(node.box[s].lo[k] == lo[k] && node.box[s].hi[k] == hi[k]);
            assert_true(lo[k] == 0 || fabsl(lo[k]) >= FLT_MIN);
            assert_true(hi[k] == 0 || fabsl(hi[k]) >= FLT_MIN);
        }
    }
}

/* Of any boxes; every plane is a float32, neither rounded nor subnormal. */
static void any_boxes_are_held(void **state)
{
    (void)state;
    struct rng rng = rng_make(21, 0);
    for (uint32_t count = 2; count <= CHILDREN; count++) {
        struct packed packed = leaves("gfx12", count);
        for (int round = 0; round < 3000; round++) {
            struct box box[CHILDREN];
            for (int k = 0; k < 3; k++)
                for (uint32_t s = 0, kind = rng_below(&rng, 5); s < count; s++) {
                    float a = any_bound(&rng, (int)kind), b = any_bound(&rng, (int)kind);
                    box[s].lo[k] = fminf(a, b);
                    box[s].hi[k] = fmaxf(a, b);
                }
            assert_int_equal(write_boxes(&packed, box, count), STATUS_OK);
            check_held(&packed, box, count);
            (void)check_record(&packed, 0);
        }
        packed_free(&packed);
    }
}

/* The least and the largest code in each slot, of each axis: of a child as large as the node, of
 * one that lies in its lower face, and of one in its upper face. */
static void every_slot_has_the_first_and_the_last_code(void **state)
{
    (void)state;
    struct packed packed = leaves("gfx12", CHILDREN);
    for (uint32_t s = 0; s < CHILDREN; s++)
        for (uint32_t k = 0; k < 3; k++)
            for (int face = 0; face < 3; face++) {
                struct box box[CHILDREN];
                for (uint32_t t = 0; t < CHILDREN; t++)
                    box[t] = t == (s + 1) % CHILDREN ? (struct box){{0, 0, 0}, {2, 4, 8}}
                                                     : (struct box){{1, 2, 4}, {1.5f, 3, 6}};
                float end = (float)(2 << k);
                box[s].lo[k] = face == 2 ? end : 0;
                box[s].hi[k] = face == 1 ? 0 : end;
                assert_int_equal(write_boxes(&packed, box, CHILDREN), STATUS_OK);
                check_held(&packed, box, CHILDREN);
                for (uint32_t t = 0; t < CHILDREN; t++)
                    for (uint32_t j = 0; j < 3; j++) {
                        bool ends = t == (s + 1) % CHILDREN, met = t == s && j == k;
                        uint32_t lo = ends || met ? 0 : 2048, hi = ends || met ? 4095 : 3071;
                        struct published child = child_of(packed.word, t);
                        assert_int_equal(child.code[j], met && face == 2 ? 4095 : lo);
                        assert_int_equal(child.code[3 + j], met && face == 1 ? 0 : hi);
                    }
            }
    packed_free(&packed);
}

/* --- as published ----------------------------------------------------------------------------- */

/* One child whose bounds are `lo` and `hi` along x. True if its box holds it, exactly. */
static bool holds(struct packed *packed, float lo, float hi)
{
    const struct box box = {{lo, 0, 0}, {hi, 1, 1}};
    long double low[3], high[3];
    assert_int_equal(write_boxes(packed, &box, 1), STATUS_OK);
    exact_box(packed->word, 0, low, high);
    return low[0] <= lo && high[0] >= hi;
}

/* Of all nodes of one child whose bounds are powers of two, or 0: those that the published encoder
 * cuts end at a 2^24th of the other end's distance from 0 or less, beyond 0. */
static void the_smallest_node_that_is_cut(void **state)
{
    (void)state;
    struct packed mesa = leaves("gfx12_mesa", 1), ours = leaves("gfx12", 1);
    uint32_t cut = 0;
    for (int a = -31; a <= 31; a++)
        for (int b = -31; b <= 31; b++) {
            float lo = a < -30 ? 0 : -ldexpf(1, a), hi = b < -30 ? 0 : ldexpf(1, b);
            bool small = a < -30 || b < -30 || (a - b < 24 && b - a < 24);
            assert_true(holds(&ours, lo, hi));
            if (holds(&mesa, lo, hi))
                continue;
            cut++;
            assert_false(small);
        }
    assert_int_equal(cut, 38 * 39); /* every one that is not small: 62 powers, 24 to 61 apart */
    assert_false(holds(&mesa, -0x1p24f, 1));
    assert_true(holds(&mesa, -0x1p23f, 1));
    packed_free(&mesa);
    packed_free(&ours);
}

/* The same as a scene of one triangle: the check of packed trees finds it, in its top row. */
static void a_triangle_that_is_cut(void **state)
{
    (void)state;
    static const float vertex[] = {0, 0, 0, -0x1p24f, 0, 0, 1, 8, 0};
    struct scene scene = trees_grid(1);
    memcpy(scene.vertex, vertex, sizeof vertex);
    struct packed mesa, ours;
    struct packed_faults faults;
    struct reason reason = {""};
    struct wide node;
    pack(&mesa, "gfx12_mesa", &scene, 1);
    pack(&ours, "gfx12", &scene, 1);
    assert_int_equal(packed_check(&ours, &scene, &faults, &reason), STATUS_OK);
    assert_int_equal(packed_check(&mesa, &scene, &faults, &reason), STATUS_INPUT);
    assert_int_equal(faults.loose_boxes, 2); /* its own, and that of the root */
    mesa.layout->load(&mesa, 0, &node);
    assert_true(node.box[0].lo[0] == -0x1p24f && node.box[0].hi[0] == 0);
    packed_free(&mesa);
    packed_free(&ours);
    scene_free(&scene);
}

/* A child from -10^-5 to 10^-5 in a node from -1000 to 24, whose box is empty but for 0. */
static void a_child_about_zero_is_lost(void **state)
{
    (void)state;
    struct packed mesa = leaves("gfx12_mesa", 2);
    const struct box box[2] = {{{-1000, 0, 0}, {24, 1, 1}}, {{-1e-5f, 0, 0}, {1e-5f, 1, 1}}};
    long double lo[3], hi[3];
    assert_int_equal(write_boxes(&mesa, box, 2), STATUS_OK);
    exact_box(mesa.word, 1, lo, hi);
    assert_true(lo[0] == 0 && hi[0] == 0);
    packed_free(&mesa);
}

/* Where the differences from the corner are float32, nothing is cut. */
static void exact_differences_are_held(void **state)
{
    (void)state;
    struct rng rng = rng_make(22, 0);
    struct packed mesa = leaves("gfx12_mesa", 3);
    for (int round = 0; round < 20000; round++) {
        struct box box[3];
        int scale = (int)rng_below(&rng, 100) - 50;
        for (uint32_t i = 0; i < 9; i++) {
            float a = (float)rng_below(&rng, 1 << 22) - 0x1p21f,
                  b = (float)rng_below(&rng, 1 << 22);
            box[i / 3].lo[i % 3] = ldexpf(a, scale);
            box[i / 3].hi[i % 3] = ldexpf(fmaxf(a, b - 0x1p21f), scale);
        }
        assert_int_equal(write_boxes(&mesa, box, 3), STATUS_OK);
        for (uint32_t s = 0; s < 3; s++) {
            long double lo[3], hi[3];
            exact_box(mesa.word, s, lo, hi);
            for (int k = 0; k < 3; k++)
                assert_true(lo[k] <= box[s].lo[k] && hi[k] >= box[s].hi[k]);
        }
    }
    packed_free(&mesa);
}

/* The published rule in whole numbers: of differences rounded to float32, the steps below the lower
 * and the steps not above the upper one, which may be none: then the last. */
static void codes_are_those_of_the_published_rule(void **state)
{
    (void)state;
    struct rng rng = rng_make(23, 0);
    struct packed mesa = leaves("gfx12_mesa", 2);
    uint32_t wrapped = 0;
    for (int round = 0; round < 20000; round++) {
        float corner = rng_range(&rng, -1000, 1000), a = rng_range(&rng, 0, 1), b = 3 * a;
        float low = rng_below(&rng, 4) ? corner + a : corner,
              high = corner + (low > corner ? b : 0);
        const struct box box[2] = {{{corner, 0, 0}, {corner + 4, 1, 1}},
                                   {{low, 0, 0}, {high, 1, 1}}};
        float all = corner + 4 - corner, last = high - corner;
        int exponent = 0;
        while (ldexpf(1, exponent) < all)
            exponent++;
        double step = ldexp(1, exponent - 12), lo = floor((low - corner) / step);
        uint32_t hi = 4095;
        if (last > 0)
            for (hi = 0; (hi + 1) * step < (double)last;)
                hi++;
        assert_int_equal(write_boxes(&mesa, box, 2), STATUS_OK);
        struct published child = child_of(mesa.word, 1);
        assert_int_equal(bits(mesa.word, 192, 8), exponent + 127);
        assert_true(child.code[0] == lo && child.code[3] == hi);
        wrapped += last == 0;
    }
    assert_true(wrapped > 1000);
    packed_free(&mesa);
}

/* Flat along an axis: 0 / 0 is 0 here, and the extent is none. */
static void a_flat_node_is_as_flat_as_it_is(void **state)
{
    (void)state;
    struct packed mesa = leaves("gfx12_mesa", 1);
    const struct box flat = {{7, 0, 0}, {7, 1, 1}}, tiny = {{0, 0, 0}, {0x1p-115f, 1, 1}};
    struct wide node;
    assert_int_equal(write_boxes(&mesa, &flat, 1), STATUS_OK);
    mesa.layout->load(&mesa, 0, &node);
    assert_true(node.box[0].lo[0] == 7 && node.box[0].hi[0] == 7);
    assert_int_equal(bits(mesa.word, 192, 8), 0);
    assert_int_equal(write_boxes(&mesa, &tiny, 1), STATUS_LIMIT);
    packed_free(&mesa);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_lie_where_they_are_published),
        cmocka_unit_test(any_boxes_are_held),
        cmocka_unit_test(every_slot_has_the_first_and_the_last_code),
        cmocka_unit_test(the_smallest_node_that_is_cut),
        cmocka_unit_test(a_triangle_that_is_cut),
        cmocka_unit_test(a_child_about_zero_is_lost),
        cmocka_unit_test(exact_differences_are_held),
        cmocka_unit_test(codes_are_those_of_the_published_rule),
        cmocka_unit_test(a_flat_node_is_as_flat_as_it_is),
    };
    return cmocka_run_group_tests_name("gfx12", tests, NULL, NULL);
}

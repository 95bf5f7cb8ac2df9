/* Layout hpb64: fields by their places in bits, planes by their definition, the closest of them;
 * and where the library's encoder and decoder, as published, hold what was written. */
#include "ref/packed/packed_check.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/records.h"

#define CHILDREN 4u
#define UNITS    0x1FFFFu
#define NEGATIVE 0x20000u

static uint32_t code_of(const uint32_t *word, uint32_t s, uint32_t i)
{
    return bits(word, 80 + 18 * (6 * s + i), 18);
}

static long double unit_of(const uint32_t *word, uint32_t k)
{
    return ldexpl(1, (int)bits(word, 56 + 8 * k, 8) - 143);
}

/* A plane: so many units; where that cut the box, the last float32 before the next unit. */
static float plane(uint32_t code, long double unit, bool up)
{
    bool negative = code & NEGATIVE;
    float is = (float)((code & UNITS) * unit);
    if (up != negative)
        is = nextafterf((float)(((code & UNITS) + 1) * unit), 0);
    return negative ? -is : is;
}

/* --- fields ----------------------------------------------------------------------------------- */

static uint32_t check_record(const struct packed *packed, uint32_t record)
{
    static const uint32_t type_of[] = {4, 0, 1, 3, 5};
    const uint32_t *word = packed->word + 16 * (size_t)record;
    uint32_t node_at = bits(word, 0, 22), item = bits(word, 22, 7) | bits(word, 41, 15) << 7;
    uint32_t nodes = 0;
    struct wide node;
    packed->layout->load(packed, record, &node);
    for (uint32_t s = 0; s < CHILDREN; s++) {
        uint32_t type = bits(word, 29 + 3 * s, 3);
        if (s >= node.child_count) { /* inside out */
            assert_int_equal(type, 2);
            for (uint32_t i = 0; i < 6; i++)
                assert_int_equal(code_of(word, s, i), i < 3 ? UNITS : NEGATIVE | UNITS);
            continue;
        }
        assert_int_equal(type, type_of[node.leaf_count[s]]);
        if (node.leaf_count[s] == 0)
            assert_int_equal(node.child[s], node_at + nodes++);
        else
            assert_int_equal(node.leaf_first[s], item);
        item += node.leaf_count[s];
        for (uint32_t k = 0; k < 3; k++) {
            long double unit = unit_of(word, k);
            assert_true(node.box[s].lo[k] == plane(code_of(word, s, k), unit, false));
            assert_true(node.box[s].hi[k] == plane(code_of(word, s, 3 + k), unit, true));
        }
    }
    return nodes;
}

static void fields_lie_where_they_are_published(void **state)
{
    (void)state;
    for (uint32_t leaf = 1; leaf <= 4; leaf++) {
        struct packed packed;
        struct scene scene = copies(840, leaf); /* more items than seven bits count */
        uint32_t nodes = 0;
        pack(&packed, "hpb64", &scene, leaf);
        assert_int_equal(packed_check(&packed, &scene, NULL, NULL), STATUS_OK);
        for (uint32_t r = 0; r < packed.node_count; r++)
            nodes += check_record(&packed, r);
        assert_int_equal(nodes, packed.node_count - 1);
        assert_true(nodes > 10);
        packed_free(&packed);
        scene_free(&scene);
    }
}

/* --- bounds ----------------------------------------------------------------------------------- */

/* The code whose plane is the next one upward; false: there is none. */
static bool next_code(uint32_t code, bool up, uint32_t *next)
{
    uint32_t units = code & UNITS;
    if (!(code & NEGATIVE)) {
        *next = code + 1;
        return units < UNITS;
    }
    *next = units ? code - 1 : 0;
    return units || up; /* the last negative upper bound is 0, which is below that of code 0 */
}

/* The plane holds x, and the one beside it, inward, would not. */
static void check_closest(float x, uint32_t code, long double unit, bool up)
{
    float is = plane(code, unit, up), better = is;
    uint32_t next;
    assert_true(up ? is >= x : is <= x);
    assert_true(is == 0 || fabsf(is) >= FLT_MIN);
    if (!up) {
        if (!next_code(code, up, &next))
            next = 0;
        better = plane(next, unit, false);
        if (better > is && better <= x)
            fail_msg("%a is written as %a, not as %a", (double)x, (double)is, (double)better);
        return;
    }
    if (code & NEGATIVE)
        next = (code & UNITS) == UNITS ? code : code + 1;
    else
        next = code ? code - 1 : NEGATIVE;
    better = plane(next, unit, true);
    if (better < is && better >= x)
        fail_msg("%a is written as %a, not as %a", (double)x, (double)is, (double)better);
}

static void check_written(const struct packed *packed, const struct box *box, uint32_t count)
{
    for (uint32_t k = 0; k < 3; k++) {
        long double unit = unit_of(packed->word, k), least = ldexpl(1, 43 - 143), most = 0;
        for (uint32_t s = 0; s < count; s++) {
            check_closest(box[s].lo[k], code_of(packed->word, s, k), unit, false);
            check_closest(box[s].hi[k], code_of(packed->word, s, 3 + k), unit, true);
            most = fmaxl(most, fmaxl(fabsl(box[s].lo[k]), fabsl(box[s].hi[k])));
        }
        /* No finer unit holds them. */
        assert_true(unit == least || most >= UNITS / 2 * unit);
    }
}

static void any_boxes_are_held_as_closely_as_can_be(void **state)
{
    (void)state;
    struct rng rng = rng_make(31, 0);
    for (uint32_t count = 2; count <= CHILDREN; count++) {
        struct packed packed = leaves("hpb64", count);
        for (int round = 0; round < 6000; round++) {
            struct box box[CHILDREN];
            for (int k = 0; k < 3; k++)
                for (uint32_t s = 0, kind = rng_below(&rng, 6); s < count; s++) {
                    float a = any_bound(&rng, (int)kind), b = any_bound(&rng, (int)kind);
                    if (kind == 5) /* 0, and whole units */
                        a = (float)rng_below(&rng, 3) - 1, b = 0;
                    box[s].lo[k] = fminf(a, b);
                    box[s].hi[k] = fmaxf(a, b);
                }
            assert_int_equal(write_boxes(&packed, box, count), STATUS_OK);
            check_written(&packed, box, count);
            (void)check_record(&packed, 0);
        }
        packed_free(&packed);
    }
}

/* In each slot, along each axis: all units, of both signs, and none; -0 is 0. */
static void every_slot_has_the_first_and_the_last_code(void **state)
{
    (void)state;
    static const struct {
        float lo, hi;
        uint32_t lo_code, hi_code;
    } end[] = {
        {-0x1.ffffp9f, 0x1.ffffp9f, NEGATIVE | UNITS, UNITS},
        {0x1.ffffp9f, 0x1.fffffep9f, UNITS, UNITS},
        {-0x1.fffffep9f, -0x1.ffffp9f, NEGATIVE | UNITS, NEGATIVE | UNITS},
        {0, 0, 0, NEGATIVE},
        {-0.0f, -0.0f, 0, NEGATIVE},
        {0x1p-20f, 0x1p-20f, 0, 0},
        {-0x1p-20f, -0x1p-20f, NEGATIVE, NEGATIVE},
    };
    struct packed packed = leaves("hpb64", CHILDREN);
    for (uint32_t s = 0; s < CHILDREN; s++)
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t e = 0; e < ARRAY_COUNT(end); e++) {
                struct box box[CHILDREN];
                for (uint32_t t = 0; t < CHILDREN; t++)
                    box[t] = (struct box){{-512, 256, 512}, {-256, 512, 1023}};
                box[(s + 1) % CHILDREN] = (struct box){{512, 512, 512}, {1000, 1000, 1000}};
                box[s].lo[k] = end[e].lo;
                box[s].hi[k] = end[e].hi;
                assert_int_equal(write_boxes(&packed, box, CHILDREN), STATUS_OK);
                check_written(&packed, box, CHILDREN);
                (void)check_record(&packed, 0);
                assert_int_equal(code_of(packed.word, s, k), end[e].lo_code);
                assert_int_equal(code_of(packed.word, s, 3 + k), end[e].hi_code);
            }
    packed_free(&packed);
}

/* --- as published ----------------------------------------------------------------------------- */

/* The library's arithmetic, in bits: a number cut to units, ... */
static uint32_t library_code(uint32_t number, uint32_t exponent)
{
    uint32_t own = number >> 23 & 0xFF, fraction = number & 0x7FFFFF, shift = exponent - own;
    if (own > 0)
        fraction = 0x400000 | fraction >> 1;
    return number >> 31 << 17 | (shift < 23 ? fraction >> shift : 0) >> 6;
}

/* ... and read again. */
static uint32_t library_plane(uint32_t code, uint32_t exponent, bool up)
{
    uint32_t units = code & UNITS, sign = code >> 17, down = 0, own = 0, fraction = 0;
    bool outward = up == !sign;
    if (units == 0 && outward) {
        own = exponent > 17 ? exponent - 17 : 0;
        fraction = 0x7FFFFF;
    } else if (units) {
        while (!(units >> (16 - down) & 1))
            down++;
        down = down < exponent ? down : exponent;
        own = exponent - down;
        uint32_t trail = outward && own < 0xFF ? (1u << (7 + down)) - 1 : 0;
        fraction = (units << (7 + down) | trail) & 0x7FFFFF;
    }
    return fraction | own << 23 | sign << 31;
}

static bool library_holds(uint32_t number, uint32_t exponent)
{
    uint32_t code = library_code(number, exponent);
    float x = float_from_bits(number);
    return float_from_bits(library_plane(code, exponent, false)) <= x &&
           float_from_bits(library_plane(code, exponent, true)) >= x;
}

/* Every exponent with every shared one that is as large, fractions about each cut; and every
 * fraction of a few. Nothing is cut that is not subnormal. */
static void the_library_holds_what_is_normal(void **state)
{
    (void)state;
    for (uint32_t shared = 1; shared < 255; shared++)
        for (uint32_t own = 1; own <= shared; own++)
            for (uint32_t cut = 0; cut <= 23; cut++)
                for (uint32_t near = 0; near < 6; near++) {
                    uint32_t fraction = ((1u << cut) - 3 + near) & 0x7FFFFF;
                    assert_true(library_holds(own << 23 | fraction, shared));
                    assert_true(library_holds(1u << 31 | own << 23 | fraction, shared));
                }
    for (uint32_t fraction = 0; fraction < 0x800000; fraction++)
        for (uint32_t down = 0; down < 24; down += 5) {
            assert_true(library_holds((127 - down) << 23 | fraction, 127));
            assert_true(library_holds(1u << 31 | (127 - down) << 23 | fraction, 127));
        }
    for (uint32_t shared = 0; shared < 255; shared++) /* zeros of both signs */
        assert_true(library_holds(0, shared) && library_holds(1u << 31, shared));
}

/* The least node that it cuts: the point 2^-143, whose lower bound is read as 2^-142. */
static void the_library_doubles_subnormals(void **state)
{
    (void)state;
    uint32_t least = 1;
    while (library_holds(least, 0))
        least++;
    assert_int_equal(least, 64);
    assert_int_equal(library_plane(library_code(64, 0), 0, false), 128);
    for (uint32_t shared = 0; shared < 16; shared++) /* beside what is normal, too */
        assert_false(library_holds(0x400000, shared));
    for (uint32_t number = 1; number < 0x800000; number += 77)
        assert_true(library_holds(number, 16) && library_holds(number, 43));
}

/* Coordinates reach to 2^126, on each axis and side, and not beyond. */
static void coordinates_are_within_2_to_126(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 18; i++) {
        struct scene scene = trees_grid(3);
        struct packed packed;
        struct reason reason = {""};
        const bool beyond = i >= 9;
        const float most = beyond ? nextafterf(0x1p126f, INFINITY) : 0x1p126f;
        scene.vertex[3 * (i % 9) + i % 3] = i % 2 ? -most : most;
        struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
        const enum status status =
            packed_make(layout_find("hpb64"), &bvh, &scene, &packed, &reason);
        assert_int_equal(status, beyond ? STATUS_LIMIT : STATUS_OK);
        if (!status)
            packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Where no bound is 0 and the exponents are as large as ours must be, the words of bounds are the
 * library's. */
static void codes_are_those_of_the_library(void **state)
{
    (void)state;
    struct rng rng = rng_make(32, 0);
    struct packed packed = leaves("hpb64", CHILDREN);
    for (int round = 0; round < 3000; round++) {
        struct box box[CHILDREN];
        uint32_t shared = 0;
        for (uint32_t s = 0; s < CHILDREN; s++)
            for (int k = 0; k < 3; k++) {
                float a = rng_range(&rng, -1, 1), b = rng_range(&rng, -1, 1);
                a = ldexpf(a, (int)rng_below(&rng, 30));
                b = ldexpf(b, (int)rng_below(&rng, 30));
                box[s].lo[k] = fminf(a, b);
                box[s].hi[k] = fmaxf(a, b);
            }
        assert_int_equal(write_boxes(&packed, box, CHILDREN), STATUS_OK);
        for (uint32_t k = 0; k < 3; k++, shared = 0) {
            for (uint32_t s = 0; s < CHILDREN; s++) {
                uint32_t lo = float_bits(box[s].lo[k]) >> 23 & 0xFF;
                uint32_t hi = float_bits(box[s].hi[k]) >> 23 & 0xFF;
                shared = lo > shared ? lo : shared;
                shared = hi > shared ? hi : shared;
            }
            assert_int_equal(bits(packed.word, 56 + 8 * k, 8), shared);
            for (uint32_t s = 0; s < CHILDREN; s++) {
                assert_int_equal(code_of(packed.word, s, k),
                                 library_code(float_bits(box[s].lo[k]), shared));
                assert_int_equal(code_of(packed.word, s, 3 + k),
                                 library_code(float_bits(box[s].hi[k]), shared));
            }
        }
    }
    packed_free(&packed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_lie_where_they_are_published),
        cmocka_unit_test(any_boxes_are_held_as_closely_as_can_be),
        cmocka_unit_test(every_slot_has_the_first_and_the_last_code),
        cmocka_unit_test(the_library_holds_what_is_normal),
        cmocka_unit_test(the_library_doubles_subnormals),
        cmocka_unit_test(coordinates_are_within_2_to_126),
        cmocka_unit_test(codes_are_those_of_the_library),
    };
    return cmocka_run_group_tests_name("hpb64", tests, NULL, NULL);
}

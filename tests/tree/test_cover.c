/* The exact check of split trees: cover_meets against exact clipping, cover_check against trees
 * that are right, and wrong by one ulp, one item, one plane. */
#include "ref/tree/cover.h"
#include "ref/tree/cover_exact.h"
#include "ref/tree/bvh.h"
#include "ref/base/rng.h"
#include "tests/support/counted.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- a second way: polygons clipped in fractions -----------------------------------------------
 */

/* Small whole coordinates, so that clipping is exact in fractions of 64-bit integers. */
#define RANGE 4

struct cover_fraction {
    __int128 num, den; /* den > 0 */
};

struct corner {
    struct cover_fraction x[3];
};

static __int128 gcd(__int128 a, __int128 b)
{
    a = a < 0 ? -a : a;
    while (b) {
        __int128 rest = a % b;
        a = b;
        b = rest;
    }
    return a ? a : 1;
}

static struct cover_fraction reduced(__int128 num, __int128 den)
{
    __int128 by = gcd(num, den);
    return (struct cover_fraction){num / by, den / by};
}

/* Sign of x - side. */
static int against(struct cover_fraction x, int side)
{
    __int128 d = x.num - side * x.den;
    return (d > 0) - (d < 0);
}

/* Where the edge from a to b, on different sides, crosses x[k] = side. */
static struct corner crossing(const struct corner *a, const struct corner *b, int k, int side)
{
    struct corner out;
    /* s = (side - a) / (b - a), as n / d */
    __int128 n = (side * a->x[k].den - a->x[k].num) * b->x[k].den;
    __int128 d = b->x[k].num * a->x[k].den - a->x[k].num * b->x[k].den;
    if (d < 0) {
        n = -n;
        d = -d;
    }
    struct cover_fraction s = reduced(n, d);
    for (int i = 0; i < 3; i++) {
        struct cover_fraction p = a->x[i], q = b->x[i];
        struct cover_fraction way = reduced(q.num * p.den - p.num * q.den, p.den * q.den);
        struct cover_fraction step = reduced(way.num * s.num, way.den * s.den);
        out.x[i] = reduced(p.num * step.den + step.num * p.den, p.den * step.den);
    }
    return out;
}

/* Keeps what is on the side of x[k] = side that `sign` says, the plane included. */
static int clip(const struct corner *from, int count, int k, int side, int sign, struct corner *to)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const struct corner *a = &from[i], *b = &from[(i + 1) % count];
        int at_a = sign * against(a->x[k], side), at_b = sign * against(b->x[k], side);
        if (at_a >= 0)
            to[kept++] = *a;
        if (at_a * at_b < 0)
            to[kept++] = crossing(a, b, k, side);
    }
    return kept;
}

/* Whether the triangle meets the part: what is left inside the closed box must not lie in the plane
 * of an open side altogether. */
static bool meets_by_clipping(const int v[3][3], const int lo[3], const int hi[3], unsigned open)
{
    struct corner polygon[2][12];
    int count = 3, now = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            polygon[0][c].x[k] = (struct cover_fraction){v[c][k], 1};
    for (int k = 0; k < 3; k++)
        for (int high = 0; high < 2; high++) {
            count =
                clip(polygon[now], count, k, high ? hi[k] : lo[k], high ? -1 : 1, polygon[1 - now]);
            now = 1 - now;
        }
    bool meets = count > 0;
    for (int k = 0; k < 3; k++)
        for (int high = 0; high < 2; high++) {
            bool within = !(open & (high ? COVER_OPEN_HI(k) : COVER_OPEN_LO(k)));
            for (int i = 0; i < count; i++)
                within |= against(polygon[now][i].x[k], high ? hi[k] : lo[k]) != 0;
            meets &= within;
        }
    return meets;
}

static int small(struct rng *rng)
{
    return (int)rng_below(rng, 2 * RANGE + 1) - RANGE;
}

/* Coordinates times `scale` plus `shift`, which must be exact. */
static void meets_as_clipping_says(float scale, float shift)
{
    struct rng rng = rng_make(5, 0);
    int met = 0;

    for (int n = 0; n < 60000; n++) {
        int v[3][3], lo[3], hi[3];
        float f[3][3];
        unsigned open = rng_below(&rng, 2) ? rng_below(&rng, 64) : 0;
        struct cover_part part = {.open = open};
        for (int k = 0; k < 3; k++) {
            int a = small(&rng), b = small(&rng);
            lo[k] = a < b ? a : b;
            hi[k] = a < b ? b : a;
            part.box.lo[k] = (float)lo[k] * scale + shift;
            part.box.hi[k] = (float)hi[k] * scale + shift;
            for (int c = 0; c < 3; c++) {
                v[c][k] = n % 7 == 0 && c == 2 ? v[n % 2][k] : small(&rng); /* some have no area */
                f[c][k] = (float)v[c][k] * scale + shift;
            }
        }
        bool empty = cover_part_empty(&part);
        bool expected = !empty && meets_by_clipping((const int(*)[3])v, lo, hi, open);
        if (cover_meets(f, &part) != expected)
            fail_msg("pair %d: meets is %d", n, !expected);
        met += expected;
    }
    assert_in_range(met, 5000, 55000);
}

static void cover_meets_as_clipping_says(void **state)
{
    (void)state;
    meets_as_clipping_says(1, 0);
    meets_as_clipping_says(0x1p-149f, 0);
    meets_as_clipping_says(0x1p125f, 0);
    meets_as_clipping_says(0x1p-20f, 1);
    for (float scale = 0x1p-130f; scale < 0x1p-124f; scale *= 2) /* small ones are subnormal */
        meets_as_clipping_says(scale, 0);
}

/* Slivers far below the double's resolution: a plane through large and tiny coordinates. */
static void cover_meets_decides_what_double_cannot(void **state)
{
    (void)state;
    unsigned long long before = cover_integers();
    for (int side = -1; side <= 1; side++) {
        /* The triangle x + y + z = 2^100, and a box whose corner is there, or one ulp aside. */
        float far = 0x1p100f, tiny = 0x1p-149f;
        float v[3][3] = {{far, 0, 0}, {0, far, 0}, {0, 0, far}};
        struct cover_part part = {.box = {{0, 0, 0}, {far / 2, far / 4, far / 4}}};
        if (side < 0)
            part.box.hi[0] = nextafterf(far / 2, 0);
        if (side > 0)
            part.box.hi[0] = nextafterf(far / 2, far);
        assert_int_equal(cover_meets(v, &part), side >= 0);
        part.open = COVER_OPEN_HI(1);
        assert_int_equal(cover_meets(v, &part), side > 0);
        /* x + y = 0 but for the last bit of a sum that no double holds. */
        float w[3][3] = {{far, -far, 0}, {-far, far, 0}, {far, -far, 1}};
        struct cover_part thin = {.box = {{tiny, tiny * (float)side, 0}, {1, 1, 1}}};
        thin.box.lo[1] = side < 0 ? -tiny : side == 0 ? 0 : tiny;
        assert_int_equal(cover_meets(w, &thin), side < 0);
    }
    assert_true(cover_integers() > before);
}

/* A wall through the origin and the corner of a box beside it, nearer than doubles of the size of
 * the wall's ends can tell. */
static void cover_meets_is_never_misled_by_rounding(void **state)
{
    (void)state;
    struct rng rng = rng_make(6, 0);
    for (int n = 0; n < 5000; n++) {
        int64_t x = 0x800000 + rng_below(&rng, 0x7FFFFE), y = 0x800000 + rng_below(&rng, 0x7FFFFE);
        int64_t cx = x + rng_below(&rng, 3) - 1, cy = y + rng_below(&rng, 3) - 1;
        float far = 0x1p36f, large = 0x1p30f;
        float v[3][3] = {{far * (float)x, far * (float)y, 0},
                         {-far * (float)x, -far * (float)y, 0},
                         {-far * (float)x, -far * (float)y, 1}};
        struct cover_part part = {.box = {{(float)cx, -large, 0}, {large, (float)cy, 0}}};
        int64_t side = x * cy - y * cx;
        assert_int_equal(cover_meets(v, &part), side >= 0);
        part.open = COVER_OPEN_LO(0);
        assert_int_equal(cover_meets(v, &part), side > 0);
    }
}

/* --- trees -------------------------------------------------------------------------------------
 */

/* A triangle cut at x = 1 into two leaves whose boxes are as small as they may be, and another. */
struct cover_cut {
    struct scene scene;
    struct bvh_node node[5];
    uint32_t prim[3];
    struct bvh bvh;
};

static void cut_make(struct cover_cut *cut)
{
    const float v[6][3] = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {5, 5, 1}, {6, 5, 1}, {5, 6, 1}};
    assert_int_equal(scene_make(6, 2, &cut->scene), STATUS_OK);
    memcpy(cut->scene.vertex, v, sizeof v);
    for (uint32_t i = 0; i < 6; i++)
        cut->scene.index[i] = i;
    const struct bvh_node node[5] = {{{{0, 0, 0}, {6, 6, 1}}, 1, 4, 0, 0},
                                     {{{0, 0, 0}, {3, 3, 0}}, 2, 3, 0, 0},
                                     {{{0, 0, 0}, {1, 3, 0}}, 0, 0, 0, 1},
                                     {{{1, 0, 0}, {3, 2, 0}}, 0, 0, 1, 1},
                                     {{{5, 5, 1}, {6, 6, 1}}, 0, 0, 2, 1}};
    memcpy(cut->node, node, sizeof node);
    cut->prim[0] = cut->prim[1] = 0;
    cut->prim[2] = 1;
    cut->bvh = (struct bvh){cut->node, cut->prim, 5, 3, 2};
}

static void cover_accepts_a_triangle_that_is_cut(void **state)
{
    (void)state;
    struct cover_cut cut;
    struct reason reason = {""};
    cut_make(&cut);
    if (bvh_check(&cut.bvh, &cut.scene, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(bvh_counted(&cut.bvh, &cut.scene).loose_count, 0);
    /* Boxes may be larger, and overlap. */
    cut.node[2].bounds.hi[0] = 2;
    assert_int_equal(bvh_check(&cut.bvh, &cut.scene, NULL), STATUS_OK);
    scene_free(&cut.scene);
}

/* Every bound of the two parts, and of the nodes above them, moved inward by one ulp. */
static void cover_finds_every_box_that_is_one_ulp_too_small(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 4; n++)
        for (int k = 0; k < 6; k++) {
            struct cover_cut cut;
            struct reason reason = {""};
            cut_make(&cut);
            struct box *box = &cut.node[n].bounds;
            float *bound = k < 3 ? &box->lo[k] : &box->hi[k - 3];
            *bound = nextafterf(*bound, k < 3 ? INFINITY : -INFINITY);
            /* The other triangle alone reaches the root's upper bounds. */
            uint32_t prim = n == 0 && k >= 3 ? 1 : 0;
            char expected[64];
            (void)snprintf(expected, sizeof expected, "a part of triangle %u is in no leaf", prim);
            if (bvh_check(&cut.bvh, &cut.scene, &reason) != STATUS_INPUT ||
                !strstr(reason.text, expected))
                fail_msg("node %u, bound %d: '%s'", n, k, reason.text);
            scene_free(&cut.scene);
        }
}

static void cover_names_the_node_above_the_gap(void **state)
{
    (void)state;
    struct cover_cut cut;
    struct reason reason = {""};
    cut_make(&cut);
    cut.node[3].bounds.lo[0] = nextafterf(1, 2);
    assert_int_equal(bvh_check(&cut.bvh, &cut.scene, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "tree node 1: a part of triangle 0"));
    assert_non_null(strstr(reason.text, "1 triangles have such parts"));
    scene_free(&cut.scene);
}

static void cover_finds_a_reference_that_is_dropped(void **state)
{
    (void)state;
    struct cover_cut cut;
    struct reason reason = {""};
    cut_make(&cut);
    cut.prim[1] = 1; /* the second part's leaf has the other triangle */
    assert_int_equal(bvh_check(&cut.bvh, &cut.scene, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "a part of triangle 0"));
    cut.prim[0] = cut.prim[1] = 1; /* no leaf has triangle 0 */
    assert_int_equal(bvh_check_form(&cut.bvh, &cut.scene, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "triangle 0 is in no leaf"));
    scene_free(&cut.scene);
}

static void cover_refuses_a_triangle_twice_in_a_leaf(void **state)
{
    (void)state;
    struct cover_cut cut;
    struct reason reason = {""};
    cut_make(&cut);
    cut.node[1] = (struct bvh_node){cut.node[1].bounds, 0, 0, 0, 2};
    cut.node[2] = cut.node[4];
    cut.node[0].snd = 2;
    cut.bvh.node_count = 3;
    assert_int_equal(bvh_check_form(&cut.bvh, &cut.scene, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "triangle 0 is there twice"));
    scene_free(&cut.scene);
}

/* A NaN bound has nothing in it, wherever it stands. */
static void cover_of_a_nan_box_is_nothing(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 4; n++)
        for (int k = 0; k < 6; k++) {
            struct cover_cut cut;
            cut_make(&cut);
            struct box *box = &cut.node[n].bounds;
            *(k < 3 ? &box->lo[k] : &box->hi[k - 3]) = NAN;
            assert_int_equal(bvh_check(&cut.bvh, &cut.scene, NULL), STATUS_INPUT);
            scene_free(&cut.scene);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cover_meets_as_clipping_says),
        cmocka_unit_test(cover_meets_decides_what_double_cannot),
        cmocka_unit_test(cover_meets_is_never_misled_by_rounding),
        cmocka_unit_test(cover_accepts_a_triangle_that_is_cut),
        cmocka_unit_test(cover_finds_every_box_that_is_one_ulp_too_small),
        cmocka_unit_test(cover_names_the_node_above_the_gap),
        cmocka_unit_test(cover_finds_a_reference_that_is_dropped),
        cmocka_unit_test(cover_refuses_a_triangle_twice_in_a_leaf),
        cmocka_unit_test(cover_of_a_nan_box_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Laws of nodes that quantise: the axis of a node is the finest that holds it and all its planes
 * are exact; amd64 has float32 in exactly the nodes where float16 is refused or adds more than a
 * quarter of area; and the bounds of children are the closest that can be written, after a refit as
 * when packed. */
#include "ref/base/half.h"
#include "ref/base/rng.h"
#include "ref/layouts/wide_nodes.h"
#include "ref/packed/refit.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/tree_fixture.h"

#include <math.h>

#define PLANE_BITS     24
#define EXPONENT_LEAST (-100)

/* Whether planes 0 to `most`, 2^exponent apart, can reach from lo to hi with all of them in
 * float32. */
static bool axis_fits(float lo, float hi, uint32_t most, int exponent)
{
    double first = floor(ldexp((double)lo, -exponent));
    return fabs(first) <= ldexp(1, PLANE_BITS - 1) &&
           ceil(ldexp((double)hi, -exponent)) - first <= most;
}

static void check_axis(float lo, float hi, uint32_t most)
{
    const struct node_axis axis = node_axis_make(lo, hi, most);
    const double first = ldexp((double)axis.origin, -axis.exponent);
    if (first != floor(first) || fabs(first) > ldexp(1, PLANE_BITS - 1))
        fail_msg("[%a, %a], %u planes: origin %a is not a plane of 2^%d", (double)lo, (double)hi,
                 most, (double)axis.origin, axis.exponent);
    for (uint32_t q = 0; q <= most; q++)
        if ((double)node_axis_plane(&axis, q) != ldexp(first + q, axis.exponent))
            fail_msg("[%a, %a]: plane %u of %u is rounded", (double)lo, (double)hi, q, most);
    if (node_axis_plane(&axis, 0) > lo || node_axis_plane(&axis, most) < hi)
        fail_msg("[%a, %a]: outside the %u planes", (double)lo, (double)hi, most);
    if (axis.exponent > EXPONENT_LEAST && axis_fits(lo, hi, most, axis.exponent - 1))
        fail_msg("[%a, %a]: 2^%d is finer than 2^%d, and fits %u planes", (double)lo, (double)hi,
                 axis.exponent - 1, axis.exponent, most);
    if (signbit(axis.origin) && axis.origin == 0)
        fail_msg("[%a, %a]: the origin is -0", (double)lo, (double)hi);
}

static void the_axis_is_the_finest_that_holds_the_node(void **state)
{
    (void)state;
    struct rng rng = rng_make(16, 0);
    static const uint32_t most[] = {2, 15, 127, 255};
    for (int round = 0; round < 200000; round++) {
        int exponent = (int)rng_below(&rng, 230) - 130;
        float size = ldexpf(rng_range(&rng, 0.5f, 1), exponent);
        float far = ldexpf(size, (int)rng_below(&rng, 60) - 20);
        float lo = fminf(far, NODE_AXIS_LARGEST / 2), hi = lo;
        switch (rng_below(&rng, 4)) {
        case 0:
            hi = lo + fminf(size, NODE_AXIS_LARGEST / 2);
            break;
        case 1:
            lo = -lo;
            break;
        case 2:
            lo = -fminf(size, NODE_AXIS_LARGEST);
            break;
        default:
            lo = -hi, hi = nextafterf(lo, 0);
            break;
        }
        check_axis(lo, hi, most[rng_below(&rng, ARRAY_COUNT(most))]);
    }
    for (uint32_t i = 0; i < ARRAY_COUNT(most); i++) {
        check_axis(0, 0, most[i]);
        check_axis(-0.0f, 0x1p-149f, most[i]);
        check_axis(-NODE_AXIS_LARGEST, NODE_AXIS_LARGEST, most[i]);
        check_axis(0x1p23f, 0x1p23f + 1, most[i]);
        check_axis(-0x1p23f - 2, -0x1p23f, most[i]);
    }
}

/* The exact box of what lies below a reference. */
static struct box exact_box(const struct packed *packed, const struct scene *scene, uint32_t ref)
{
    struct wide node;
    struct box all = box_empty();
    packed->layout->load(packed, ref, &node);
    for (uint32_t i = 0; i < node.item_count; i++) {
        struct box one = scene_tri_bounds(scene, packed_item(packed, &node, i));
        box_add_box(&all, &one);
    }
    for (uint32_t c = 0; c < node.child_count; c++) {
        struct box one = exact_box(packed, scene, node.child[c]);
        box_add_box(&all, &one);
    }
    return all;
}

static struct box in_half(const struct box *box, bool *finite)
{
    struct box out;
    for (int k = 0; k < 3; k++) {
        out.lo[k] = half_to_float(half_down(box->lo[k]));
        out.hi[k] = half_to_float(half_up(box->hi[k]));
        *finite = *finite && isfinite(out.lo[k]) && isfinite(out.hi[k]);
    }
    return out;
}

static bool same_box(const struct box *a, const struct box *b)
{
    for (int k = 0; k < 3; k++)
        if (a->lo[k] != b->lo[k] || a->hi[k] != b->hi[k])
            return false;
    return true;
}

/* Returns how many nodes below `ref` are of float16 and of float32. */
static void check_choice(const struct packed *packed, const struct scene *scene, uint32_t ref,
                         uint32_t count[2])
{
    struct wide node;
    struct box exact[WIDE_MAX], half[WIDE_MAX];
    double area16 = 0, area32 = 0;
    bool finite = true, lossless = true;
    packed->layout->load(packed, ref, &node);
    if (node.child_count == 0)
        return;
    for (uint32_t c = 0; c < node.child_count; c++) {
        exact[c] = exact_box(packed, scene, node.child[c]);
        half[c] = in_half(&exact[c], &finite);
        lossless = lossless && same_box(&exact[c], &half[c]);
        area16 += box_half_area(&half[c]);
        area32 += box_half_area(&exact[c]);
    }
    const bool f32 = ref == packed->root || !finite || area16 > 1.25 * area32;
    for (uint32_t c = 0; c < node.child_count; c++)
        if (!same_box(&node.box[c], f32 ? &exact[c] : &half[c]))
            fail_msg("child %u of node %u is not of %s: areas %a and %a", c, ref,
                     f32 ? "float32" : "float16", area16, area32);
    if (!lossless)
        count[f32]++;
    for (uint32_t c = 0; c < node.child_count; c++)
        check_choice(packed, scene, node.child[c], count);
}

static void amd64_takes_float32_where_float16_inflates(void **state)
{
    (void)state;
    struct rng rng = rng_make(17, 0);
    uint32_t count[2] = {0, 0};
    for (int round = 0; round < 60; round++) {
        struct scene scene = trees_grid(20 + rng_below(&rng, 100));
        float centre[3], size = ldexpf(1, -(int)rng_below(&rng, 10));
        for (int k = 0; k < 3; k++) /* one axis in four is far off, one beyond float16 */
            centre[k] = round % 10 == k ? 70000 : rng_below(&rng, 4) ? 0 : rng_range(&rng, 1, 200);
        for (uint32_t i = 0; i < 9 * scene.tri_count; i++)
            scene.vertex[i] = centre[i % 3] + rng_range(&rng, 0, size) + (float)(i / 90) * size;
        struct bvh bvh = trees_make(&scene, 1 + rng_below(&rng, 4), TREES_BALANCED);
        struct packed packed;
        struct reason reason = {""};
        if (packed_make(layout_find("amd64"), &bvh, &scene, &packed, &reason))
            fail_msg("%s", reason.text);
        check_choice(&packed, &scene, packed.root, count);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
    assert_true(count[0] > 200 && count[1] > 200);
}

/* --- children --------------------------------------------------------------------------------- */

/* How a layout writes bounds: planes of a frame, or 0: float32 or float16. `apart`: the last plane
 * is no lower bound, and the first no upper one. */
struct written_as {
    const char *layout;
    uint32_t planes;
    bool half, apart;
};

static const struct written_as written[] = {
    {"cwbvh80", 255, .half = false},  {"tiny8", 63, .half = false}, {"tiny8_l8", 63, .half = false},
    {"tiny8_l14", 63, .half = false}, {"half4", 0, .half = true},   {"f32", 0, .half = false},
    {"gfx12", 4096, .apart = true},   {"obb8", 255, .half = false},
};

/* The numbers of float16 that are no subnormals, from the least on. */
static uint32_t normal_halves(float out[1 << 16])
{
    uint32_t count = 0;
    for (uint32_t bits = 0xFBFF; bits >= 0x8400; bits--)
        out[count++] = half_to_float((struct half){(uint16_t)bits});
    out[count++] = 0;
    for (uint32_t bits = 0x0400; bits <= 0x7BFF; bits++)
        out[count++] = half_to_float((struct half){(uint16_t)bits});
    return count;
}

/* The largest of ascending numbers that is at most x, or the least that is at least x. */
static float closest(const float *number, uint32_t count, float x, bool up)
{
    uint32_t below = 0, above = count; /* number[below] <= x < number[above] */
    assert_true(number[0] <= x && x <= number[count - 1]);
    while (above - below > 1) {
        uint32_t middle = below + (above - below) / 2;
        if (number[middle] <= x)
            below = middle;
        else
            above = middle;
    }
    return number[up && number[below] < x ? above : below];
}

/* Returns how many bounds were rounded. */
static uint32_t check_children(const struct packed *packed, const struct scene *scene, uint32_t ref,
                               const struct written_as *as)
{
    static float number[1 << 16];
    struct wide node;
    struct box exact[WIDE_MAX], all = box_empty();
    uint32_t rounded = 0;
    packed->layout->load(packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++) {
        exact[c] = exact_box(packed, scene, node.child[c]);
        box_add_box(&all, &exact[c]);
    }
    for (int k = 0; k < 3 && node.child_count; k++) {
        uint32_t count = as->half ? normal_halves(number) : 0;
        if (as->planes) {
            const struct node_axis axis = node_axis_make(all.lo[k], all.hi[k], as->planes);
            for (count = 0; count <= as->planes; count++)
                number[count] = node_axis_plane(&axis, count);
        }
        for (uint32_t c = 0; c < node.child_count; c++) {
            float lo = exact[c].lo[k], hi = exact[c].hi[k];
            float low = count ? closest(number, count, lo, false) : lo;
            float high = count ? closest(number, count, hi, true) : hi;
            if (as->apart && low == number[count - 1])
                low = number[count - 2];
            if (as->apart && high == number[0])
                high = number[1];
            if (node.box[c].lo[k] != low || node.box[c].hi[k] != high)
                fail_msg("%s: child %u of node %u: [%a, %a] is written as [%a, %a]", as->layout, c,
                         ref, (double)lo, (double)hi, (double)node.box[c].lo[k],
                         (double)node.box[c].hi[k]);
            rounded += (uint32_t)(low != lo) + (uint32_t)(high != hi);
        }
    }
    for (uint32_t c = 0; c < node.child_count; c++)
        rounded += check_children(packed, scene, node.child[c], as);
    return rounded;
}

static void put_vertices(struct rng *rng, struct scene *scene)
{
    float centre[3], size = ldexpf(1, (int)rng_below(rng, 12) - 10);
    for (int k = 0; k < 3; k++)
        centre[k] = rng_below(rng, 4) ? 0 : rng_range(rng, -200, 200);
    for (uint32_t i = 0; i < 9 * scene->tri_count; i++)
        scene->vertex[i] = centre[i % 3] + rng_range(rng, 0, size) + (float)(i / 90) * size;
}

static void bounds_of_children_are_the_closest(void **state)
{
    (void)state;
    struct rng rng = rng_make(18, 0);
    for (size_t n = 0; n < ARRAY_COUNT(written); n++) {
        uint32_t rounded = 0;
        for (int round = 0; round < 12; round++) {
            struct scene scene = trees_grid(20 + rng_below(&rng, 60));
            put_vertices(&rng, &scene);
            struct bvh bvh = trees_make(&scene, 1 + rng_below(&rng, 3), TREES_BALANCED);
            struct packed packed;
            struct reason reason = {""};
            if (packed_make(layout_find(written[n].layout), &bvh, &scene, &packed, &reason))
                fail_msg("%s", reason.text);
            rounded += check_children(&packed, &scene, packed.root, &written[n]);
            put_vertices(&rng, &scene);
            if (packed.layout->rebound && packed_refit(&packed, &scene, &reason))
                fail_msg("%s", reason.text);
            if (packed.layout->rebound)
                rounded += check_children(&packed, &scene, packed.root, &written[n]);
            packed_free(&packed);
            bvh_free(&bvh);
            scene_free(&scene);
        }
        assert_true((rounded > 1000) == (written[n].planes || written[n].half));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_axis_is_the_finest_that_holds_the_node),
        cmocka_unit_test(amd64_takes_float32_where_float16_inflates),
        cmocka_unit_test(bounds_of_children_are_the_closest),
    };
    return cmocka_run_group_tests_name("nodes_tight", tests, NULL, NULL);
}

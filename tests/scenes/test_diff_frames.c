/* Two frames made by hand: what is counted, what is allowed, what comes first. */
#include "scenes/render/diff_frames.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define WIDTH   3u
#define HEIGHT  2u
#define PIXELS  (WIDTH * HEIGHT)
#define BOUNCES 3u

/* A picture whose arrays are its own. */
struct frames_made {
    uint32_t pixel[PIXELS];
    float color[3 * PIXELS], bound[PIXELS];
    struct segment segment[PIXELS * BOUNCES];
    struct frame frame;
};

/* Every path hits triangle 7 + i at i + 1, is asked by two lights and shadowed to the second, then
 * leaves the scene; every pixel is 100 grey, 0.25 of a step above the border below it. */
static void make(struct frames_made *out)
{
    memset(out, 0, sizeof *out);
    out->frame = (struct frame){out->pixel, out->color, out->bound, out->segment};
    for (uint32_t i = 0; i < PIXELS; i++) {
        struct segment *path = out->segment + i * BOUNCES;
        path[0] = (struct segment){(float)(i + 1), 7 + i, 3, 2};
        path[1] = (struct segment){0, ABI_NO_PRIM, 0, 0};
        path[2] = (struct segment){0, ABI_NO_SEGMENT, 0, 0};
        out->pixel[i] = 100u | 100u << 8 | 100u << 16 | 255u << 24;
        for (int k = 0; k < 3; k++)
            out->color[3 * i + (uint32_t)k] = 99.75f / 255.0f;
    }
}

static struct frames_made a, b;

static struct frame_diff compare(void)
{
    return frame_compare(&a.frame, &b.frame, WIDTH, HEIGHT, BOUNCES);
}

static int both(void **state)
{
    (void)state;
    make(&a);
    make(&b);
    return 0;
}

static void equal_frames_differ_in_nothing(void **state)
{
    (void)state;
    struct frame_diff diff = compare();
    assert_int_equal(diff.paths, PIXELS);
    assert_int_equal(diff.segments, 2 * PIXELS);
    assert_int_equal(diff.paths_apart, 0);
    assert_int_equal(diff.field[PATH_SAME], 2 * PIXELS);
    assert_int_equal(diff.first[PATH_SAME], PIXELS);
    for (enum path_field field = PATH_PRIM; field < PATH_FIELD_COUNT; field++)
        assert_int_equal(diff.field[field] + diff.first[field], 0);
    assert_int_equal(diff.colours + diff.allowed + diff.excess + diff.largest, 0);
}

static void every_member_of_a_segment_counts(void **state)
{
    (void)state;
    b.segment[0 * BOUNCES].prim = 8;
    b.segment[1 * BOUNCES].t = nextafterf(a.segment[1 * BOUNCES].t, 0);
    b.segment[2 * BOUNCES].asked = 1;
    b.segment[3 * BOUNCES].shadowed = 0;
    struct frame_diff diff = compare();
    assert_int_equal(diff.paths_apart, 4);
    for (enum path_field field = PATH_PRIM; field < PATH_FIELD_COUNT; field++) {
        uint32_t segment = 9;
        size_t path = (size_t)field - PATH_PRIM;
        assert_int_equal(diff.field[field], 1);
        assert_int_equal(diff.first[field], 1);
        assert_int_equal(
            path_first(a.segment + path * BOUNCES, b.segment + path * BOUNCES, BOUNCES, &segment),
            field);
        assert_int_equal(segment, 0);
    }
    assert_int_equal(diff.field[PATH_SAME], 2 * PIXELS - 4);
}

static void the_first_difference_is_the_first(void **state)
{
    (void)state;
    uint32_t segment = 0;
    b.segment[1] = (struct segment){3, 9, 1, 1};
    assert_int_equal(path_first(a.segment, b.segment, BOUNCES, &segment), PATH_PRIM);
    assert_int_equal(segment, 1);
    b.segment[0].shadowed = 3;
    assert_int_equal(path_first(a.segment, b.segment, BOUNCES, &segment), PATH_SHADOWED);
    assert_int_equal(segment, 0);
    struct frame_diff diff = compare();
    assert_int_equal(diff.first[PATH_SHADOWED], 1);
    assert_int_equal(diff.first[PATH_PRIM], 0);
    assert_int_equal(diff.field[PATH_PRIM], 1);
}

static void zero_has_two_signs(void **state)
{
    (void)state;
    a.segment[0].t = 0.0f;
    b.segment[0].t = -0.0f;
    assert_int_equal(compare().field[PATH_T], 1);
}

static void a_nan_is_its_bits(void **state)
{
    (void)state;
    a.segment[0].t = b.segment[0].t = float_from_bits(0x7FC00000u);
    assert_int_equal(compare().field[PATH_T], 0);
    b.segment[0].t = float_from_bits(0x7FC00001u);
    assert_int_equal(compare().field[PATH_T], 1);
}

static void one_path_is_longer(void **state)
{
    (void)state;
    uint32_t segment = 0;
    b.segment[1].prim = ABI_NO_SEGMENT; /* ended by its mirror, not by a miss */
    b.segment[2] = (struct segment){5, 5, 5, 5};
    assert_int_equal(path_first(a.segment, b.segment, BOUNCES, &segment), PATH_PRIM);
    assert_int_equal(segment, 1);
    struct frame_diff diff = compare();
    assert_int_equal(diff.segments, 2 * PIXELS); /* what stands behind an end is not read */
    assert_int_equal(diff.field[PATH_PRIM], 1);
    b.segment[1] = a.segment[1];
    b.segment[2] = (struct segment){5, 5, 0, 0};
    diff = compare();
    assert_int_equal(diff.segments, 2 * PIXELS + 1);
    assert_int_equal(diff.paths_apart, 1);
}

static void no_segment_no_difference(void **state)
{
    (void)state;
    uint32_t segment = 3;
    struct frame_diff diff = frame_compare(&a.frame, &b.frame, WIDTH, HEIGHT, 0);
    assert_int_equal(diff.segments + diff.paths_apart, 0);
    assert_int_equal(path_first(a.segment, b.segment, 0, &segment), PATH_SAME);
}

static uint32_t grey(unsigned level)
{
    return level | level << 8 | level << 16 | 255u << 24;
}

static void colours_near_a_border_are_allowed(void **state)
{
    (void)state;
    /* 99.75 becomes 100; the border below is 99.5. */
    b.pixel[0] = grey(99);
    a.bound[0] = 0.375f;
    struct frame_diff diff = compare();
    assert_int_equal(diff.colours, 1);
    assert_int_equal(diff.allowed, 1);
    assert_int_equal(diff.largest, 1);
    a.bound[0] = 0.125f; /* does not reach it */
    diff = compare();
    assert_int_equal(diff.allowed, 0);
    assert_int_equal(diff.excess, 1);
    a.bound[0] = 0.375f; /* but 100.5 it does not */
    b.pixel[0] = grey(101);
    assert_int_equal(compare().excess, 1);
    b.pixel[0] = grey(98);
    assert_int_equal(compare().excess, 1);
}

static void the_bound_is_of_whoever_has_one(void **state)
{
    (void)state;
    b.pixel[0] = grey(99);
    b.bound[0] = 0.375f;
    assert_int_equal(compare().excess, 1); /* a's is asked first */
    a.bound[0] = NAN;
    assert_int_equal(compare().allowed, 1);
    a.frame.bound = NULL;
    assert_int_equal(compare().allowed, 1);
    b.bound[0] = 0.125f; /* its own value is not even its colour's */
    assert_int_equal(compare().excess, 1);
    b.bound[0] = NAN;
    assert_int_equal(compare().excess, 1);
    b.frame.color = NULL;
    assert_int_equal(compare().excess, 1);
}

static void other_paths_have_no_bound(void **state)
{
    (void)state;
    b.pixel[0] = grey(99);
    a.bound[0] = INFINITY;
    b.segment[0].t = -1;
    struct frame_diff diff = compare();
    assert_int_equal(diff.colours, 1);
    assert_int_equal(diff.allowed + diff.excess, 0);
}

static void colours_at_the_ends(void **state)
{
    (void)state;
    const float bright[3] = {7.0f, 1.0f, 0.999f}, dark[3] = {-1.0f, NAN, 0.0f};
    const float middle[3] = {0.5f, 0.5f, 0.5f}; /* 127.5: on the border itself */
    assert_true(pixel_within(bright, 0.0f, grey(255)));
    assert_true(pixel_within(dark, 0.0f, grey(0)));
    assert_true(pixel_within(dark, 0.75f, grey(1)));
    assert_false(pixel_within(dark, 0.25f, grey(1)));
    assert_true(pixel_within(middle, 0.0f, grey(128)));
    assert_false(pixel_within(middle, 0.0f, grey(127)));
    assert_true(pixel_within(middle, 0x1p-20f, grey(127)));
    assert_true(pixel_within(middle, INFINITY, grey(3)));
    assert_false(pixel_within(middle, INFINITY, grey(3) & 0xFFFFFFu)); /* not opaque */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(equal_frames_differ_in_nothing, both),
        cmocka_unit_test_setup(every_member_of_a_segment_counts, both),
        cmocka_unit_test_setup(the_first_difference_is_the_first, both),
        cmocka_unit_test_setup(zero_has_two_signs, both),
        cmocka_unit_test_setup(a_nan_is_its_bits, both),
        cmocka_unit_test_setup(one_path_is_longer, both),
        cmocka_unit_test_setup(no_segment_no_difference, both),
        cmocka_unit_test_setup(colours_near_a_border_are_allowed, both),
        cmocka_unit_test_setup(the_bound_is_of_whoever_has_one, both),
        cmocka_unit_test_setup(other_paths_have_no_bound, both),
        cmocka_unit_test(colours_at_the_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

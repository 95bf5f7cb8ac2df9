/* Whole pictures in false colours, text and all, against pictures of scales written here: title,
 * unit, ends and legend of every show, and what a pixel without a value means, at whichever place
 * it is. */
#include "scenes/render/show_picture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH  4u
#define HEIGHT 2u
#define COUNT  (WIDTH * HEIGHT)

static const struct show_range fits = {0};

/* What is expected of a show, and of its difference. */
static const struct {
    const char *name, *unit, *none, *none_of_two;
} known[] = {
    {"t", "t", "miss", "miss in one or both"},
    {"prim", "triangle", "miss", "miss in both"},
    {"normal", "x red, y green, z blue, from -1 to 1", "miss", "miss in one or both"},
    {"boxes", "boxes tested", "miss", "miss in one or both"},
    {"triangles", "triangles tested", "miss", "miss in one or both"},
    {"depth", "stack entries", "miss", "miss in one or both"},
    {"overlap", "leaf boxes", "miss", "miss in one or both"},
    {"overlap-all", "boxes", "miss", "miss in one or both"},
    {"inflation", "surface over exact", "no box to compare", "no box to compare"},
    {"error", "error / bound", "miss, or no bound", "miss, or no bound"},
    {"class", "verdict", NULL, "miss in both"},
};

static void expect_picture(const struct show *show, bool difference, const double *value,
                           const struct colour_scale *scale, const uint32_t *pixel)
{
    struct image got, expected;
    struct colour_place place, same_place;
    struct reason reason = {""};
    if (show_picture(show, difference, value, WIDTH, HEIGHT, &fits, scale->title, &got, &place,
                     &reason) ||
        colour_picture_of(scale, pixel, WIDTH, HEIGHT, 80, &expected, &same_place, &reason))
        fail_msg("%s: %s", show->name, reason.text);
    assert_true(place.x == same_place.x && place.y == same_place.y && place.zoom == 80);
    if (got.width != expected.width || got.height != expected.height ||
        memcmp(got.pixel, expected.pixel, (size_t)4 * got.width * got.height) != 0)
        fail_msg("%s%s: another picture", show->name, difference ? ", difference" : "");
    image_free(&got);
    image_free(&expected);
}

/* Amounts: the ends are those of the numbers that are left. */
static void expect_amounts(size_t k, bool difference, const double value[COUNT],
                           struct colour_scale scale)
{
    const struct show *show = show_find(known[k].name);
    char label[80];
    uint32_t pixel[COUNT];
    double least = INFINITY, most = -INFINITY, size[COUNT];
    size_t sizes = 0;
    for (size_t i = 0; i < COUNT; i++) {
        if (isnan(value[i]))
            continue;
        least = fmin(least, value[i]);
        most = fmax(most, value[i]);
        size_t at = sizes;
        for (; value[i] != 0 && at > 0 && size[at - 1] > fabs(value[i]); at--)
            size[at] = size[at - 1];
        if (value[i] != 0) {
            size[at] = fabs(value[i]);
            sizes++;
        }
    }
    scale.kind = COLOUR_SEQUENTIAL;
    scale.lo = least;
    scale.hi = most;
    if (difference && show->planes == 1) {
        scale.kind = COLOUR_DIVERGING;
        scale.hi = size[(sizes - 1) * 9 / 10];
        snprintf(label, sizeof label, "%s (the largest 10 %% have the end colours)", scale.unit);
        scale.unit = scale.hi < fmax(most, -least) ? label : scale.unit;
    } else if (show->id == SHOW_ERROR) {
        scale.logarithmic = true;
        scale.lo = 1e-3;
        scale.hi = fmax(most, 1);
    }
    for (size_t i = 0; i < COUNT; i++)
        pixel[i] = colour_of(&scale, (float)value[i]);
    expect_picture(show, difference, value, &scale, pixel);
}

/* The value of a pixel; none of pixel `none`. */
static void fill(const double of[COUNT], size_t none, double value[COUNT])
{
    for (size_t i = 0; i < COUNT; i++)
        value[i] = i == none ? (double)NAN : of[i];
}

static struct colour_scale scale_of(size_t k, bool difference, size_t none)
{
    const char *no_data = difference ? known[k].none_of_two : known[k].none;
    return (struct colour_scale){.kind = COLOUR_IDS,
                                 .title = "scene: show, layout",
                                 .unit = known[k].unit,
                                 .no_data = none < COUNT ? no_data : NULL};
}

static void every_amount_has_its_scale(void **state)
{
    (void)state;
    static const double single[] = {3, 1, 4, 1, 5, 9, 2, 6};
    static const double small[] = {0.375, 0.015625, 0.4375, 0, 0.5, 0.875, 0.1875, 0.625};
    static const double two[] = {-3, 0, 1, -40, 5, 0, 2, -6};
    static const double even[] = {-3, 0, 6, -6, 5, 0, 2, -6}; /* none is beyond the ends */
    double value[COUNT];
    size_t amounts = 0;
    for (size_t k = 0; k < ARRAY_COUNT(known); k++) {
        const struct show *show = show_find(known[k].name);
        assert_string_equal(show->label, known[k].unit);
        for (size_t none = 0; none <= COUNT && !show->names; none++) {
            struct colour_scale scale = scale_of(k, true, none);
            if (show->planes == 3)
                scale.unit = "degrees between";
            fill(show->planes == 3 ? single : two, none, value);
            expect_amounts(k, true, value, scale);
            if (show->planes == 3)
                continue;
            fill(even, none, value);
            expect_amounts(k, true, value, scale);
            fill(single, none, value);
            expect_amounts(k, false, value, scale_of(k, false, none));
            fill(small, none, value);
            expect_amounts(k, false, value, scale_of(k, false, none));
            amounts++;
        }
    }
    assert_int_equal(amounts, 8 * (COUNT + 1));
    assert_null(shows[ARRAY_COUNT(known)].name);
}

static void normals_have_no_bar(void **state)
{
    (void)state;
    for (size_t none = 0; none <= COUNT; none++) {
        double value[3 * COUNT];
        uint32_t pixel[COUNT];
        for (size_t i = 0; i < COUNT; i++) {
            const double n[3] = {(double)i / 8 - 0.5, 1, -1};
            for (size_t c = 0; c < 3; c++)
                value[3 * i + c] = i == none ? (double)NAN : n[c];
            pixel[i] =
                i == none ? COLOUR_NO_DATA : image_rgb((unsigned)(127.5 * (n[0] + 1)), 255, 0);
        }
        struct colour_scale scale = scale_of(SHOW_NORMAL, false, none);
        expect_picture(show_find("normal"), false, value, &scale, pixel);
    }
}

static void names_have_no_bar_and_their_difference_two_classes(void **state)
{
    (void)state;
    static const double prim[] = {7, 1, 7, 3, 0, 2, 4000000000.0, 6};
    static const double apart[] = {0, 1, 0, 0, 1, 0, 1, 0};
    static const char *const class_name[] = {"the same", "different"};
    static const size_t named[] = {SHOW_PRIM, SHOW_CLASS};
    for (size_t none = 0; none <= COUNT; none++) {
        double value[COUNT];
        uint32_t pixel[COUNT];
        struct colour_scale scale = scale_of(SHOW_PRIM, false, none);
        fill(prim, none, value);
        for (size_t i = 0; i < COUNT; i++)
            pixel[i] = i == none ? COLOUR_NO_DATA : colour_of_id((uint32_t)prim[i]);
        expect_picture(show_find("prim"), false, value, &scale, pixel);
        fill(apart, none, value);
        for (size_t i = 0; i < COUNT; i++)
            pixel[i] = i == none ? COLOUR_NO_DATA : colour_of_class((size_t)apart[i]);
        for (size_t k = 0; k < ARRAY_COUNT(named); k++) {
            scale = scale_of(named[k], true, none);
            scale.kind = COLOUR_CLASSES;
            scale.class_name = class_name;
            scale.class_count = ARRAY_COUNT(class_name);
            expect_picture(show_find(known[named[k]].name), true, value, &scale, pixel);
        }
    }
}

/* Other counts of every verdict; those that share a colour are one sum. */
static void legends_count_the_verdicts(void **state)
{
    (void)state;
    static const char *const called[] = {"right",
                                         "wrong",
                                         "tie",
                                         "near tie",
                                         "boundary",
                                         "border",
                                         "slab, noise or out of contract",
                                         "in plane"};
    static const double mixed[][COUNT] = {
        {VERDICT_RIGHT, VERDICT_RIGHT, VERDICT_WRONG, VERDICT_TIE, VERDICT_TIE, VERDICT_TIE,
         VERDICT_NEAR_TIE, VERDICT_NEAR_TIE},
        {VERDICT_BOUNDARY, VERDICT_BOUNDARY, VERDICT_BORDER, VERDICT_BORDER, VERDICT_BORDER,
         VERDICT_IN_PLANE, VERDICT_RIGHT, VERDICT_WRONG},
        {VERDICT_SLAB, VERDICT_NOISE, VERDICT_NOISE, VERDICT_OUT_OF_CONTRACT, VERDICT_RIGHT,
         VERDICT_IN_PLANE, VERDICT_IN_PLANE, VERDICT_WRONG},
    };
    static const size_t counted[][ARRAY_COUNT(called)] = {
        {2, 1, 3, 2}, {1, 1, 0, 0, 2, 3, 0, 1}, {1, 1, 0, 0, 0, 0, 4, 2}};
    static const size_t colour[] = {
        [VERDICT_RIGHT] = 0,          [VERDICT_WRONG] = 1,    [VERDICT_TIE] = 2,
        [VERDICT_NEAR_TIE] = 3,       [VERDICT_BOUNDARY] = 4, [VERDICT_BORDER] = 5,
        [VERDICT_SLAB] = 6,           [VERDICT_NOISE] = 6,    [VERDICT_IN_PLANE] = 7,
        [VERDICT_OUT_OF_CONTRACT] = 6};
    for (size_t m = 0; m < ARRAY_COUNT(mixed); m++) {
        char text[ARRAY_COUNT(called)][48];
        const char *name[ARRAY_COUNT(called)];
        uint32_t pixel[COUNT];
        struct colour_scale scale = scale_of(SHOW_CLASS, false, COUNT);
        for (size_t i = 0; i < ARRAY_COUNT(called); i++) {
            snprintf(text[i], sizeof text[i], "%s %zu", called[i], counted[m][i]);
            name[i] = text[i];
        }
        for (size_t i = 0; i < COUNT; i++)
            pixel[i] = colour_of_class(colour[(size_t)mixed[m][i]]);
        scale.kind = COLOUR_CLASSES;
        scale.class_name = name;
        scale.class_count = ARRAY_COUNT(called);
        expect_picture(show_find("class"), false, mixed[m], &scale, pixel);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_amount_has_its_scale),
        cmocka_unit_test(normals_have_no_bar),
        cmocka_unit_test(names_have_no_bar_and_their_difference_two_classes),
        cmocka_unit_test(legends_count_the_verdicts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Pictures in false colours: each pixel has the colour of its value, and the range is what was
 * asked for, or fits. */
#include "ref/base/rng.h"
#include "scenes/render/show_picture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH  4u
#define HEIGHT 2u

static const struct show_range fits = {0};

/* The colours of the values in the picture, row by row. */
static void colours_of(const char *name, bool difference, const double *value,
                       const struct show_range *range, uint32_t colour[WIDTH * HEIGHT])
{
    struct image image;
    struct colour_place place;
    struct reason reason = {""};
    if (show_picture(show_find(name), difference, value, WIDTH, HEIGHT, range, "a title", &image,
                     &place, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(place.zoom, 80);
    assert_true(image.height > place.y + HEIGHT * place.zoom); /* something is said below */
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        uint32_t x = place.x + i % WIDTH * place.zoom, y = place.y + i / WIDTH * place.zoom;
        colour[i] = image.pixel[(size_t)y * image.width + x];
        uint32_t last = place.zoom - 1;
        assert_int_equal(image.pixel[(size_t)(y + last) * image.width + x + last], colour[i]);
    }
    image_free(&image);
}

static void refused(const char *name, bool difference, double lo, double hi, const char *text)
{
    struct show_range range = {true, lo, hi};
    struct reason reason = {""};
    assert_int_equal(show_range_check(show_find(name), difference, &range, &reason), STATUS_INPUT);
    if (!strstr(reason.text, text))
        fail_msg("'%s' does not say '%s'", reason.text, text);
    double value[WIDTH * HEIGHT] = {0};
    struct image image;
    struct colour_place place;
    assert_int_equal(show_picture(show_find(name), difference, value, WIDTH, HEIGHT, &range, "",
                                  &image, &place, &reason),
                     STATUS_INPUT);
    assert_null(image.pixel);
}

static void amounts_go_from_the_least_to_the_most(void **state)
{
    (void)state;
    const double value[] = {10, 20, 30, NAN, 15, 30, 10, 25};
    uint32_t colour[WIDTH * HEIGHT];
    colours_of("boxes", false, value, &fits, colour);
    for (size_t i = 0; i < ARRAY_COUNT(value); i++)
        assert_int_equal(colour[i], isnan(value[i]) ? COLOUR_NO_DATA
                                                    : colour_sequential((value[i] - 10) / 20));
    const struct show_range range = {true, 0, 20};
    colours_of("boxes", false, value, &range, colour);
    assert_int_equal(colour[0], colour_sequential(0.5));
    assert_int_equal(colour[2], colour_sequential(1.0));
    assert_int_equal(colour[1], colour[2]);
}

/* Nine of ten differences are within: 3, of 1, 1, 2, 3 and 40. */
static void differences_have_0_in_the_middle(void **state)
{
    (void)state;
    const double value[] = {-2, 0, 3, NAN, 1, 40, 0, -1};
    uint32_t colour[WIDTH * HEIGHT];
    colours_of("depth", true, value, &fits, colour);
    for (size_t i = 0; i < ARRAY_COUNT(value); i++)
        assert_int_equal(colour[i],
                         isnan(value[i]) ? COLOUR_NO_DATA : colour_diverging(value[i] / 3));
    assert_int_equal(colour[5], colour[2]);
    const struct show_range range = {true, -8, 8};
    colours_of("depth", true, value, &range, colour);
    assert_int_equal(colour[2], colour_diverging(3.0 / 8.0));
    const double none[] = {0, 0, 0, 0, 0, 0, 0, 0};
    colours_of("depth", true, none, &fits, colour);
    assert_int_equal(colour[5], colour_diverging(0));
}

/* So that a picture without a bug does not look like one that is full of them. */
#define WIDE  20u
#define COUNT (WIDE * 10u)

/* The colours of differences of depth. */
static void colours_of_many(const double value[COUNT], uint32_t colour[COUNT])
{
    struct image image;
    struct colour_place place;
    struct reason reason = {""};
    if (show_picture(show_find("depth"), true, value, WIDE, COUNT / WIDE, &fits, "", &image, &place,
                     &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t x = place.x + i % WIDE * place.zoom, y = place.y + i / WIDE * place.zoom;
        colour[i] = image.pixel[(size_t)y * image.width + x];
    }
    image_free(&image);
}

/* How many pixels do not differ changes no colour of those that do: nine of ten of these are
 * within, by a count of them, and as if the others had no value. */
static void what_does_not_differ_does_not_count(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 1);
    for (int turn = 0; turn < 100; turn++) {
        double value[COUNT], some[COUNT];
        uint32_t colour[COUNT], alone[COUNT], within = 0;
        const uint32_t differ = 11 + rng_below(&rng, turn % 2 ? 20 : COUNT - 11);
        for (uint32_t i = 0; i < COUNT; i++) {
            const double size = 1.0 + (double)rng_below(&rng, 1u << 20); /* no two are one */
            value[i] = i >= differ ? 0.0 : rng_below(&rng, 2) ? size : -size;
            some[i] = i < differ ? value[i] : NAN;
        }
        colours_of_many(value, colour);
        colours_of_many(some, alone);
        assert_memory_equal(colour, alone, differ * sizeof *colour);
        for (uint32_t i = 0; i < COUNT; i++) {
            const bool end = colour[i] == colour_diverging(1) || colour[i] == colour_diverging(-1);
            within += i < differ && !end;
            assert_true(i < differ || colour[i] == colour_diverging(0));
        }
        /* Some near an end look like it. */
        assert_true(10 * within > 7 * differ && within < differ);
    }
}

static void errors_go_to_the_bound_at_least(void **state)
{
    (void)state;
    const double small[] = {0, 0.1, 0.01, NAN, 0.001, 0, 0, 0};
    const double large[] = {0, 0.1, 0.01, NAN, 0.001, 0, 0, 1000};
    uint32_t colour[WIDTH * HEIGHT];
    colours_of("error", false, small, &fits, colour);
    assert_int_equal(colour[1], colour_sequential(2.0 / 3.0));
    assert_int_equal(colour[0], colour_sequential(0.0));
    colours_of("error", false, large, &fits, colour);
    assert_int_equal(colour[1], colour_sequential(2.0 / 6.0));
    const struct show_range range = {true, 0, 0.2};
    colours_of("error", false, small, &range, colour);
    assert_int_equal(colour[1], colour_sequential(0.5));
}

/* One in 300,000 is framed, and no pixel but those around it changes. */
static void few_odd_pixels_are_framed(void **state)
{
    (void)state;
    const uint32_t width = 640, height = 480, x = 300, y = 200;
    double *value = calloc((size_t)width * height, sizeof *value);
    struct image image;
    struct colour_place place;
    assert_non_null(value);
    value[(size_t)y * width + x] = VERDICT_BOUNDARY;
    assert_int_equal(show_picture(show_find("class"), false, value, width, height, &fits, "title",
                                  &image, &place, NULL),
                     STATUS_OK);
    assert_int_equal(place.zoom, 1);
    const uint32_t *at = image.pixel + (size_t)(place.y + y) * image.width + place.x + x;
    const uint32_t right = colour_of_class(0), odd = colour_of_class(4);
    size_t framed = 0;
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i++) {
            uint32_t c = image.pixel[(size_t)(place.y + j) * image.width + place.x + i];
            framed += c == odd;
            assert_true(c == right || c == odd);
        }
    assert_int_equal(at[0], odd);
    assert_int_equal(at[3], right);
    assert_int_equal(at[4], odd);
    assert_int_equal(at[5], odd);
    assert_int_equal(at[6], right);
    assert_int_equal(framed, 1 + 32 + 40);
    image_free(&image);
    free(value);
}

static void names_have_colours_of_their_own(void **state)
{
    (void)state;
    const double prim[] = {0, 1, 2, NAN, 3, 3, 4000000000.0, 0};
    uint32_t colour[WIDTH * HEIGHT];
    colours_of("prim", false, prim, &fits, colour);
    for (size_t i = 0; i < ARRAY_COUNT(prim); i++)
        assert_int_equal(colour[i],
                         isnan(prim[i]) ? COLOUR_NO_DATA : colour_of_id((uint32_t)prim[i]));
    const double same[] = {0, 1, 0, NAN, 0, 0, 0, 1};
    colours_of("prim", true, same, &fits, colour);
    assert_int_equal(colour[0], colour[2]);
    assert_int_equal(colour[1], colour[7]);
    assert_true(colour[0] != colour[1] && colour[3] == COLOUR_NO_DATA);
}

/* Every verdict has a colour, and none that excuses has the colour of right or wrong. */
static void verdicts_are_told_apart(void **state)
{
    (void)state;
    uint32_t of[VERDICT_COUNT], colour[WIDTH * HEIGHT];
    for (int v = 0; v < VERDICT_COUNT; v++) {
        double value[WIDTH * HEIGHT];
        for (size_t i = 0; i < ARRAY_COUNT(value); i++)
            value[i] = v;
        colours_of("class", false, value, &fits, colour);
        of[v] = colour[0];
        assert_true(of[v] != COLOUR_NO_DATA);
    }
    for (int v = 0; v < VERDICT_COUNT; v++) {
        assert_true(v == VERDICT_RIGHT || of[v] != of[VERDICT_RIGHT]);
        assert_true(v == VERDICT_WRONG || of[v] != of[VERDICT_WRONG]);
        assert_true(v == VERDICT_BOUNDARY || of[v] != of[VERDICT_BOUNDARY]);
    }
}

/* What the legend of verdicts must say, in the order of its swatches. */
static void legends_name_the_verdicts(void **state)
{
    (void)state;
    static const char *const names[] = {"right",
                                        "wrong",
                                        "tie",
                                        "near tie",
                                        "boundary",
                                        "border",
                                        "slab, noise or out of contract",
                                        "in plane"};
    static const size_t of[VERDICT_COUNT] = {
        [VERDICT_RIGHT] = 0,    [VERDICT_WRONG] = 1,    [VERDICT_TIE] = 2,
        [VERDICT_NEAR_TIE] = 3, [VERDICT_BOUNDARY] = 4, [VERDICT_BORDER] = 5,
        [VERDICT_SLAB] = 6,     [VERDICT_NOISE] = 6,    [VERDICT_OUT_OF_CONTRACT] = 6,
        [VERDICT_IN_PLANE] = 7};
    for (int v = 0; v < VERDICT_COUNT; v++) {
        char text[ARRAY_COUNT(names)][48];
        const char *name[ARRAY_COUNT(names)];
        double value[WIDTH * HEIGHT];
        float class[WIDTH * HEIGHT];
        struct image got, expected;
        struct colour_place place;
        for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
            snprintf(text[i], sizeof text[i], "%s %u", names[i], i == of[v] ? WIDTH * HEIGHT : 0);
            name[i] = text[i];
        }
        for (size_t i = 0; i < ARRAY_COUNT(value); i++) {
            value[i] = v;
            class[i] = (float)of[v];
        }
        const struct colour_scale scale = {.kind = COLOUR_CLASSES,
                                           .title = "a title",
                                           .unit = "verdict",
                                           .class_name = name,
                                           .class_count = ARRAY_COUNT(names)};
        assert_int_equal(show_picture(show_find("class"), false, value, WIDTH, HEIGHT, &fits,
                                      "a title", &got, &place, NULL),
                         STATUS_OK);
        assert_int_equal(
            colour_picture(&scale, class, WIDTH, HEIGHT, place.zoom, &expected, &place, NULL),
            STATUS_OK);
        assert_true(got.width == expected.width && got.height == expected.height);
        assert_memory_equal(got.pixel, expected.pixel, (size_t)4 * got.width * got.height);
        image_free(&got);
        image_free(&expected);
    }
}

static void normals_are_colours_and_their_difference_an_angle(void **state)
{
    (void)state;
    double normal[3 * WIDTH * HEIGHT] = {0}, angle[WIDTH * HEIGHT] = {0, 90, 45};
    uint32_t colour[WIDTH * HEIGHT];
    normal[0] = 1;
    normal[4] = -1;
    normal[9] = (double)NAN;
    colours_of("normal", false, normal, &fits, colour);
    assert_int_equal(colour[0], image_rgb(255, 127, 127));
    assert_int_equal(colour[1], image_rgb(127, 0, 127));
    assert_int_equal(colour[3], COLOUR_NO_DATA);
    const struct show_range range = {true, 0, 180};
    colours_of("normal", true, angle, &range, colour);
    assert_int_equal(colour[1], colour_sequential(0.5));
}

static void a_range_that_says_nothing_is_refused(void **state)
{
    (void)state;
    refused("boxes", false, 5, 5, "no range");
    refused("boxes", false, 6, 5, "no range");
    refused("t", false, 0, INFINITY, "no range");
    refused("t", false, NAN, 1, "no range");
    refused("boxes", true, 0, 5, "0 in its middle: -5:5");
    refused("prim", false, 0, 5, "prim has no range");
    refused("class", true, 0, 5, "class has no range");
    refused("normal", false, 0, 1, "normal has no range");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(amounts_go_from_the_least_to_the_most),
        cmocka_unit_test(differences_have_0_in_the_middle),
        cmocka_unit_test(what_does_not_differ_does_not_count),
        cmocka_unit_test(errors_go_to_the_bound_at_least),
        cmocka_unit_test(few_odd_pixels_are_framed),
        cmocka_unit_test(names_have_colours_of_their_own),
        cmocka_unit_test(verdicts_are_told_apart),
        cmocka_unit_test(legends_name_the_verdicts),
        cmocka_unit_test(normals_are_colours_and_their_difference_an_angle),
        cmocka_unit_test(a_range_that_says_nothing_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Colours for numbers: lightness that rises with them, for every eye; a scale bar that says which.
 */
#include "scenes/picture/colour_picture.h"

#include "scenes/picture/draw.h"
#include "scenes/picture/ticks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

enum { SAMPLES = 257 };

static double linear(unsigned byte)
{
    double v = byte / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* OKLab (Ottosson 2020), where distances are as large as they look. */
static void oklab(uint32_t colour, double lab[3])
{
    double r = linear(colour & 255), g = linear(colour >> 8 & 255), b = linear(colour >> 16 & 255);
    double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

static double distance(uint32_t a, uint32_t b)
{
    double p[3], q[3], sum = 0.0;
    oklab(a, p);
    oklab(b, q);
    for (int k = 0; k < 3; k++)
        sum += (p[k] - q[k]) * (p[k] - q[k]);
    return sqrt(sum);
}

/* Luminance as seen by an eye: 0 usual, 1 without red cones, 2 without green ones (Machado,
 * Oliveira and Fernandes 2009). */
static double luminance(uint32_t colour, int eye)
{
    static const double seen[3][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                         {{0.152286, 1.052583, -0.204868},
                                          {0.114503, 0.786281, 0.099216},
                                          {-0.003882, -0.048116, 1.051998}},
                                         {{0.367322, 0.860646, -0.227968},
                                          {0.280085, 0.672501, 0.047413},
                                          {-0.011820, 0.042940, 0.968881}}};
    const double c[3] = {linear(colour & 255), linear(colour >> 8 & 255),
                         linear(colour >> 16 & 255)};
    const double weight[3] = {0.2126, 0.7152, 0.0722};
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            sum += weight[i] * seen[eye][i][k] * c[k];
    return sum;
}

static void more_is_lighter_for_every_eye(void **state)
{
    (void)state;
    for (int eye = 0; eye < 3; eye++) {
        double last = -1.0;
        for (int i = 0; i < 33; i++) {
            double light = luminance(colour_sequential(i / 32.0), eye);
            if (!(light > last))
                fail_msg("eye %d: no lighter at step %d", eye, i);
            last = light;
        }
        for (int i = 1; i <= 16; i++) { /* both ways from the middle */
            double before = luminance(colour_diverging((i - 1) / 16.0), eye);
            assert_true(luminance(colour_diverging(i / 16.0), eye) < before);
            before = luminance(colour_diverging(-(i - 1) / 16.0), eye);
            assert_true(luminance(colour_diverging(-i / 16.0), eye) < before);
        }
    }
}

static void even_steps_look_even(void **state)
{
    (void)state;
    double least = INFINITY, most = 0.0;
    for (int i = 0; i < 32; i++) {
        double step = distance(colour_sequential(i / 32.0), colour_sequential((i + 1) / 32.0));
        least = fmin(least, step);
        most = fmax(most, step);
    }
    assert_true(most < 1.25 * least);
    for (int i = 0; i <= 16; i++) { /* as far from the middle on either side */
        double above[3], below[3];
        oklab(colour_diverging(i / 16.0), above);
        oklab(colour_diverging(-i / 16.0), below);
        assert_true(fabs(above[0] - below[0]) < 0.03);
    }
    /* Between the entries of the table nothing jumps: a byte changes by no more than there. */
    for (int i = 0; i < 1000; i++)
        assert_true(distance(colour_sequential(i / 1000.0), colour_sequential((i + 1) / 1000.0)) <
                    0.01);
}

static void ends_are_those_of_the_range(void **state)
{
    (void)state;
    assert_int_equal(colour_sequential(-3), colour_sequential(0));
    assert_int_equal(colour_sequential(NAN), colour_sequential(0));
    assert_int_equal(colour_sequential(INFINITY), colour_sequential(1));
    assert_int_equal(colour_sequential(0), image_rgb(0x19, 0x02, 0x32));
    assert_int_equal(colour_sequential(1), image_rgb(0xFF, 0xF3, 0xB9));
    assert_int_equal(colour_diverging(0), image_rgb(0xF2, 0xF2, 0xF2));
    assert_int_equal(colour_diverging(-9), image_rgb(0x00, 0x39, 0x81));
    assert_int_equal(colour_diverging(9), image_rgb(0x67, 0x26, 0x00));
}

static void no_data_looks_like_no_number(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++) {
        double part = (double)i / (SAMPLES - 1);
        assert_true(distance(COLOUR_NO_DATA, colour_sequential(part)) > 0.06);
        assert_true(distance(COLOUR_NO_DATA, colour_diverging(2 * part - 1)) > 0.06);
    }
    for (uint32_t id = 0; id < 5000; id++)
        assert_true(distance(COLOUR_NO_DATA, colour_of_id(id)) > 0.06);
    for (size_t i = 0; i < COLOUR_CLASS_COUNT; i++)
        assert_true(distance(COLOUR_NO_DATA, colour_of_class(i)) > 0.06);
}

static void ids_and_classes_have_colours_of_their_own(void **state)
{
    (void)state;
    size_t alike = 0;
    for (uint32_t id = 0; id < 2000; id++)
        alike += distance(colour_of_id(id), colour_of_id(id + 1)) < 0.05;
    if (alike >= 60) /* neighbours in a mesh have neighbouring numbers */
        fail_msg("%zu of 2000", alike);
    assert_int_equal(colour_of_id(7), colour_of_id(7));
    for (size_t i = 0; i < COLOUR_CLASS_COUNT; i++)
        for (size_t k = 0; k < i; k++)
            assert_true(distance(colour_of_class(i), colour_of_class(k)) > 0.1);
    assert_int_equal(colour_of_class(COLOUR_CLASS_COUNT + 2), colour_of_class(2));
    char text[8];
    colour_text(colour_of_class(1), text);
    assert_string_equal(text, "#d55e00");
}

static void values_become_the_colours_of_their_scale(void **state)
{
    (void)state;
    struct colour_scale scale = {.kind = COLOUR_SEQUENTIAL, .lo = 10, .hi = 20};
    assert_int_equal(colour_of(&scale, 10), colour_sequential(0));
    assert_int_equal(colour_of(&scale, 15), colour_sequential(0.5));
    assert_int_equal(colour_of(&scale, 99), colour_sequential(1));
    assert_int_equal(colour_of(&scale, -INFINITY), colour_sequential(0));
    assert_int_equal(colour_of(&scale, NAN), COLOUR_NO_DATA);
    scale =
        (struct colour_scale){.kind = COLOUR_SEQUENTIAL, .logarithmic = true, .lo = 1, .hi = 100};
    assert_int_equal(colour_of(&scale, 10), colour_sequential(0.5));
    assert_int_equal(colour_of(&scale, 0), colour_sequential(0));
    assert_int_equal(colour_of(&scale, -1), colour_sequential(0));
    scale = (struct colour_scale){.kind = COLOUR_DIVERGING, .hi = 8};
    assert_int_equal(colour_of(&scale, 0), colour_diverging(0));
    assert_int_equal(colour_of(&scale, -0.0f), colour_diverging(0));
    assert_int_equal(colour_of(&scale, -8), colour_diverging(-1));
    assert_int_equal(colour_of(&scale, 4), colour_diverging(0.5));
    const char *const names[] = {"a", "b"};
    scale = (struct colour_scale){.kind = COLOUR_CLASSES, .class_name = names, .class_count = 2};
    assert_int_equal(colour_of(&scale, 1), colour_of_class(1));
    assert_int_equal(colour_of(&scale, 2), COLOUR_NO_DATA);
    assert_int_equal(colour_of(&scale, -1), COLOUR_NO_DATA);
    scale = (struct colour_scale){.kind = COLOUR_IDS};
    assert_int_equal(colour_of(&scale, 77), colour_of_id(77));
    assert_int_equal(colour_of(&scale, INFINITY), COLOUR_NO_DATA);
}

static void scales_fit_their_values(void **state)
{
    (void)state;
    const float value[] = {3, NAN, -7, INFINITY, 5, -INFINITY};
    struct colour_scale scale = {.kind = COLOUR_SEQUENTIAL};
    colour_fit(&scale, value, 6);
    assert_true(scale.lo == -7 && scale.hi == 5);
    scale.logarithmic = true;
    colour_fit(&scale, value, 6);
    assert_true(scale.lo == 3 && scale.hi == 5);
    scale = (struct colour_scale){.kind = COLOUR_DIVERGING};
    colour_fit(&scale, value, 6);
    assert_true(scale.hi == 7);
    /* Nothing to fit, or one value. */
    for (size_t count = 0; count <= 2; count++)
        for (int kind = COLOUR_SEQUENTIAL; kind <= COLOUR_DIVERGING; kind++)
            for (int logarithmic = 0; logarithmic < 2 - kind; logarithmic++) {
                scale = (struct colour_scale){.kind = (enum colour_kind)kind,
                                              .logarithmic = logarithmic};
                colour_fit(&scale, value, count);
                assert_true(scale.hi > scale.lo && (!logarithmic || scale.lo > 0));
            }
    const float same = 1e9f;
    scale = (struct colour_scale){.kind = COLOUR_SEQUENTIAL};
    colour_fit(&scale, &same, 1);
    assert_true(scale.hi > scale.lo);
}

/* Where a text of that scale stands in the picture, black on white; false if nowhere. */
static bool find_scaled(const struct image *image, const char *text, unsigned scale, uint32_t *at_x,
                        uint32_t *at_y)
{
    struct image stamp;
    const uint32_t width = (uint32_t)draw_text_width(text, scale) + 6;
    const uint32_t height = FONT_HEIGHT * scale;
    assert_int_equal(image_make(width, height, &stamp, NULL), STATUS_OK);
    draw_rect(&stamp, 0, 0, (int)width, (int)height, image_rgb(255, 255, 255));
    draw_text(&stamp, 3, 0, scale, image_rgb(0, 0, 0), text);
    bool found = false;
    for (uint32_t y = 0; !found && y + height <= image->height; y++)
        for (uint32_t x = 0; !found && x + width <= image->width; x++) {
            found = true;
            for (uint32_t v = 0; found && v < height; v++)
                found = !memcmp(stamp.pixel + v * width, image->pixel + (y + v) * image->width + x,
                                4 * width);
            *at_x = x + 3;
            *at_y = y;
        }
    image_free(&stamp);
    return found;
}

static bool find_text(const struct image *image, const char *text, uint32_t *at_x, uint32_t *at_y)
{
    return find_scaled(image, text, 1, at_x, at_y);
}

static struct image pictured(const struct colour_scale *scale, const float *value, uint32_t width,
                             uint32_t height, unsigned zoom, struct colour_place *place)
{
    struct image image;
    struct reason reason;
    assert_int_equal(colour_picture(scale, value, width, height, zoom, &image, place, &reason),
                     STATUS_OK);
    return image;
}

static void each_value_is_its_pixels(void **state)
{
    (void)state;
    enum { W = 31, H = 7 };
    float value[W * H];
    for (int i = 0; i < W * H; i++)
        value[i] = i % 5 == 0 ? NAN : (float)(i % 17);
    const struct colour_scale scale = {
        .kind = COLOUR_SEQUENTIAL, .hi = 16, .title = "title", .unit = "units", .no_data = "miss"};
    for (unsigned zoom = 1; zoom <= 3; zoom++) {
        struct colour_place place;
        struct image image = pictured(&scale, value, W, H, zoom, &place);
        assert_int_equal(place.zoom, zoom);
        for (uint32_t y = 0; y < H * zoom; y++)
            for (uint32_t x = 0; x < W * zoom; x++)
                assert_int_equal(image.pixel[(place.y + y) * image.width + place.x + x],
                                 colour_of(&scale, value[y / zoom * W + x / zoom]));
        uint32_t x, y;
        assert_true(find_text(&image, "title", &x, &y) && y < place.y);
        assert_true(find_text(&image, "units, 0 to 16", &x, &y) && y > place.y + H * zoom);
        assert_true(find_text(&image, "miss", &x, &y));
        assert_int_equal(image.pixel[y * image.width + x - 8], COLOUR_NO_DATA);
        image_free(&image);
    }
}

/* Title, bar, numbers, unit and swatches grow with the picture, and no word has another scale.
 * Below the values are 6 pixels, the bar (12), ticks and numbers (18) and two lines of 13, each
 * enlarged, and 2. */
static void words_grow_with_the_picture(void **state)
{
    (void)state;
    static const uint32_t size[][2] = {{100, 1}, {799, 1}, {800, 2}, {1199, 2}, {1200, 3}};
    const struct colour_scale scale = {
        .kind = COLOUR_SEQUENTIAL, .hi = 90, .title = "title", .unit = "units", .no_data = "miss"};
    for (size_t i = 0; i < ARRAY_COUNT(size); i++) {
        const uint32_t width = size[i][0], text = size[i][1];
        float *value = calloc(width, sizeof *value);
        struct colour_place place;
        struct image image = pictured(&scale, value, width, 1, 1, &place);
        static const char *const words[] = {"title", "0", "60", "units, 0 to 90", "miss"};
        for (size_t k = 0; k < ARRAY_COUNT(words); k++) {
            uint32_t x, y;
            for (unsigned other = 1; other <= 4; other++)
                if (find_scaled(&image, words[k], other, &x, &y) != (other == text))
                    fail_msg("'%s' in %u pixels: scale %u", words[k], width, other);
        }
        assert_int_equal(place.y, 8 + 13 * text);
        assert_int_equal(image.height - place.y - 1, 6 + (12 + 18 + 13 + 13) * text + 2);
        image_free(&image);
        free(value);
    }
}

/* Above every number on the bar is the colour that the number has. */
static void expect_numbers(const struct colour_scale *scale, const char *const *text, size_t count)
{
    struct colour_place place;
    static const float none[300 * 2];
    struct image image = pictured(scale, none, 300, 2, 1, &place);
    uint32_t last = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t x, y;
        if (!find_text(&image, text[i], &x, &y))
            fail_msg("no '%s'", text[i]);
        x += (uint32_t)draw_text_width(text[i], 1) / 2;
        if (i > 0)
            assert_true(x > last);
        last = x;
        double off = distance(image.pixel[(y - 7) * image.width + x],
                              colour_of(scale, strtof(text[i], NULL)));
        if (off > 0.03)
            fail_msg("'%s' stands below another colour, %.3f away", text[i], off);
    }
    image_free(&image);
}

static void the_bar_says_what_colours_mean(void **state)
{
    (void)state;
    struct colour_scale scale = {.kind = COLOUR_SEQUENTIAL, .lo = -13, .hi = 47};
    expect_numbers(&scale, (const char *const[]){"-10", "0", "10", "20", "30", "40"}, 6);
    scale =
        (struct colour_scale){.kind = COLOUR_SEQUENTIAL, .logarithmic = true, .lo = 0.5, .hi = 1e5};
    expect_numbers(&scale, (const char *const[]){"1", "10", "100", "1000", "10000", "1e5"}, 6);
    scale = (struct colour_scale){.kind = COLOUR_DIVERGING, .hi = 0.7};
    expect_numbers(&scale, (const char *const[]){"-0.4", "-0.2", "0", "0.2", "0.4"}, 5);
}

static void classes_are_in_the_legend(void **state)
{
    (void)state;
    const char *const names[] = {"same: 12", "an edge: 3", "different: 0", "lost"};
    const struct colour_scale scale = {
        .kind = COLOUR_CLASSES, .class_name = names, .class_count = 4, .no_data = "no hit"};
    struct colour_place place;
    const float value = 2;
    struct image image = pictured(&scale, &value, 1, 1, 5, &place);
    for (size_t i = 0; i < 4; i++) {
        uint32_t x, y;
        assert_true(find_text(&image, names[i], &x, &y));
        assert_int_equal(image.pixel[(y + 3) * image.width + x - 8], colour_of_class(i));
    }
    image_free(&image);
}

static void words_fit_or_are_cut(void **state)
{
    (void)state;
    char title[600];
    memset(title, 'x', sizeof title - 1);
    title[sizeof title - 1] = '\0';
    struct colour_scale scale = {.kind = COLOUR_IDS, .title = title, .unit = title};
    struct colour_place place;
    struct reason reason;
    static const float value[2000];
    const uint32_t sides[] = {1, 300, 999, 1000, 2000};
    for (size_t i = 0; i < ARRAY_COUNT(sides); i++) {
        struct image image = pictured(&scale, value, sides[i], 1, 1, &place);
        assert_true(image.width <= sides[i] + 240 || sides[i] >= 1000);
        for (uint32_t y = 0; y < image.height; y++) /* nothing runs into the margin */
            assert_int_equal(image.pixel[(y + 1) * image.width - 3], image_rgb(255, 255, 255));
        image_free(&image);
    }
    struct image image;
    assert_int_equal(colour_picture(&scale, value, 0, 1, 1, &image, &place, &reason), STATUS_INPUT);
    assert_int_equal(colour_picture(&scale, value, 1, 1, 0, &image, &place, &reason), STATUS_INPUT);
    assert_int_equal(colour_picture(&scale, value, 2000, 1, 9, &image, &place, &reason),
                     STATUS_INPUT);
    assert_null(image.pixel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_is_lighter_for_every_eye),
        cmocka_unit_test(even_steps_look_even),
        cmocka_unit_test(ends_are_those_of_the_range),
        cmocka_unit_test(no_data_looks_like_no_number),
        cmocka_unit_test(ids_and_classes_have_colours_of_their_own),
        cmocka_unit_test(values_become_the_colours_of_their_scale),
        cmocka_unit_test(scales_fit_their_values),
        cmocka_unit_test(each_value_is_its_pixels),
        cmocka_unit_test(words_grow_with_the_picture),
        cmocka_unit_test(the_bar_says_what_colours_mean),
        cmocka_unit_test(classes_are_in_the_legend),
        cmocka_unit_test(words_fit_or_are_cut),
    };
    return cmocka_run_group_tests_name("colour", tests, NULL, NULL) ? 1 : 0;
}

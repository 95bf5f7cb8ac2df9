/* Two pictures compared: what was planted is counted, measured and located, and nothing else. */
#include "scenes/picture/image_diff.h"

#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct image random_image(uint32_t width, uint32_t height)
{
    struct image image;
    struct rng rng = rng_make(width, height);
    assert_int_equal(image_make(width, height, &image, NULL), STATUS_OK);
    for (size_t i = 0; i < (size_t)width * height; i++)
        image.pixel[i] = (uint32_t)rng_u64(&rng);
    return image;
}

static struct image copy_of(const struct image *image)
{
    struct image copy;
    assert_int_equal(image_make(image->width, image->height, &copy, NULL), STATUS_OK);
    memcpy(copy.pixel, image->pixel, 4 * (size_t)image->width * image->height);
    return copy;
}

/* Changes one channel by so much, up where there is room. */
static void plant(struct image *image, uint32_t x, uint32_t y, unsigned channel, unsigned amount)
{
    uint32_t *pixel = &image->pixel[y * image->width + x];
    unsigned byte = *pixel >> 8 * channel & 255;
    byte = byte + amount <= 255 ? byte + amount : byte - amount;
    *pixel = (*pixel & ~(255u << 8 * channel)) | byte << 8 * channel;
}

static struct image_diff compared(const struct image *a, const struct image *b)
{
    struct image_diff diff;
    assert_int_equal(image_diff(a, b, &diff, NULL), STATUS_OK);
    return diff;
}

static void equal_pictures_are_equal(void **state)
{
    (void)state;
    struct image a = random_image(17, 9);
    struct image_diff diff = compared(&a, &a);
    assert_int_equal(diff.pixels, 17 * 9);
    assert_int_equal(diff.differing, 0);
    assert_int_equal(image_diff_largest(&diff), 0);
    assert_int_equal(diff.most_x + diff.most_y + diff.worst.a, 0);
    image_free(&a);
}

static void planted_differences_are_found(void **state)
{
    (void)state;
    static const struct {
        uint32_t x, y;
        unsigned channel, amount, size;
    } planted[] = {{3, 2, 0, 1, 0},  {20, 2, 1, 2, 1},  {11, 4, 2, 3, 2},
                   {5, 5, 3, 7, 2},  {6, 6, 0, 8, 3},   {7, 6, 1, 31, 3},
                   {8, 7, 2, 32, 4}, {2, 7, 0, 128, 4}, {9, 8, 0, 100, 4}};
    struct image a = random_image(25, 10), b = copy_of(&a);
    uint64_t size[IMAGE_DIFF_SIZES] = {0};
    for (size_t i = 0; i < ARRAY_COUNT(planted); i++) {
        plant(&b, planted[i].x, planted[i].y, planted[i].channel, planted[i].amount);
        size[planted[i].size]++;
        assert_int_equal(compared(&a, &b).differing, i + 1);
    }
    for (int way = 0; way < 2; way++) {
        struct image_diff diff = way ? compared(&b, &a) : compared(&a, &b);
        assert_int_equal(diff.pixels, 250);
        assert_memory_equal(diff.by_size, size, sizeof size);
        const unsigned largest[] = {128, 31, 32, 7};
        const uint64_t total[] = {1 + 8 + 128 + 100, 2 + 31, 3 + 32, 7};
        assert_memory_equal(diff.largest, largest, sizeof largest);
        assert_memory_equal(diff.total, total, sizeof total);
        assert_int_equal(image_diff_largest(&diff), 128);
        assert_int_equal(diff.least_x, 2);
        assert_int_equal(diff.most_x, 20);
        assert_int_equal(diff.least_y, 2);
        assert_int_equal(diff.most_y, 8);
        assert_int_equal(diff.first.x, 3);
        assert_int_equal(diff.first.y, 2);
        assert_int_equal(diff.worst.x, 2);
        assert_int_equal(diff.worst.y, 7);
        assert_int_equal(diff.worst.a, (way ? &b : &a)->pixel[7 * 25 + 2]);
        assert_int_equal(diff.worst.b, (way ? &a : &b)->pixel[7 * 25 + 2]);
    }
    image_free(&a);
    image_free(&b);
}

/* A pixel counts once, by its worst channel; of two equally bad the first is named. */
static void a_pixel_is_as_bad_as_its_worst_channel(void **state)
{
    (void)state;
    struct image a = random_image(4, 4), b = copy_of(&a);
    plant(&b, 1, 1, 0, 2);
    plant(&b, 1, 1, 1, 40);
    plant(&b, 3, 1, 2, 40);
    struct image_diff diff = compared(&a, &b);
    assert_int_equal(diff.differing, 2);
    assert_int_equal(diff.by_size[4], 2);
    assert_int_equal(diff.worst.x, 1);
    assert_int_equal(image_diff_of(a.pixel[5], b.pixel[5]), 40);
    assert_int_equal(image_diff_of(image_rgb(0, 0, 0), image_rgb(0, 255, 0)), 255);
    image_free(&a);
    image_free(&b);
}

static void sizes_must_be_equal(void **state)
{
    (void)state;
    struct image a = random_image(4, 6), b = random_image(6, 4), c = random_image(4, 5);
    struct image_diff diff;
    struct reason reason;
    assert_int_equal(image_diff(&a, &b, &diff, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "4 x 6 pixels against 6 x 4: sides must be equal");
    assert_int_equal(image_diff(&a, &c, &diff, &reason), STATUS_INPUT);
    image_free(&a);
    image_free(&b);
    image_free(&c);
}

static void the_heat_map_shows_each_pixel(void **state)
{
    (void)state;
    for (int large = 0; large < 2; large++) {
        struct image a = random_image(60, 20), b = copy_of(&a), heat;
        struct colour_place place;
        struct reason reason;
        plant(&b, 0, 0, 0, 1);
        plant(&b, 59, 19, 3, large ? 100 : 4);
        plant(&b, 30, 3, 1, 2);
        struct image_diff diff = compared(&a, &b);
        assert_int_equal(image_diff_heat(&a, &b, &diff, "a against b", &heat, &place, &reason),
                         STATUS_OK);
        assert_int_equal(place.zoom, 8);
        const struct colour_scale scale = {
            .kind = COLOUR_SEQUENTIAL, .logarithmic = large, .lo = large, .hi = large ? 100 : 4};
        size_t heated = 0;
        for (uint32_t y = 0; y < 20 * place.zoom; y++)
            for (uint32_t x = 0; x < 60 * place.zoom; x++) {
                uint32_t shown = heat.pixel[(place.y + y) * heat.width + place.x + x];
                size_t i = y / place.zoom * 60 + x / place.zoom;
                unsigned by = image_diff_of(a.pixel[i], b.pixel[i]);
                assert_int_equal(shown, by ? colour_of(&scale, (float)by) : COLOUR_NO_DATA);
                heated += by != 0;
            }
        assert_int_equal(heated, 3 * 64);
        image_free(&a);
        image_free(&b);
        image_free(&heat);
    }
}

static void equal_pictures_have_a_heat_map_too(void **state)
{
    (void)state;
    struct image a = random_image(1, 1), heat;
    struct colour_place place;
    struct reason reason;
    struct image_diff diff = compared(&a, &a);
    assert_int_equal(image_diff_heat(&a, &a, &diff, NULL, &heat, &place, &reason), STATUS_OK);
    assert_int_equal(heat.pixel[place.y * heat.width + place.x], COLOUR_NO_DATA);
    image_free(&a);
    image_free(&heat);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_are_equal),
        cmocka_unit_test(planted_differences_are_found),
        cmocka_unit_test(a_pixel_is_as_bad_as_its_worst_channel),
        cmocka_unit_test(sizes_must_be_equal),
        cmocka_unit_test(the_heat_map_shows_each_pixel),
        cmocka_unit_test(equal_pictures_have_a_heat_map_too),
    };
    return cmocka_run_group_tests_name("image_diff", tests, NULL, NULL) ? 1 : 0;
}

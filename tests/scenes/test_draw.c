/* Drawing: text that can be read, lines where their numbers say, nothing beyond the border. */
#include "scenes/picture/draw.h"

#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define BLACK 0xFF000000u
#define WHITE 0xFFFFFFFFu

static struct image made(uint32_t width, uint32_t height)
{
    struct image image;
    assert_int_equal(image_make(width, height, &image, NULL), STATUS_OK);
    return image;
}

/* Compares with rows of '#' (white) and '.' (black). */
static void expect_picture(const struct image *image, const char *const *row)
{
    for (uint32_t y = 0; y < image->height; y++) {
        assert_int_equal(strlen(row[y]), image->width);
        for (uint32_t x = 0; x < image->width; x++) {
            uint32_t pixel = image->pixel[y * image->width + x];
            if (pixel != (row[y][x] == '#' ? WHITE : BLACK))
                fail_msg("row %u, column %u: %08x", y, x, pixel);
        }
    }
}

static size_t count_of(const struct image *image, uint32_t colour)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        count += image->pixel[i] == colour;
    return count;
}

static void text_can_be_read(void **state)
{
    (void)state;
    struct image image = made(11, 9);
    draw_text(&image, 0, 0, 1, WHITE, "Ag");
    expect_picture(&image, (const char *const[]){"..#........", /**/
                                                 ".#.#.......", /**/
                                                 "#...#..##.#", /**/
                                                 "#...#.#..##", /**/
                                                 "#####.#...#", /**/
                                                 "#...#.#..##", /**/
                                                 "#...#..##.#", /**/
                                                 "..........#", /**/
                                                 ".......###."});
    image_free(&image);
    image = made(9, 11);
    draw_text_up(&image, 0, 10, 1, WHITE, "Ag");
    expect_picture(&image, (const char *const[]){"..######.", /**/
                                                 "...#.#..#", /**/
                                                 "..#...#.#", /**/
                                                 "..#...#.#", /**/
                                                 "...###...", /**/
                                                 ".........", /**/
                                                 "..#####..", /**/
                                                 ".#..#....", /**/
                                                 "#...#....", /**/
                                                 ".#..#....", /**/
                                                 "..#####.."});
    image_free(&image);
    image = made(4, 6);
    draw_text(&image, -1, -8, 2, WHITE, "i"); /* its lower part: rows 4 to 6 of the dots */
    expect_picture(&image, (const char *const[]){"...#", "...#", "...#", "...#", ".###", ".###"});
    image_free(&image);
}

static int dots_apart(unsigned char a, unsigned char b)
{
    int dots = 0;
    for (int x = 0; x < FONT_WIDTH; x++)
        for (int y = 0; y < FONT_HEIGHT; y++)
            dots += font_dot(a, x, y) != font_dot(b, x, y);
    return dots;
}

static void characters_differ_in_more_than_a_dot(void **state)
{
    (void)state;
    for (unsigned char a = ' '; a <= '~'; a++)
        for (unsigned char b = (unsigned char)(a + 1); b <= '~'; b++) {
            int dots = dots_apart(a, b);
            if (dots < 2)
                fail_msg("'%c' and '%c' differ in %d dots", a, b, dots);
        }
    for (int c = 0; c < 256; c++)
        if (c < ' ' || c > '~')
            assert_int_equal(dots_apart((unsigned char)c, '?'), 0);
}

static void width_is_that_of_what_is_drawn(void **state)
{
    (void)state;
    assert_int_equal(draw_text_width("", 1), 0);
    assert_int_equal(draw_text_width("MM", 1), 11);
    assert_int_equal(draw_text_width("MM", 3), 33);
    assert_int_equal(draw_text_width("M\xC3\xA4M", 1), 17); /* two bytes, one character */
    struct image image = made(64, 32), other = made(64, 32);
    draw_text(&image, 0, 0, 3, WHITE, "MM");
    draw_rect(&image, 0, 0, 33, 27, BLACK);
    assert_int_equal(count_of(&image, WHITE), 0);
    draw_text(&image, 0, 0, 1, WHITE, "M\xC3\xA4M");
    draw_text(&other, 0, 0, 1, WHITE, "M?M");
    assert_memory_equal(image.pixel, other.pixel, 64 * 32 * 4);
    image_free(&image);
    image_free(&other);
}

static void nothing_is_drawn_beyond_the_border(void **state)
{
    (void)state;
    static const int far[] = {INT_MIN, INT_MIN + 1, -40, -3, 0, 3, 40, INT_MAX - 1, INT_MAX};
    static const double line[] = {-1e300, -1e9, -7, 0, 5, 1e9, 1e300, INFINITY, NAN};
    const uint32_t pixel[4] = {WHITE, WHITE, WHITE, WHITE};
    struct image image = made(7, 5); /* ASan sees to the rest */
    for (size_t i = 0; i < ARRAY_COUNT(far); i++)
        for (size_t k = 0; k < ARRAY_COUNT(far); k++) {
            draw_rect(&image, far[i], far[k], far[k], far[i], WHITE);
            draw_frame(&image, far[i], far[k], far[k], far[i], WHITE);
            draw_text(&image, far[i], far[k], 2, WHITE, "Wide");
            draw_text_up(&image, far[i], far[k], UINT_MAX, WHITE, "Wide");
            draw_pixels(&image, far[i], far[k], pixel, 2, 2, 3);
            draw_pixels(&image, far[i], far[k], pixel, 2, 2, UINT_MAX);
            draw_line(&image, line[i], line[k], line[k], line[i], 1, WHITE);
            draw_line(&image, line[i], 2, 3, line[k], 1e9, WHITE);
        }
    image_free(&image);
    image = made(7, 5);
    draw_line(&image, NAN, 2, 3, 3, 1, WHITE);
    draw_line(&image, 1, 2, 3, 3, 0, WHITE);
    draw_rect(&image, 1, 1, 0, 3, WHITE);
    draw_rect(&image, 1, 1, -1, 3, WHITE);
    draw_frame(&image, 7, 0, 3, 3, WHITE);
    assert_int_equal(count_of(&image, BLACK), 35);
    draw_rect(&image, 5, 3, 100, 100, WHITE);
    assert_int_equal(count_of(&image, WHITE), 4);
    image_free(&image);
}

static void frames_are_one_pixel_thick(void **state)
{
    (void)state;
    struct image image = made(6, 5);
    draw_frame(&image, 1, 0, 4, 4, WHITE);
    expect_picture(&image, (const char *const[]){".####.", ".#..#.", ".#..#.", ".####.", "......"});
    image_free(&image);
    image = made(3, 1);
    draw_frame(&image, 0, 0, 3, 1, WHITE | 0x80000000u);
    expect_picture(&image, (const char *const[]){"###"});
    image_free(&image);
}

static void lines_lie_where_their_ends_say(void **state)
{
    (void)state;
    struct image image = made(7, 5);
    draw_line(&image, 1.5, 2.5, 5.5, 2.5, 1, WHITE);
    expect_picture(&image,
                   (const char *const[]){".......", ".......", ".#####.", ".......", "......."});
    draw_line(&image, 3.5, 4.5, 3.5, 0.5, 1, WHITE);
    expect_picture(&image,
                   (const char *const[]){"...#...", "...#...", ".#####.", "...#...", "...#..."});
    image_free(&image);
    image = made(5, 5); /* between two rows it covers both by half */
    draw_line(&image, -10, 2, 20, 2, 1, WHITE);
    assert_int_equal(count_of(&image, image_rgb(128, 128, 128)), 10);
    image_free(&image);
    /* As much ink as width times length, whatever the direction. */
    for (int k = 0; k < 12; k++) {
        image = made(100, 100);
        double a = 0.5 * k, ink = 0.0, width = 1.0 + 0.5 * (k % 3);
        draw_line(&image, 50, 50, 50 + 40 * cos(a), 50 + 40 * sin(a), width, WHITE);
        for (size_t i = 0; i < 10000; i++)
            ink += (image.pixel[i] & 255) / 255.0;
        double expected = 40 * width + 0.7854 * width * width; /* and two half discs */
        if (fabs(ink / expected - 1.0) > 0.05)
            fail_msg("direction %d: %.2f of ink for %.2f", k, ink, expected);
        image_free(&image);
    }
}

static void colours_cover_as_their_alpha_says(void **state)
{
    (void)state;
    struct image image = made(2, 1);
    draw_rect(&image, 0, 0, 1, 1, 0x80FFFFFFu);
    assert_int_equal(image.pixel[0], image_rgb(128, 128, 128));
    draw_rect(&image, 0, 0, 1, 1, 0x00FFFFFFu);
    assert_int_equal(image.pixel[0], image_rgb(128, 128, 128));
    image.pixel[1] = 0x10000000u; /* what is seen through stays so */
    draw_rect(&image, 1, 0, 1, 1, WHITE);
    assert_int_equal(image.pixel[1], 0x10FFFFFFu);
    image_free(&image);
}

static void pixels_are_copied_and_enlarged(void **state)
{
    (void)state;
    const uint32_t pixel[] = {WHITE, BLACK, BLACK, WHITE, WHITE, BLACK};
    struct image image = made(7, 5);
    draw_pixels(&image, 1, 1, pixel, 3, 2, 2);
    expect_picture(&image,
                   (const char *const[]){".......", ".##....", ".##....", ".####..", ".####.."});
    draw_pixels(&image, -2, -2, pixel, 3, 2, 2);
    expect_picture(&image,
                   (const char *const[]){"##.....", "##.....", ".##....", ".####..", ".####.."});
    draw_pixels(&image, 0, 0, pixel, 3, 2, 0);
    image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_can_be_read),
        cmocka_unit_test(characters_differ_in_more_than_a_dot),
        cmocka_unit_test(width_is_that_of_what_is_drawn),
        cmocka_unit_test(nothing_is_drawn_beyond_the_border),
        cmocka_unit_test(frames_are_one_pixel_thick),
        cmocka_unit_test(lines_lie_where_their_ends_say),
        cmocka_unit_test(colours_cover_as_their_alpha_says),
        cmocka_unit_test(pixels_are_copied_and_enlarged),
    };
    return cmocka_run_group_tests_name("draw", tests, NULL, NULL) ? 1 : 0;
}

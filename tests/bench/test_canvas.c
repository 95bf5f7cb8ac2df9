/* What a drawing has as pixels and as SVG (bench/chart/canvas.h). */
#define _POSIX_C_SOURCE 200809L /* open_memstream */

#include "bench/chart/canvas.h"
#include "bench/chart/svg.h"
#include "scenes/picture/draw.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE   96
#define INK    0xFF2040C0u
#define X      48
#define Y      40
#define HEIGHT 9 /* of a character; its last two rows are below the base line */

static struct image blank(void)
{
    struct image image;
    struct reason reason;
    assert_int_equal(image_make(SIDE, SIDE, &image, &reason), STATUS_OK);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        image.pixel[i] = 0xFFFFFFFFu;
    return image;
}

static void same_pictures(const struct image *is, const struct image *want)
{
    for (size_t i = 0; i < SIDE * SIDE; i++)
        if (is->pixel[i] != want->pixel[i])
            fail_msg("pixel %zu, %zu", i % SIDE, i / SIDE);
}

/* What is drawn as SVG, without head and foot. */
static char *drawn(struct image *image, double y, enum canvas_anchor anchor, const char *text)
{
    char *file = NULL;
    size_t bytes = 0;
    FILE *stream = open_memstream(&file, &bytes);
    assert_non_null(stream);
    const struct canvas canvas = {stream, image};
    canvas_text(&canvas, X, y, anchor, INK, text);
    assert_int_equal(fclose(stream), 0);
    return file;
}

/* Texts of even and odd width: a character has 5 columns of dots and one between. */
static void text_is_where_its_anchor_puts_it(void **state)
{
    (void)state;
    static const char *const texts[] = {"|", "HgW", "four"};
    static const char *const anchors[] = {"start", "middle", "end"};
    for (size_t t = 0; t < ARRAY_COUNT(texts); t++) {
        int width = (int)draw_text_width(texts[t], 1);
        for (enum canvas_anchor anchor = CANVAS_START; anchor <= CANVAS_UP; anchor++) {
            struct image is = blank(), want = blank();
            char attribute[64];
            char *svg = drawn(&is, Y, anchor, texts[t]);
            if (anchor == CANVAS_UP)
                draw_text_up(&want, X - HEIGHT + 2, Y + width / 2, 1, INK, texts[t]);
            else
                draw_text(&want, X - (int[]){0, width / 2, width}[anchor], Y - HEIGHT + 2, 1, INK,
                          texts[t]);
            same_pictures(&is, &want);
            assert_non_null(strstr(svg, texts[t]));
            snprintf(attribute, sizeof attribute, "text-anchor=\"%s\" fill=\"#",
                     anchors[anchor % 3]);
            assert_int_equal(anchor != CANVAS_UP, strstr(svg, attribute) != NULL);
            assert_int_equal(anchor == CANVAS_UP, strstr(svg, "rotate(") != NULL);
            free(svg);
            image_free(&is);
            image_free(&want);
        }
    }
}

/* The ink and the gaps of each pattern, as canvas.c has them and SVG is told. */
static const double pattern[CANVAS_DASHES][6] = {
    {0}, {8, 4}, {2, 4}, {10, 4, 2, 4}, {16, 4}, {5, 3}, {16, 4, 5, 4}, {10, 4, 2, 4, 2, 4}};

/* Whether there is ink at a place of a pattern; -1: beside an end of it. */
static int inked_at(const double *dash, double at)
{
    double length = 0;
    for (int k = 0; k < 6; k++)
        length += dash[k];
    if (length == 0)
        return 1;
    at = fmod(at, length);
    for (int k = 0; k < 6; k++) {
        if (at < dash[k])
            return at < 1 || at > dash[k] - 1 ? -1 : k % 2 == 0;
        at -= dash[k];
    }
    return -1;
}

/* A row of points on a line: the pattern goes on from one to the next. */
static void dashes_go_on_along_a_line(void **state)
{
    (void)state;
    static const double point[4][2] = {{2, 20.5}, {13, 20.5}, {17.5, 20.5}, {90, 20.5}};
    for (unsigned dash = 0; dash < 2 * CANVAS_DASHES; dash++) {
        const struct canvas_pen pen = {1, dash, INK};
        struct image image = blank(), two = blank();
        char *file = NULL, told[96] = "";
        size_t bytes = 0;
        FILE *stream = open_memstream(&file, &bytes);
        assert_non_null(stream);
        const struct canvas canvas = {stream, &image}, alone = {NULL, &two};
        canvas_lines(&canvas, point, 4, &pen);
        assert_int_equal(fclose(stream), 0);
        canvas_line(&alone, point[0][0], point[0][1], point[3][0], point[3][1], &pen);
        const double *of = pattern[dash % CANVAS_DASHES];
        for (int x = 3; x < 89; x++) {
            int ink = inked_at(of, x + 0.5 - point[0][0]);
            if (ink < 0)
                continue;
            if ((image.pixel[20 * SIDE + x] == INK) != ink ||
                (two.pixel[20 * SIDE + x] == INK) != ink)
                fail_msg("dash %u, column %d: ink %d", dash, x, ink);
        }
        for (int k = 0; k < 6 && of[k] > 0; k++)
            snprintf(told + strlen(told), sizeof told - strlen(told), "%s%.0f",
                     k ? " " : "stroke-dasharray=\"", of[k]);
        if (of[0] > 0)
            strcat(told, "\"");
        assert_non_null(strstr(file, told));
        assert_int_equal(of[0] > 0, strstr(file, "dasharray") != NULL);
        assert_non_null(strstr(file, "points=\"2.0,20.5 13.0,20.5 17.5,20.5 90.0,20.5\""));
        assert_non_null(strstr(file, "stroke-width=\"1.0\""));
        free(file);
        image_free(&image);
        image_free(&two);
    }
}

/* A single point is a dot; no point is nothing. */
static void a_point_is_a_dot(void **state)
{
    (void)state;
    static const double point[1][2] = {{X, Y}};
    const struct canvas_pen pen = {1, 3, INK};
    for (size_t count = 0; count < 2; count++) {
        struct image is = blank(), want = blank();
        char *file = NULL;
        size_t bytes = 0;
        FILE *stream = open_memstream(&file, &bytes);
        assert_non_null(stream);
        const struct canvas canvas = {stream, &is}, none = {stream, NULL};
        canvas_lines(&canvas, point, count, &pen);
        if (count)
            draw_line(&want, X, Y, X, Y, 4, INK);
        same_pictures(&is, &want);
        canvas_lines(&none, point, count, &pen);
        assert_int_equal(fclose(stream), 0);
        if (count)
            assert_non_null(strstr(file, "<circle cx=\"48.0\" cy=\"40.0\" r=\"2.0\" fill=\"#"));
        else
            assert_int_equal(bytes, 0);
        free(file);
        image_free(&is);
        image_free(&want);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_is_where_its_anchor_puts_it),
        cmocka_unit_test(dashes_go_on_along_a_line),
        cmocka_unit_test(a_point_is_a_dot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Line charts: the same lines as SVG and as PNG, where the numbers say, with gaps where there are
 * none. */
#define _GNU_SOURCE /* mkdtemp, open_memstream */
#include "bench/chart/chart.h"

#include "scenes/picture/colour.h"
#include "ref/files/file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/root.h"
#include "tests/readers/well_formed.h"

static struct chart chart_of(const struct chart_series *series, size_t count)
{
    return (struct chart){.title = "title <&> \"quotes\" \x01",
                          .x_label = "Frame",
                          .y_label = CHART_DURATION,
                          .unit = "ms",
                          .series = series,
                          .series_count = count};
}

static struct chart_series series_of(const char *name, const double *value, size_t count)
{
    return (struct chart_series){name, 0, NAN, NAN, NAN, value, count};
}

/* The document, which is well-formed and names no number that is none; the caller frees it. */
static char *drawn(const struct chart *chart)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    chart_svg(stream, chart);
    assert_int_equal(fclose(stream), 0);
    if (!well_formed(text))
        fail_msg("%s", text);
    assert_int_equal(occurrences(text, "nan") + occurrences(text, "inf"), 0);
    return text;
}

/* Points of the n-th line in a colour; 0 if there is none. */
static size_t points_of(const char *text, uint32_t colour, size_t n, double (*point)[2],
                        size_t most)
{
    char name[8], begin[80];
    colour_text(colour, name);
    snprintf(begin, sizeof begin, "<polyline fill=\"none\" stroke=\"%s\"", name);
    for (size_t i = 0; i <= n; i++) {
        text = strstr(text, begin);
        if (!text)
            return 0;
        text++;
    }
    text = strstr(text, "points=\"") + strlen("points=\"");
    size_t count = 0;
    int length;
    while (count < most &&
           sscanf(text, "%lf,%lf%n", &point[count][0], &point[count][1], &length) == 2) {
        count++;
        text += length;
    }
    return count;
}

/* A pixel at the place or beside it, where lines are smooth, has nearly this colour. */
static bool has_colour(const struct image *image, double x, double y, uint32_t colour)
{
    for (int k = 0; k < 9; k++) {
        size_t i =
            ((size_t)y + (size_t)(k / 3) - 1) * image->width + (size_t)x + (size_t)(k % 3) - 1;
        bool near = true;
        for (int shift = 0; shift < 24; shift += 8)
            near = near &&
                   abs((int)(image->pixel[i] >> shift & 255) - (int)(colour >> shift & 255)) < 60;
        if (near)
            return true;
    }
    return false;
}

static void legends_say_who_and_how_much(void **state)
{
    (void)state;
    const double value[] = {1, 2, 3};
    const struct chart_series series[] = {{"rf16 <vulkan>", 656, 2, 1, 3, value, 3},
                                          {"embree", 0, 0.125, 0.1, 0.5, value, 3},
                                          {"naive", 48, NAN, NAN, NAN, value, 3}};
    struct chart chart = chart_of(series, 3);
    char *text = drawn(&chart);
    assert_int_equal(occurrences(text, ">rf16 &lt;vulkan&gt;<"), 1);
    assert_int_equal(occurrences(text, ">656 bytes; average 2, 1 to 3 ms<"), 1);
    assert_int_equal(occurrences(text, ">average 0.125, 0.1 to 0.5 ms<"), 1);
    assert_int_equal(occurrences(text, ">48 bytes<"), 1);
    assert_int_equal(occurrences(text, ">Compute pass duration (ms)<"), 1);
    assert_int_equal(occurrences(text, ">Frame<"), 1);
    assert_int_equal(occurrences(text, ">title &lt;&amp;&gt; &quot;quotes&quot; <"), 2);
    free(text);
}

static void lines_are_where_their_numbers_say(void **state)
{
    (void)state;
    const double value[] = {10, 20, 40, 30};
    const struct chart_series series[] = {series_of("a", value, 4)};
    struct chart chart = chart_of(series, 1);
    chart.x_count = 7;
    char *text = drawn(&chart);
    double point[8][2];
    assert_int_equal(points_of(text, colour_of_class(0), 0, point, 8), 4);
    const double step = point[1][0] - point[0][0], per = (point[0][1] - point[1][1]) / 10;
    assert_true(per > 5); /* up is more */
    for (int i = 0; i < 4; i++) {
        assert_true(fabs(point[i][0] - (point[0][0] + step * i)) < 0.11);
        assert_true(fabs(point[i][1] - (point[0][1] - per * (value[i] - 10))) < 0.3);
    }
    assert_true(fabs(6 * step - 640) < 1); /* room for seven */
    /* The PNG has the line there, too. */
    struct image image;
    struct reason reason;
    assert_int_equal(chart_image(&chart, &image, &reason), STATUS_OK);
    for (int i = 1; i < 4; i++)
        assert_true(has_colour(&image, point[i][0], point[i][1], colour_of_class(0)));
    for (int i = 0; i < 3; i++) {
        double x = 0.5 * (point[i][0] + point[i + 1][0]), y = 0.5 * (point[i][1] + point[i + 1][1]);
        assert_false(has_colour(&image, x, y + 9, colour_of_class(0)));
    }
    image_free(&image);
    free(text);
}

static void missing_values_are_gaps(void **state)
{
    (void)state;
    const double value[] = {NAN, 1, 2, NAN, 3, INFINITY, 2, 1, 2, -INFINITY};
    const struct chart_series series[] = {series_of("a", value, 10)};
    struct chart chart = chart_of(series, 1);
    char *text = drawn(&chart);
    double point[8][2];
    assert_int_equal(points_of(text, colour_of_class(0), 0, point, 8), 2);
    assert_int_equal(points_of(text, colour_of_class(0), 1, point, 8), 3);
    assert_int_equal(points_of(text, colour_of_class(0), 2, point, 8), 0);
    assert_int_equal(occurrences(text, "<circle"), 1); /* a value alone is a dot */
    free(text);
}

static void any_number_of_values_has_a_chart(void **state)
{
    (void)state;
    static const double few[][3] = {
        {5, 5, 5},    {0, 0, 0},      {NAN, NAN, NAN},       {1e300, -1e300, 0},
        {-3, -2, -1}, {5e-324, 0, 1}, {1e308, 1e308, -1e308}};
    for (size_t i = 0; i < ARRAY_COUNT(few); i++)
        for (size_t count = 0; count <= 3; count++) {
            const struct chart_series series[] = {series_of("a", few[i], count)};
            struct chart chart = chart_of(series, count ? 1 : 0);
            chart.title = NULL;
            char *text = drawn(&chart);
            struct image image;
            assert_int_equal(chart_image(&chart, &image, NULL), STATUS_OK);
            size_t numbers = occurrences(text, "text-anchor=\"end\"");
            assert_in_range(numbers, 2, 12); /* the y axis says something */
            if (count == 1 && isfinite(few[i][0]))
                assert_int_equal(occurrences(text, "<circle"), 1);
            image_free(&image);
            free(text);
        }
}

/* More values than pixels: what stands out stays, the file stays small. */
static void no_outlier_is_lost(void **state)
{
    (void)state;
    enum { MANY = 100000 };
    double *value = alloc_zeroed(MANY, sizeof *value), (*point)[2] = alloc_zeroed(MANY, 16);
    assert_true(value && point);
    for (int i = 0; i < MANY; i++)
        value[i] = 1 + 0.001 * (i % 7);
    value[12345] = 9;
    value[77777] = 0.5;
    value[55555] = NAN;
    const struct chart_series series[] = {series_of("a", value, MANY)};
    struct chart chart = chart_of(series, 1);
    char *text = drawn(&chart);
    assert_true(strlen(text) < 40000);
    double highest = 1e9, lowest = 0, at_highest = 0, at_lowest = 0;
    for (size_t run = 0; run < 2; run++) {
        size_t count = points_of(text, colour_of_class(0), run, point, MANY);
        assert_in_range(count, 100, 1280);
        for (size_t i = 0; i < count; i++) {
            assert_true(i == 0 || point[i][0] >= point[i - 1][0]);
            if (point[i][1] < highest)
                at_highest = point[i][0];
            if (point[i][1] > lowest)
                at_lowest = point[i][0];
            highest = fmin(highest, point[i][1]);
            lowest = fmax(lowest, point[i][1]);
        }
    }
    assert_int_equal(points_of(text, colour_of_class(0), 2, point, MANY), 0);
    assert_true(fabs(at_highest - (70 + 640 * 12345.0 / (MANY - 1))) < 0.2);
    assert_true(fabs(at_lowest - (70 + 640 * 77777.0 / (MANY - 1))) < 0.2);
    assert_true(lowest - highest > 300);
    free(text);
    free(value);
    free(point);
}

static void many_series_have_room(void **state)
{
    (void)state;
    const double value[] = {1, 2};
    struct chart_series series[600];
    for (size_t i = 0; i < ARRAY_COUNT(series); i++)
        series[i] = series_of(
            "a name that is rather long, and so is what it is about, and more, and more", value, 2);
    struct image image;
    struct reason reason;
    struct chart chart = chart_of(series, 32);
    assert_int_equal(chart_image(&chart, &image, &reason), STATUS_OK);
    assert_true(image.height > 32 * 30);
    image_free(&image);
    chart.series_count = ARRAY_COUNT(series);
    assert_int_equal(chart_image(&chart, &image, &reason), STATUS_INPUT);
    assert_null(image.pixel);
}

/* A pixel of the column, in this row or beside it, has nearly this colour. */
static bool is_inked(const struct image *image, size_t x, size_t row, uint32_t colour)
{
    for (size_t y = row - 1; y <= row + 1; y++) {
        int off = 0;
        for (int shift = 0; shift < 24; shift += 8)
            off += abs((int)(image->pixel[y * image->width + x] >> shift & 255) -
                       (int)(colour >> shift & 255));
        if (off < 240)
            return true;
    }
    return false;
}

/* Each of 16 series has dashes or a width of its own; in a picture gaps are white. */
static void lines_differ_without_their_colours(void **state)
{
    (void)state;
    enum { COUNT = 16 };
    const double value[] = {1, 1};
    struct chart_series series[COUNT];
    char look[COUNT][80] = {""};
    for (size_t i = 0; i < COUNT; i++)
        series[i] = series_of("x", value, 2);
    struct chart chart = chart_of(series, COUNT);
    char *text = drawn(&chart);
    const char *at = strstr(text, "<polyline ") + 1; /* the first one frames the plot */
    for (size_t i = 0; i < COUNT; i++) {
        at = strstr(at, "<polyline ") + 1;
        const char *width = strstr(at, "stroke-width"), *end = strstr(at, " points");
        snprintf(look[i], sizeof look[i], "%.*s", (int)(end - width), width);
        assert_true((strstr(look[i], "dasharray") != NULL) == (i % 8 != 0));
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(look[i], look[k]);
    }
    free(text);
    for (size_t i = 0; i < 2;
         i++) { /* the first and second line alone, at the middle of the plot */
        chart = chart_of(series, i + 1);
        struct image image;
        struct reason reason;
        assert_int_equal(chart_image(&chart, &image, &reason), STATUS_OK);
        text = drawn(&chart);
        double point[2][2];
        assert_int_equal(points_of(text, colour_of_class(i), 0, point, 2), 2);
        size_t row = (size_t)point[0][1], ink = 0;
        for (size_t x = 100; x < 220; x++) /* dashes of 8 with round ends, gaps of 4 */
            ink += is_inked(&image, x, row, colour_of_class(i));
        if (i == 0 ? ink != 120 : ink < 70 || ink > 105)
            fail_msg("line %zu has ink in %zu of 120 columns", i, ink);
        free(text);
        image_free(&image);
    }
}

static void files_are_written_whole(void **state)
{
    (void)state;
    const double value[] = {1, 2, 1.5};
    const struct chart_series series[] = {series_of("a", value, 3)};
    struct chart chart = chart_of(series, 1);
    struct reason reason;
    struct image image, read;
    char svg[300], png[300], *bytes, *text = drawn(&chart);
    size_t size;
    snprintf(svg, sizeof svg, "%s/chart.svg", root);
    snprintf(png, sizeof png, "%s/chart.png", root);
    for (int i = 0; i < 2; i++) /* written again and again */
        assert_int_equal(chart_write(&chart, svg, png, &reason), STATUS_OK);
    assert_int_equal(file_read(svg, &bytes, &size, &reason), STATUS_OK);
    assert_string_equal(bytes, text);
    assert_int_equal(chart_image(&chart, &image, &reason), STATUS_OK);
    assert_int_equal(image_read(png, &read, &reason), STATUS_OK);
    assert_memory_equal(read.pixel, image.pixel, 4 * (size_t)image.width * image.height);
    assert_int_equal(chart_write(&chart, NULL, NULL, &reason), STATUS_OK);
    snprintf(svg, sizeof svg, "%s/none/chart.svg", root);
    assert_int_equal(chart_write(&chart, svg, png, &reason), STATUS_INPUT);
    assert_int_equal(chart_write(&chart, NULL, svg, &reason), STATUS_INPUT);
    image_free(&image);
    image_free(&read);
    free(bytes);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(legends_say_who_and_how_much),
        cmocka_unit_test(lines_are_where_their_numbers_say),
        cmocka_unit_test(missing_values_are_gaps),
        cmocka_unit_test(any_number_of_values_has_a_chart),
        cmocka_unit_test(no_outlier_is_lost),
        cmocka_unit_test(many_series_have_room),
        cmocka_unit_test(lines_differ_without_their_colours),
        cmocka_unit_test(files_are_written_whole),
    };
    return cmocka_run_group_tests_name("chart", tests, make_root, remove_root) ? 1 : 0;
}

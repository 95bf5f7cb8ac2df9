/* The SVG plot: well-formed whatever the texts, every point where its numbers put it. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "bench/chart/plot.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/readers/well_formed.h"

static void the_parser_knows_broken_xml(void **state)
{
    (void)state;
    assert_true(well_formed("<a><b c=\"1\"/>text &amp; more</a>"));
    static const char *const broken[] = {"<a>",      "<a></b>",      "<a><b></a></b>", "<a c=1/>",
                                         "<a>&</a>", "<a c=\"<\"/>", "<a/><a/>",       "<a>&x;</a>",
                                         "<a></aa>", "<a c=\"1/>",   "< a/>",          "<a>\1</a>"};
    for (size_t i = 0; i < ARRAY_COUNT(broken); i++)
        if (well_formed(broken[i]))
            fail_msg("%s", broken[i]);
}

static const struct plot_series series[] = {{"first <&> \"one\"", 0, 0, 0}, {"second", 1, 0, 1}};

static struct plot_figure figure_of(const struct plot_point *point, size_t count)
{
    struct plot_figure figure = {.title = "title <script> & \"quotes\" \x01",
                                 .subtitle = "sub",
                                 .series = series,
                                 .series_count = ARRAY_COUNT(series),
                                 .panel_count = 1};
    figure.panel[0] = (struct plot_panel){"panel", "x (unit)", "y > 0 (unit)", point, count};
    return figure;
}

/* The document; the caller frees it. */
/* noinline: gcc 12 takes the text for a local of open_memstream. */
__attribute__((noinline)) static char *drawn(const struct plot_figure *figure, size_t count)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    plot_write(stream, figure, count);
    assert_int_equal(fclose(stream), 0);
    return text;
}

/* Centres of the circles, in order; the legend's come last. */
static size_t circles(const char *text, double (*centre)[2], size_t most)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, "<circle ")) && count < most; at++, count++)
        assert_int_equal(
            sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\"", &centre[count][0], &centre[count][1]), 2);
    return count;
}

static struct plot_point point_at(size_t s, double x, double y)
{
    return (struct plot_point){s, x, x, x, y, y, y, false};
}

static void documents_are_well_formed_whatever_the_texts(void **state)
{
    (void)state;
    const struct plot_point point[] = {{0, 1, 0.5, 2, 10, 1, 1000, false},
                                       {1, 3, 3, 3, 45, 45, 45, true}};
    struct plot_figure figure[2] = {figure_of(point, 2), figure_of(point, 2)};
    figure[1].panel[1] = figure[1].panel[0];
    figure[1].panel_count = 2;
    char *text = drawn(figure, 2);
    if (!well_formed(text))
        fail_msg("%s", text);
    assert_int_equal(occurrences(text, "<script>"), 0);
    assert_int_equal(occurrences(text, ">title &lt;script&gt; &amp; &quot;quotes&quot; <"), 3);
    assert_int_equal(occurrences(text, "x (unit)"), 3);
    assert_int_equal(occurrences(text, "y &gt; 0 (unit)"), 3);
    assert_int_equal(occurrences(text, "second"), 2);
    free(text);
}

static void points_stand_where_their_logarithms_say(void **state)
{
    (void)state;
    const struct plot_point point[] = {point_at(0, 1, 0.1), point_at(0, 10, 10),
                                       point_at(1, 100, 1000)};
    struct plot_figure figure = figure_of(point, 3);
    char *text = drawn(&figure, 1);
    double centre[8][2];
    assert_int_equal(circles(text, centre, 8), 3 + ARRAY_COUNT(series));
    assert_true(fabs(centre[1][0] - centre[0][0] - (centre[2][0] - centre[1][0])) <= 0.2);
    assert_true(centre[1][0] - centre[0][0] > 50);
    assert_true(fabs(centre[0][1] - centre[1][1] - (centre[1][1] - centre[2][1])) <= 0.2);
    assert_true(centre[0][1] - centre[1][1] > 30); /* up is more */
    free(text);
}

static void what_cannot_be_drawn_is_left_out(void **state)
{
    (void)state;
    const struct plot_point point[] = {point_at(0, 1, NAN), point_at(0, 0, 1), point_at(0, NAN, 1),
                                       point_at(0, 1, INFINITY), point_at(1, 2, 0)};
    struct plot_figure figure = figure_of(point, 5);
    char *text = drawn(&figure, 1);
    double centre[16][2];
    assert_true(well_formed(text));
    assert_int_equal(circles(text, centre, 16), 1 + ARRAY_COUNT(series));
    assert_int_equal(occurrences(text, "nan") + occurrences(text, "inf"), 0);
    free(text);
    figure = figure_of(NULL, 0);
    text = drawn(&figure, 1);
    assert_true(well_formed(text));
    assert_int_equal(circles(text, centre, 16), ARRAY_COUNT(series));
    assert_int_equal(occurrences(text, "nan") + occurrences(text, "inf"), 0);
    free(text);
}

/* What no logarithm has stands on the axis, as a value or as the low end of a bar, and changes no
 * other point; what is left out changes nothing. */
static void zero_stands_on_the_axis(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        struct plot_point point[4] = {point_at(0, 1, 0.25), point_at(1, 10, 40), point_at(0, 3, 7),
                                      point_at(0, 3, 7)};
        struct plot_figure figure = figure_of(point, 3);
        double before[8][2], after[8][2];
        char *text = drawn(&figure, 1);
        const size_t count = circles(text, before, 8);
        free(text);
        double *const zero[] = {&point[3].y, &point[3].y_lo, &point[3].x_lo};
        *zero[k % 3] = 0;
        if (k >= 3) { /* not drawn at all */
            point[3].x = k == 3 ? 0 : k == 4 ? NAN : -1;
            point[3].y_hi = 1e9;
        }
        figure = figure_of(point, 4);
        text = drawn(&figure, 1);
        assert_int_equal(occurrences(text, "nan") + occurrences(text, "inf"), 0);
        assert_int_equal(circles(text, after, 8), count + (k < 3));
        assert_memory_equal(before, after, 3 * sizeof before[0]);
        if (k == 0) { /* as low as the frame is */
            double y, height;
            const char *frame = strstr(text, "<rect x=\"");
            assert_int_equal(sscanf(strstr(frame, " y=\""), " y=\"%lf\"", &y), 1);
            assert_int_equal(sscanf(strstr(frame, "height=\""), "height=\"%lf\"", &height), 1);
            assert_true(fabs(after[3][1] - (y + height)) < 0.2);
        }
        free(text);
    }
}

static void an_upper_limit_has_an_arrow(void **state)
{
    (void)state;
    struct plot_point point[] = {point_at(0, 1, 45), point_at(1, 2, 900)};
    struct plot_figure figure = figure_of(point, 2);
    char *without = drawn(&figure, 1);
    point[0].below = true;
    char *with = drawn(&figure, 1);
    assert_int_equal(occurrences(without, "l-3.5,-5h7z"), 0);
    assert_int_equal(occurrences(with, "l-3.5,-5h7z"), 1);
    free(without);
    free(with);
}

/* No two of 24 series differ by their colour alone; a pair that nothing else has stays. */
static void series_differ_without_their_colours(void **state)
{
    (void)state;
    enum { MOST = PLOT_SHAPES * PLOT_FILLS };
    struct plot_series many[MOST + 1];
    for (unsigned i = 0; i <= MOST; i++)
        many[i] = (struct plot_series){"name", i, i < 2 ? 5 + PLOT_SHAPES * i : 3, i % 2 ? 1 : 2};
    plot_tell_apart(many, MOST + 1);
    assert_true(many[0].shape == 5 && many[0].fill == 2 && many[1].shape == 5 && many[1].fill == 1);
    assert_true(many[2].shape == 3 && many[2].fill == 2 && many[3].shape == 3 && many[3].fill == 1);
    for (size_t i = 0; i < MOST; i++)
        for (size_t k = 0; k < i; k++)
            if (many[i].shape == many[k].shape && many[i].fill == many[k].fill)
                fail_msg("%zu and %zu look the same", i, k);
    /* Each shape and fill is drawn in a way of its own. */
    char *text[MOST];
    for (size_t i = 0; i < MOST; i++) {
        many[i].colour = 0;
        struct plot_figure figure = {
            .title = "t", .subtitle = "s", .series = &many[i], .series_count = 1, .panel_count = 1};
        figure.panel[0] = (struct plot_panel){"panel", "x", "y", NULL, 0};
        text[i] = drawn(&figure, 1);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(text[i], text[k]);
    }
    for (size_t i = 0; i < MOST; i++)
        free(text[i]);
}

static double width_of(const char *document)
{
    static const char box[] = "viewBox=\"0 0 ";
    return strtod(strstr(document, box) + strlen(box), NULL);
}

/* Where a text begins; -1 if there is none. */
static double left_of(const char *document, const char *wanted)
{
    double x;
    for (const char *at = document; (at = strstr(at, "<text x=\"")); at++)
        if (strncmp(strchr(at, '>') + 1, wanted, strlen(wanted)) == 0 &&
            sscanf(at, "<text x=\"%lf", &x) == 1)
            return x;
    return -1;
}

/* Nothing ends beyond the right edge: a character takes at most 0.66 of the letters' height. */
static void texts_end_within_the_document(void **state)
{
    (void)state;
    char name[90], long_title[140];
    memset(name, 'm', sizeof name - 1);
    memset(long_title, 'm', sizeof long_title - 1);
    name[sizeof name - 1] = long_title[sizeof long_title - 1] = '\0';
    const struct plot_series named[] = {{"short", 0, 0, 0}, {name, 1, 1, 1}};
    for (int which = 0; which < 3; which++) {
        struct plot_figure figure = figure_of(NULL, 0);
        figure.series = which == 0 ? named : series;
        figure.title = which == 1 ? long_title : "title";
        figure.subtitle = which == 2 ? long_title : "sub";
        char *text = drawn(&figure, 1);
        const char *wide = which == 0 ? name : long_title;
        double width = width_of(text), x = left_of(text, wide);
        assert_true(x > 0);
        if (!(x + 0.66 * (which == 1 ? 15 : 11) * (double)strlen(wide) <= width))
            fail_msg("%g wide, a text from %g on is cut", width, x);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_parser_knows_broken_xml),
        cmocka_unit_test(documents_are_well_formed_whatever_the_texts),
        cmocka_unit_test(points_stand_where_their_logarithms_say),
        cmocka_unit_test(what_cannot_be_drawn_is_left_out),
        cmocka_unit_test(zero_stands_on_the_axis),
        cmocka_unit_test(an_upper_limit_has_an_arrow),
        cmocka_unit_test(series_differ_without_their_colours),
        cmocka_unit_test(texts_end_within_the_document),
    };
    return cmocka_run_group_tests_name("plot", tests, NULL, NULL) ? 1 : 0;
}

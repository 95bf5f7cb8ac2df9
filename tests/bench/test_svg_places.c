/* Where a plot's and a chart's marks stand: ticks, grid, bars, arrows, texts, panels and legend,
 * read back from the SVG, against the numbers that they show. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "bench/chart/chart.h"
#include "bench/chart/plot.h"

#include "tests/bench/svg_reader.h"

static void read_panel(struct svg_reader *r, struct sheet_panel *p)
{
    double width, height;
    const char *line = read_grid(r, p);
    assert_int_equal(sscanf(line, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"",
                            &p->left, &p->top, &width, &height),
                     4);
    p->right = p->left + width;
    p->bottom = p->top + height;
    check_grid(r, p);
}

/* Where a value belongs by the first and the last tick of a logarithmic axis. */
static double place(const struct sheet_panel *p, int axis, double value)
{
    const double *v = p->value[axis], *at = p->at[axis];
    size_t last = p->count[axis] - 1;
    return at[0] + (at[last] - at[0]) * log(value / v[0]) / log(v[last] / v[0]);
}

/* Values that no axis has are drawn at its begin. */
static double place_y(const struct sheet_panel *p, double value)
{
    return value > 0 ? fmin(place(p, 1, value), p->bottom) : p->bottom;
}

static void same_line(struct svg_reader *r, double x1, double y1, double x2, double y2)
{
    double at[4];
    read_line(r, next_line(r), at);
    near(at[0], x1, "a bar's begin along x");
    near(at[1], y1, "a bar's begin along y");
    near(at[2], x2, "a bar's end along x");
    near(at[3], y2, "a bar's end along y");
}

static bool differ(double a, double b)
{
    return fabs(a - b) > 0;
}

static void check_point(struct svg_reader *r, const struct sheet_panel *p,
                        const struct plot_point *point)
{
    double x = place(p, 0, point->x), y = place_y(p, point->y), is_x, is_y;
    if (differ(point->x_lo, point->x) || differ(point->x_hi, point->x))
        same_line(r, place(p, 0, point->x_lo), y, place(p, 0, point->x_hi), y);
    if (differ(point->y_lo, point->y) || differ(point->y_hi, point->y))
        same_line(r, x, place_y(p, point->y_lo), x, place_y(p, point->y_hi));
    if (point->below) {
        double end = fmin(y + 17, p->bottom), to_x, to_y;
        same_line(r, x, y, x, end);
        const char *head = next_line(r);
        assert_int_equal(sscanf(head, "<path d=\"M%lf,%lfl-3.5,-5h7z\"", &to_x, &to_y), 2);
        near(to_x, x, "an arrow's head along x");
        near(to_y, end, "an arrow's head along y");
    }
    read_marker(r, next_line(r), &is_x, &is_y);
    near(is_x, x, "a marker along x");
    near(is_y, y, "a marker along y");
    assert_true(is_x > p->left && is_x < p->right && is_y > p->top - NEAR && is_y <= p->bottom);
}

/* Titles stand over the panel, the axes' names below and beside it. */
static void check_names(struct svg_reader *r, const struct sheet_panel *p,
                        const struct plot_panel *panel)
{
    double x, y, middle = 0.5 * (p->left + p->right);
    assert_string_equal(read_text(r, next_line(r), &x, &y), panel->x_label);
    near(x, middle, "the x axis' name");
    assert_true(y > p->bottom + 20);
    assert_string_equal(read_text(r, next_line(r), &x, &y), panel->title);
    near(x, middle, "the title");
    assert_true(y < p->top && y > p->top - 20);
    assert_string_equal(read_text(r, next_line(r), &x, &y), panel->y_label);
    near(y, 0.5 * (p->top + p->bottom), "the y axis' name");
    assert_true(x < p->left - 40);
}

/* Checks a figure whose highest part is below `above`; returns the end of its lowest. */
static double check_figure(struct svg_reader *r, const struct plot_figure *figure, double above)
{
    double x, y, below, right = 0, bottom = 0;
    assert_string_equal(read_text(r, next_line(r), &x, &y), figure->title);
    assert_true(y - 10 > above);
    below = y;
    assert_string_equal(read_text(r, next_line(r), &x, &y), figure->subtitle);
    assert_true(y - 11 > below);
    for (size_t i = 0; i < figure->panel_count; i++) {
        const struct plot_panel *panel = &figure->panel[i];
        struct sheet_panel p;
        read_panel(r, &p);
        assert_true(p.left - 60 > right && p.top - 18 > y);
        check_names(r, &p, panel);
        for (size_t k = 0; k < panel->count; k++)
            check_point(r, &p, &panel->point[k]);
        right = p.right;
        bottom = p.bottom;
    }
    for (size_t i = 0; i < figure->series_count; i++) {
        double at_x, at_y;
        read_marker(r, next_line(r), &at_x, &at_y);
        assert_true(at_x > right + 6 && at_y > (i ? below + 12 : y));
        below = at_y;
        assert_string_equal(read_text(r, next_line(r), &x, &y), figure->series[i].name);
        assert_true(x > at_x + 6);
        near(y, at_y + 4, "a name in the legend");
    }
    return fmax(bottom + 33, below);
}

static char *drawn_plot(const struct plot_figure *figure, size_t count)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    plot_write(stream, figure, count);
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void every_mark_of_a_plot_stands_where_its_numbers_say(void **state)
{
    (void)state;
    const struct plot_series series[] = {
        {"circle", 0, 0, 0}, {"square", 1, 1, 1}, {"diamond", 2, 2, 2}, {"triangle", 3, 3, 0}};
    const struct plot_point ray[] = {
        {0, 1, 0.5, 2, 10, 1, 1000, false},     {1, 300, 300, 300, 45, 45, 45, true},
        {2, 20, 15, 20, 3, 3, 30, false},       {3, 77, 77, 99, 0, 0, 0, false},
        {0, 0.7, 0.7, 0.7, 100, 0, 200, false}, {1, 5, 5, 5, 1.01, 1.01, 1.01, true}};
    const struct plot_point other[] = {{3, 1e4, 9e3, 2e4, 1e-3, 5e-4, 2e-3, true},
                                       {2, 6e5, 6e5, 6e5, 8e5, 8e5, 8e5, false}};
    struct plot_figure figure[2] = {
        {"title", "sub", series, 4, {{"one", "x one", "y one", ray, 6}}, 1},
        {"second", "its sub", series, 2, {{"a", "x a", "y a", ray, 6}}, 3}};
    figure[1].panel[1] = (struct plot_panel){"b", "x b", "y b", other, 2};
    figure[1].panel[2] = (struct plot_panel){"c", "x c", "y c", ray + 2, 4};
    struct svg_reader r = opened(drawn_plot(figure, 2));
    double end = check_figure(&r, &figure[0], 0);
    check_figure(&r, &figure[1], end);
    assert_null(next_line(&r));
    free(r.text);
}

/* A y axis begins below the least value, with room for a marker, but not by a decade too much. */
static void an_axis_begins_a_little_below_its_values(void **state)
{
    (void)state;
    const struct plot_series series[] = {{"s", 0, 0, 0}};
    static const struct {
        double least, begin;
    } cases[] = {{1, 0.1},    {1.2, 0.1}, {1.25, 1},  {1.3, 1},      {9.9, 1},
                 {10, 1},     {12.4, 1},  {12.5, 10}, {0.012, 1e-3}, {0.013, 0.01},
                 {1250, 1e3}, {99, 10},   {100, 10},  {3e5, 1e5}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        double least = cases[i].least;
        const struct plot_point point[] = {{0, 1, 1, 1, least, least, least, false},
                                           {0, 500, 500, 500, least, least, least * 30, false}};
        struct plot_figure figure = {"t", "s", series, 1, {{"p", "x", "y", point, 2}}, 1};
        struct svg_reader r = opened(drawn_plot(&figure, 1));
        struct sheet_panel p;
        double x, y;
        for (int k = 0; k < 2; k++)
            (void)read_text(&r, next_line(&r), &x, &y);
        read_panel(&r, &p);
        near(place(&p, 1, cases[i].begin), p.bottom, "the axis' begin");
        near(place(&p, 1, pow(10, ceil(log10(30 * least)))), p.top, "the axis' end");
        near(place(&p, 0, 1 / 1.3), p.left, "the x axis' begin");
        near(place(&p, 0, 500 * 1.3), p.right, "the x axis' end");
        free(r.text);
    }
}

/* A line's points from its element; returns how many. */
static size_t read_points(const char *line, double (*point)[2], size_t most)
{
    const char *text = strstr(line, "points=\"");
    assert_non_null(text);
    text += strlen("points=\"");
    size_t count = 0;
    int length;
    while (count < most &&
           sscanf(text, "%lf,%lf%n", &point[count][0], &point[count][1], &length) == 2) {
        count++;
        text += length;
    }
    return count;
}

/* The frame of a chart is a line of its own. */
static void read_chart_panel(struct svg_reader *r, struct sheet_panel *p)
{
    double corner[6][2];
    assert_int_equal(read_points(read_grid(r, p), corner, 6), 5);
    p->left = corner[0][0];
    p->top = corner[0][1];
    p->right = corner[2][0];
    p->bottom = corner[2][1];
    const double wanted[5][2] = {{p->left, p->top},
                                 {p->right, p->top},
                                 {p->right, p->bottom},
                                 {p->left, p->bottom},
                                 {p->left, p->top}};
    for (int k = 0; k < 10; k++)
        near(corner[k / 2][k % 2], wanted[k / 2][k % 2], "a corner of the frame");
    check_grid(r, p);
}

/* Where a value belongs on an axis without logarithms. */
static double straight(const struct sheet_panel *p, int axis, double value)
{
    const double *v = p->value[axis], *at = p->at[axis];
    size_t last = p->count[axis] - 1;
    return at[0] + (at[last] - at[0]) * (value - v[0]) / (v[last] - v[0]);
}

static void check_chart(const struct chart *chart, struct svg_reader *r)
{
    struct sheet_panel p;
    double x, y, point[16][2], at[4];
    read_chart_panel(r, &p);
    assert_true(p.count[0] >= 2 && p.count[1] >= 3);
    assert_string_equal(read_text(r, next_line(r), &x, &y), chart->x_label);
    near(x, 0.5 * (p.left + p.right), "the x axis' name");
    assert_true(y > p.bottom + 25);
    assert_string_equal(read_text(r, next_line(r), &x, &y), chart->y_label);
    near(y, 0.5 * (p.top + p.bottom), "the y axis' name");
    assert_true(x < p.left - 40);
    if (chart->title) {
        assert_string_equal(read_text(r, next_line(r), &x, &y), chart->title);
        assert_true(y < p.top);
    }
    for (size_t s = 0; s < chart->series_count; s++) {
        size_t count = read_points(next_line(r), point, 16);
        assert_int_equal(count, chart->series[s].count);
        for (size_t i = 0; i < count; i++) {
            near(point[i][0], straight(&p, 0, (double)i), "a value along x");
            near(point[i][1], straight(&p, 1, chart->series[s].value[i]), "a value along y");
            assert_true(point[i][1] > p.top && point[i][1] <= p.bottom);
        }
    }
    for (size_t s = 0; s < chart->series_count; s++) {
        double name_y;
        read_line(r, next_line(r), at);
        assert_true(at[0] > p.right && at[2] > at[0] && fabs(at[1] - at[3]) <= 0);
        assert_string_equal(read_text(r, next_line(r), &x, &name_y), chart->series[s].name);
        assert_true(x > at[2] && fabs(name_y - 3.5 - at[1]) <= NEAR);
        (void)read_text(r, next_line(r), &x, &y);
        assert_true(y > name_y + 10);
    }
    assert_null(next_line(r));
    /* There is air below the last line, and not much more than the frame or the legend needs. */
    assert_true(r->height >= y + 8);
    assert_true(r->height <= fmax(y + 40, p.bottom + 60));
}

static void every_mark_of_a_chart_stands_where_its_numbers_say(void **state)
{
    (void)state;
    static const double value[][6] = {{10, 20, 40, 30, 25, 12},
                                      {0.5, 0.25, 0.75, 0.5, 0.625, 0.5},
                                      {1003, 1001, 1002.5, 1004, 1001.5, 1002},
                                      {-3, 4, 1, -2, 0, 2}};
    for (size_t i = 0; i < ARRAY_COUNT(value); i++)
        for (size_t count = 2; count <= 6; count += 2) {
            struct chart_series series[18] = {
                {"first", 0, NAN, NAN, NAN, value[i], count},
                {"second", 12, 1, 1, 2, value[i] + 1, count - 1 > 1 ? count - 1 : 2}};
            /* With all of them the legend is higher than the frame. */
            for (size_t s = 2; s < ARRAY_COUNT(series); s++)
                series[s] = series[s % 2];
            struct chart chart = {.title = count == 4 ? NULL : "title",
                                  .x_label = "frame",
                                  .y_label = "y name",
                                  .unit = "ms",
                                  .series = series,
                                  .series_count = count == 6 ? ARRAY_COUNT(series) : 2};
            char *text = NULL;
            size_t size = 0;
            FILE *stream = open_memstream(&text, &size);
            assert_non_null(stream);
            chart_svg(stream, &chart);
            assert_int_equal(fclose(stream), 0);
            struct svg_reader r = opened(text);
            check_chart(&chart, &r);
            free(text);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mark_of_a_plot_stands_where_its_numbers_say),
        cmocka_unit_test(an_axis_begins_a_little_below_its_values),
        cmocka_unit_test(every_mark_of_a_chart_stands_where_its_numbers_say),
    };
    return cmocka_run_group_tests_name("svg_places", tests, NULL, NULL) ? 1 : 0;
}

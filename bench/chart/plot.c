#include "bench/chart/plot.h"

#include "bench/chart/svg.h"
#include "ref/files/file.h"
#include "scenes/picture/colour.h"
#include "scenes/picture/ticks.h"

#include <math.h>
#include <string.h>

/* Sizes in SVG units. */
#define PANEL_W  290.0
#define PANEL_H  230.0
#define LEFT     66.0 /* left of a panel: tick labels and the axis label */
#define GAP      14.0
#define LEGEND_W 210.0
#define HEAD     62.0
#define FOOT     58.0
#define LINE     18.0

/* A logarithmic axis from lo to hi, drawn from `from` to `to`. */
struct axis {
    double lo, hi, from, to;
};

static double place(const struct axis *axis, double value)
{
    if (!(value > axis->lo))
        return axis->from;
    double part = log(value / axis->lo) / log(axis->hi / axis->lo);
    return axis->from + part * (axis->to - axis->from);
}

static void series_colour(const struct plot_series *series, char text[8])
{
    colour_text(colour_of_class(series->colour), text);
}

static void put_marker(FILE *stream, const struct plot_series *series, double x, double y)
{
    static const char *const path[PLOT_SHAPES] = {
        NULL,
        "M-4.4,-4.4h8.8v8.8h-8.8z",
        "M0,-6.2L6.2,0L0,6.2L-6.2,0z",
        "M0,-6L5.6,4.6H-5.6z",
        "M0,6L5.6,-4.6H-5.6z",
        "M-2,-6h4v4h4v4h-4v4h-4v-4h-4v-4h4z",
        "M0,-7L1.9,-1.9L7,0L1.9,1.9L0,7L-1.9,1.9L-7,0L-1.9,-1.9z",
        "M-5,-5H5L-5,5H5z"};
    char colour[8];
    series_colour(series, colour);
    unsigned fill = series->fill % PLOT_FILLS;
    char paint[96];
    snprintf(paint, sizeof paint,
             "fill=\"%s\" fill-opacity=\"%s\" stroke=\"%s\" stroke-width=\"1.6\"",
             fill == 1 ? "#ffffff" : colour, fill == 2 ? "0.35" : "1", colour);
    if (series->shape % PLOT_SHAPES == 0)
        fprintf(stream, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.9\" %s/>\n", x, y, paint);
    else
        fprintf(stream, "<path transform=\"translate(%.1f,%.1f)\" d=\"%s\" %s/>\n", x, y,
                path[series->shape % PLOT_SHAPES], paint);
}

void plot_tell_apart(struct plot_series *series, size_t count)
{
    bool used[PLOT_SHAPES * PLOT_FILLS] = {false};
    for (size_t i = 0; i < count; i++) {
        unsigned shape = series[i].shape % PLOT_SHAPES, fill = series[i].fill % PLOT_FILLS;
        unsigned first = shape * PLOT_FILLS + fill, step = 0;
        while (step < ARRAY_COUNT(used) && used[(first + step) % ARRAY_COUNT(used)])
            step++;
        unsigned mark = (unsigned)((first + step) % ARRAY_COUNT(used));
        series[i].shape = mark / PLOT_FILLS;
        series[i].fill = mark % PLOT_FILLS;
        used[mark] = true;
    }
}

/* Widens [*lo, *hi] to contain `value`, if a logarithmic axis can show it. */
static void take_in(double value, double *lo, double *hi)
{
    if (!(value > 0.0) || !isfinite(value))
        return;
    *lo = fmin(*lo, value);
    *hi = fmax(*hi, value);
}

static bool drawn(const struct plot_point *p)
{
    return isfinite(p->x) && p->x > 0.0 && isfinite(p->y) && p->y >= 0.0;
}

/* Computes a panel's axes: x as narrow as possible, y in whole decades. */
static void make_axes(const struct plot_panel *panel, struct axis *x, struct axis *y)
{
    double x_lo = INFINITY, x_hi = 0, y_lo = INFINITY, y_hi = 0;
    for (size_t i = 0; i < panel->count; i++) {
        const struct plot_point *p = &panel->point[i];
        if (!drawn(p))
            continue;
        const double xs[3] = {p->x, p->x_lo, p->x_hi}, ys[3] = {p->y, p->y_lo, p->y_hi};
        for (int k = 0; k < 3; k++) {
            take_in(xs[k], &x_lo, &x_hi);
            take_in(ys[k], &y_lo, &y_hi);
        }
        if (p->below)
            take_in(0.5 * p->y, &y_lo, &y_hi); /* room for the arrow */
    }
    if (!(x_hi > 0.0))
        x_lo = x_hi = 1.0;
    if (!(y_hi > 0.0))
        y_lo = y_hi = 1.0;
    x->lo = x_lo / 1.3;
    x->hi = x_hi * 1.3;
    y->lo = pow(10.0, floor(log10(y_lo) + 1e-9));
    y->hi = pow(10.0, ceil(log10(y_hi) - 1e-9));
    if (!(y->hi > y->lo * 9.0))
        y->hi = y->lo * 10.0;
    if (y_lo < y->lo * 1.25) /* keep markers off the axis */
        y->lo /= 10.0;
}

/* About how wide a text is, rather too wide: fonts are the reader's. */
static double text_width(const char *text, double size)
{
    return 0.66 * size * (double)strlen(text);
}

static void put_axes(FILE *stream, const struct plot_panel *panel, const struct axis *x,
                     const struct axis *y)
{
    static const char grid[] = "stroke=\"#dddddd\" stroke-width=\"1\"";
    double tick[TICKS_MOST];
    char text[32];
    size_t count = ticks_log(x->lo, x->hi, tick);
    for (size_t i = 0; i < count; i++) {
        double at = place(x, tick[i]);
        svg_line(stream, at, y->from, at, y->to, grid);
        tick_text(tick[i], 0.0, text, sizeof text);
        svg_label(stream, at, y->from + 15.0, "text-anchor=\"middle\"", text);
    }
    count = ticks_log(y->lo, y->hi, tick);
    for (size_t i = 0; i < count; i++) {
        double at = place(y, tick[i]);
        svg_line(stream, x->from, at, x->to, at, grid);
        tick_text(tick[i], 0.0, text, sizeof text);
        svg_label(stream, x->from - 6.0, at + 4.0, "text-anchor=\"end\"", text);
    }
    fprintf(stream,
            "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" "
            "stroke=\"#444444\"/>\n",
            x->from, y->to, x->to - x->from, y->from - y->to);
    double middle = 0.5 * (x->from + x->to);
    svg_label(stream, middle, y->from + 33.0, "text-anchor=\"middle\"", panel->x_label);
    char look[96] = "text-anchor=\"middle\" font-weight=\"bold\"";
    if (text_width(panel->title, 10.5) > PANEL_W) /* is squeezed, so that it stays in its panel */
        strcat(look, " textLength=\"290\" lengthAdjust=\"spacingAndGlyphs\"");
    svg_label(stream, middle, y->to - 7.0, look, panel->title);
    svg_label_up(stream, x->from - 52.0, 0.5 * (y->from + y->to), panel->y_label);
}

static void put_point(FILE *stream, const struct plot_series *series, const struct plot_point *p,
                      const struct axis *x, const struct axis *y)
{
    double px = place(x, p->x), py = place(y, p->y);
    char colour[8], bar[64];
    series_colour(series, colour);
    snprintf(bar, sizeof bar, "stroke=\"%s\" stroke-width=\"1.2\"", colour);
    if (p->x_lo != p->x || p->x_hi != p->x)
        svg_line(stream, place(x, p->x_lo), py, place(x, p->x_hi), py, bar);
    if (p->y_lo != p->y || p->y_hi != p->y)
        svg_line(stream, px, place(y, p->y_lo), px, place(y, p->y_hi), bar);
    if (p->below) {
        double end = fmin(py + 17.0, y->from);
        svg_line(stream, px, py, px, end, bar);
        fprintf(stream, "<path d=\"M%.1f,%.1fl-3.5,-5h7z\" fill=\"%s\"/>\n", px, end, colour);
    }
    put_marker(stream, series, px, py);
}

static void put_panel(FILE *stream, const struct plot_figure *figure,
                      const struct plot_panel *panel, double left, double top)
{
    struct axis x = {.from = left + LEFT, .to = left + LEFT + PANEL_W};
    struct axis y = {.from = top + PANEL_H, .to = top};
    make_axes(panel, &x, &y);
    put_axes(stream, panel, &x, &y);
    for (size_t i = 0; i < panel->count; i++)
        if (drawn(&panel->point[i]))
            put_point(stream, &figure->series[panel->point[i].series], &panel->point[i], &x, &y);
}

static double height_of(const struct plot_figure *figure)
{
    double legend = HEAD + LINE * (double)figure->series_count + LINE;
    return fmax(HEAD + PANEL_H + FOOT, legend);
}

static double legend_of(const struct plot_figure *figure)
{
    double width = LEGEND_W;
    for (size_t i = 0; i < figure->series_count; i++)
        width = fmax(width, 41.0 + text_width(figure->series[i].name, 11.0));
    return width;
}

static double width_of(const struct plot_figure *figure)
{
    double width = (double)figure->panel_count * (LEFT + PANEL_W + GAP) + legend_of(figure);
    width = fmax(width, 28.0 + text_width(figure->title, 17.0)); /* bold, of size 15 */
    return fmax(width, 28.0 + text_width(figure->subtitle, 11.0));
}

static void put_figure(FILE *stream, const struct plot_figure *figure, double top)
{
    svg_label(stream, 14.0, top + 20.0, "font-size=\"15\" font-weight=\"bold\"", figure->title);
    svg_label(stream, 14.0, top + 37.0, "fill=\"#444444\"", figure->subtitle);
    for (size_t i = 0; i < figure->panel_count; i++)
        put_panel(stream, figure, &figure->panel[i], (double)i * (LEFT + PANEL_W + GAP),
                  top + HEAD);
    double left = (double)figure->panel_count * (LEFT + PANEL_W + GAP) + 14.0;
    for (size_t i = 0; i < figure->series_count; i++) {
        double at = top + HEAD + 6.0 + LINE * (double)i;
        put_marker(stream, &figure->series[i], left, at);
        svg_label(stream, left + 13.0, at + 4.0, "", figure->series[i].name);
    }
}

void plot_write(FILE *stream, const struct plot_figure *figure, size_t count)
{
    double width = 0.0, height = 0.0, top = 0.0;
    for (size_t i = 0; i < count; i++) {
        width = fmax(width, width_of(&figure[i]));
        height += height_of(&figure[i]);
    }
    svg_begin(stream, width, height, figure[0].title);
    for (size_t i = 0; i < count; i++) {
        put_figure(stream, &figure[i], top);
        top += height_of(&figure[i]);
    }
    svg_end(stream);
}

enum status plot_write_file(const char *path, const struct plot_figure *figure, size_t count,
                            struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    plot_write(out.stream, figure, count);
    return file_out_commit(&out, reason);
}

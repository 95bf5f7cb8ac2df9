#include "bench/chart/chart.h"

#include "bench/chart/canvas.h"
#include "bench/chart/svg.h"
#include "scenes/picture/colour.h"
#include "scenes/picture/draw.h"
#include "ref/files/file.h"
#include "scenes/picture/ticks.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Sizes in pixels. */
#define LEFT         70
#define TOP          34
#define PLOT_W       640
#define PLOT_H       360
#define FOOT         52
#define GAP          18 /* between plot and legend */
#define LEGEND_LEAST 160
#define LEGEND_MOST  460
#define SAMPLE       40 /* the line beside a name in the legend */
#define ENTRY        34 /* height of a series in the legend */

#define INK  image_rgb(0, 0, 0)
#define GRAY image_rgb(85, 85, 85)
#define GRID image_rgb(221, 221, 221)

struct axes {
    double x_lo, x_hi, y_lo, y_hi;
};

static double x_of(const struct axes *axes, double x)
{
    return LEFT + PLOT_W * ((x - axes->x_lo) / (axes->x_hi - axes->x_lo));
}

static double y_of(const struct axes *axes, double y)
{
    return TOP + PLOT_H * ((axes->y_hi - y) / (axes->y_hi - axes->y_lo));
}

/* x: the frames. y: the values with a margin, from 0 if that costs little room. */
static struct axes axes_of(const struct chart *chart)
{
    double lo = INFINITY, hi = -INFINITY;
    size_t frames = chart->x_count;
    for (size_t s = 0; s < chart->series_count; s++) {
        const struct chart_series *series = &chart->series[s];
        frames = series->count > frames ? series->count : frames;
        for (size_t i = 0; i < series->count; i++)
            if (isfinite(series->value[i])) {
                lo = fmin(lo, series->value[i]);
                hi = fmax(hi, series->value[i]);
            }
    }
    ticks_range(&lo, &hi);
    double air = 0.05 * (hi - lo);
    bool from_zero = lo >= 0.0 && lo < 0.4 * hi;
    return (struct axes){0.0, frames > 2 ? (double)(frames - 1) : 1.0, from_zero ? 0.0 : lo - air,
                         hi + air};
}

static void put_axes(const struct canvas *canvas, const struct chart *chart,
                     const struct axes *axes)
{
    const double bottom = TOP + PLOT_H, right = LEFT + PLOT_W;
    const struct canvas_pen grid = {.width = 1, .colour = GRID}, ink = {.width = 1, .colour = INK};
    double tick[TICKS_MOST], step;
    char text[40];
    size_t count = ticks_linear(axes->x_lo, axes->x_hi, 8, tick, &step);
    for (size_t i = 0; i < count; i++) {
        if (tick[i] != floor(tick[i])) /* frames are whole numbers */
            continue;
        double at = x_of(axes, tick[i]);
        canvas_line(canvas, at, bottom, at, TOP, &grid);
        snprintf(text, sizeof text, "%.0f", tick[i]);
        canvas_text(canvas, at, bottom + 15, CANVAS_MIDDLE, INK, text);
    }
    count = ticks_linear(axes->y_lo, axes->y_hi, 7, tick, &step);
    for (size_t i = 0; i < count; i++) {
        double at = y_of(axes, tick[i]);
        canvas_line(canvas, LEFT, at, right, at, &grid);
        tick_text(tick[i], step, text, sizeof text);
        canvas_text(canvas, LEFT - 6, at + 4, CANVAS_END, INK, text);
    }
    const double corner[5][2] = {
        {LEFT, TOP}, {right, TOP}, {right, bottom}, {LEFT, bottom}, {LEFT, TOP}};
    canvas_lines(canvas, corner, 5, &ink);
    canvas_text(canvas, LEFT + PLOT_W / 2, bottom + 36, CANVAS_MIDDLE, INK, chart->x_label);
    canvas_text(canvas, 16, TOP + PLOT_H / 2, CANVAS_UP, INK, chart->y_label);
    if (chart->title)
        canvas_text(canvas, 14, 20, CANVAS_START, INK, chart->title);
}

/* The pending points of a line without gaps. If there are more than two values per pixel, each
 * pixel keeps its least and largest, so that no outlier is lost. */
#define POINTS_MOST (2 * PLOT_W)

struct chart_run {
    const struct canvas *canvas;
    const struct axes *axes;
    const double *value;
    struct canvas_pen pen;
    double point[POINTS_MOST][2];
    size_t count;
    bool begun; /* the pixel below has values */
    size_t pixel, least, most;
};

static void add_point(struct chart_run *run, size_t i)
{
    assert(run->count < POINTS_MOST);
    run->point[run->count][0] = x_of(run->axes, (double)i);
    run->point[run->count][1] = y_of(run->axes, run->value[i]);
    run->count++;
}

static void end_pixel(struct chart_run *run)
{
    if (!run->begun)
        return;
    run->begun = false;
    add_point(run, run->least < run->most ? run->least : run->most);
    if (run->least != run->most)
        add_point(run, run->least < run->most ? run->most : run->least);
}

static void end_run(struct chart_run *run)
{
    end_pixel(run);
    canvas_lines(run->canvas, run->point, run->count, &run->pen);
    run->count = 0;
}

/* There are eight colours, and as many dashes. From the ninth series on the lines are thicker. */
static struct canvas_pen pen_of(size_t series)
{
    return (struct canvas_pen){.width = 1.4 + 1.2 * (double)(series / COLOUR_CLASS_COUNT),
                               .dash = (unsigned)series,
                               .colour = colour_of_class(series)};
}

static void put_series(const struct canvas *canvas, const struct chart *chart, size_t index,
                       const struct axes *axes)
{
    const struct chart_series *series = &chart->series[index];
    const size_t frames = (size_t)axes->x_hi + 1;
    struct chart_run run = {
        .canvas = canvas, .axes = axes, .value = series->value, .pen = pen_of(index)};
    for (size_t i = 0; i < series->count; i++) {
        if (!isfinite(series->value[i])) {
            end_run(&run);
            continue;
        }
        size_t pixel = frames > POINTS_MOST ? i * PLOT_W / frames : i;
        if (run.begun && pixel != run.pixel)
            end_pixel(&run);
        if (!run.begun)
            run.least = run.most = i;
        run.begun = true;
        run.pixel = pixel;
        run.least = series->value[i] < series->value[run.least] ? i : run.least;
        run.most = series->value[i] > series->value[run.most] ? i : run.most;
    }
    end_run(&run);
}

/* Writes "656 bytes; average 3.21, 3.1 to 4.02 ms". */
static void words_of(const struct chart *chart, const struct chart_series *series, char *text,
                     size_t text_bytes)
{
    size_t length = 0;
    text[0] = '\0';
    if (series->bytes)
        length = (size_t)snprintf(text, text_bytes, "%" PRIu64 " bytes", series->bytes);
    if (isfinite(series->average) && length < text_bytes)
        snprintf(text + length, text_bytes - length, "%saverage %.4g, %.4g to %.4g%s%s",
                 length ? "; " : "", series->average, series->least, series->most,
                 chart->unit ? " " : "", chart->unit ? chart->unit : "");
}

static void put_legend(const struct canvas *canvas, const struct chart *chart)
{
    const double left = LEFT + PLOT_W + GAP;
    for (size_t i = 0; i < chart->series_count; i++) {
        const struct chart_series *series = &chart->series[i];
        const double y = TOP + 10.0 + ENTRY * (double)i;
        char words[160];
        words_of(chart, series, words, sizeof words);
        const struct canvas_pen pen = pen_of(i);
        canvas_line(canvas, left, y - 3.5, left + SAMPLE, y - 3.5, &pen);
        canvas_text(canvas, left + SAMPLE + 6, y, CANVAS_START, INK, series->name);
        canvas_text(canvas, left + SAMPLE + 6, y + 13, CANVAS_START, GRAY, words);
    }
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

/* Size of the whole picture in pixels. */
static void size_of(const struct chart *chart, size_t *width, size_t *height)
{
    size_t legend = 0;
    for (size_t i = 0; i < chart->series_count; i++) {
        char words[160];
        words_of(chart, &chart->series[i], words, sizeof words);
        legend = larger(legend, larger(strlen(words), strlen(chart->series[i].name)));
    }
    legend = larger(SAMPLE + 16 + CANVAS_CHARACTER * legend, LEGEND_LEAST);
    *width = LEFT + PLOT_W + GAP + (legend < LEGEND_MOST ? legend : LEGEND_MOST);
    *height = larger(TOP + PLOT_H + FOOT, TOP + ENTRY * chart->series_count + 10);
}

static void put_chart(const struct canvas *canvas, const struct chart *chart)
{
    const struct axes axes = axes_of(chart);
    put_axes(canvas, chart, &axes);
    for (size_t i = 0; i < chart->series_count; i++)
        put_series(canvas, chart, i, &axes);
    put_legend(canvas, chart);
}

void chart_svg(FILE *stream, const struct chart *chart)
{
    size_t width, height;
    size_of(chart, &width, &height);
    svg_begin(stream, (double)width, (double)height, chart->title ? chart->title : chart->y_label);
    put_chart(&(struct canvas){.svg = stream}, chart);
    svg_end(stream);
}

enum status chart_image(const struct chart *chart, struct image *out, struct reason *reason)
{
    size_t width, height;
    size_of(chart, &width, &height);
    if (height > IMAGE_SIDE_MOST) {
        *out = (struct image){0};
        return fail(reason, STATUS_INPUT, "chart: no room for %zu series", chart->series_count);
    }
    enum status status = image_make((uint32_t)width, (uint32_t)height, out, reason);
    if (status)
        return status;
    draw_rect(out, 0, 0, (int)width, (int)height, image_rgb(255, 255, 255));
    put_chart(&(struct canvas){.image = out}, chart);
    return STATUS_OK;
}

enum status chart_write(const struct chart *chart, const char *svg_path, const char *png_path,
                        struct reason *reason)
{
    enum status status = STATUS_OK;
    if (svg_path) {
        struct file_out out;
        status = file_out_open(svg_path, &out, reason);
        if (status)
            return status;
        chart_svg(out.stream, chart);
        status = file_out_commit(&out, reason);
    }
    if (!status && png_path) {
        struct image image;
        status = chart_image(chart, &image, reason);
        if (!status)
            status = image_write(png_path, &image, reason);
        image_free(&image);
    }
    return status;
}

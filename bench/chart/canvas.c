#include "bench/chart/canvas.h"

#include "bench/chart/svg.h"
#include "ref/base/text.h"
#include "scenes/picture/colour.h"
#include "scenes/picture/draw.h"

#include <math.h>

#define ABOVE_BASE 7 /* rows of a character above its base line */
#define DOT        4.0

static void text_of_image(struct image *image, double x, double y, enum canvas_anchor anchor,
                          uint32_t colour, const char *text)
{
    int width = (int)draw_text_width(text, 1), left = (int)lround(x), base = (int)lround(y);
    if (anchor == CANVAS_UP)
        draw_text_up(image, left - ABOVE_BASE, base + width / 2, 1, colour, text);
    else
        draw_text(image,
                  left - (anchor == CANVAS_START    ? 0
                          : anchor == CANVAS_MIDDLE ? width / 2
                                                    : width),
                  base - ABOVE_BASE, 1, colour, text);
}

void canvas_text(const struct canvas *canvas, double x, double y, enum canvas_anchor anchor,
                 uint32_t colour, const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    if (canvas->image)
        text_of_image(canvas->image, x, y, anchor, colour, text);
    if (!canvas->svg)
        return;
    if (anchor == CANVAS_UP) {
        svg_label_up(canvas->svg, x, y, text);
        return;
    }
    char colour_name[8], attributes[64];
    colour_text(colour, colour_name);
    snprintf(attributes, sizeof attributes, "text-anchor=\"%s\" fill=\"%s\"", anchors[anchor],
             colour_name);
    svg_label(canvas->svg, x, y, attributes, text);
}

/* Lengths of ink and gap in turn, up to a 0. A line's round ends are taken from the gaps. */
static const double dashes[CANVAS_DASHES][7] = {
    {0}, {8, 4}, {2, 4}, {10, 4, 2, 4}, {16, 4}, {5, 3}, {16, 4, 5, 4}, {10, 4, 2, 4, 2, 4}};

/* Draws a part of a dashed line; *at is where it begins in the pattern, and then where it ends. */
static void dashed(struct image *image, const double a[2], const double b[2],
                   const struct canvas_pen *pen, double *at)
{
    const double *dash = dashes[pen->dash % CANVAS_DASHES];
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = sqrt(dx * dx + dy * dy);
    if (!isfinite(length) || length > 1e6)
        return;
    for (double done = 0; done < length;) {
        double left = *at;
        int k = 0;
        while (left >= dash[k]) {
            left -= dash[k++];
            if (dash[k] == 0) {
                *at = left;
                k = 0;
            }
        }
        double step = fmin(dash[k] - left, length - done);
        if (k % 2 == 0) {
            double from = done / length, to = (done + step) / length;
            draw_line(image, a[0] + from * dx, a[1] + from * dy, a[0] + to * dx, a[1] + to * dy,
                      pen->width, pen->colour);
        }
        done += step;
        *at += step;
    }
}

/* Colour, width and dashes as attributes of SVG. */
static void style_of(const struct canvas_pen *pen, char *style, size_t bytes)
{
    const double *dash = dashes[pen->dash % CANVAS_DASHES];
    char colour_name[8];
    colour_text(pen->colour, colour_name);
    snprintf(style, bytes, "stroke=\"%s\" stroke-width=\"%.1f\"", colour_name, pen->width);
    for (int k = 0; dash[k] > 0; k++)
        text_append(style, bytes, "%s%.0f", k ? " " : " stroke-dasharray=\"", dash[k]);
    if (dash[0] > 0)
        text_append(style, bytes, "\"");
}

static void lines_of_image(struct image *image, const double (*point)[2], size_t count,
                           const struct canvas_pen *pen)
{
    double at = 0;
    for (size_t i = 1; i < count; i++)
        if (pen->dash % CANVAS_DASHES)
            dashed(image, point[i - 1], point[i], pen, &at);
        else
            draw_line(image, point[i - 1][0], point[i - 1][1], point[i][0], point[i][1], pen->width,
                      pen->colour);
}

void canvas_line(const struct canvas *canvas, double x1, double y1, double x2, double y2,
                 const struct canvas_pen *pen)
{
    char style[128];
    if (canvas->image)
        lines_of_image(canvas->image, (const double[2][2]){{x1, y1}, {x2, y2}}, 2, pen);
    style_of(pen, style, sizeof style);
    if (canvas->svg)
        svg_line(canvas->svg, x1, y1, x2, y2, style);
}

void canvas_lines(const struct canvas *canvas, const double (*point)[2], size_t count,
                  const struct canvas_pen *pen)
{
    char style[128];
    if (count == 1) {
        if (canvas->image)
            draw_line(canvas->image, point[0][0], point[0][1], point[0][0], point[0][1], DOT,
                      pen->colour);
        colour_text(pen->colour, style);
        if (canvas->svg)
            fprintf(canvas->svg, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>\n",
                    point[0][0], point[0][1], 0.5 * DOT, style);
        return;
    }
    if (canvas->image)
        lines_of_image(canvas->image, point, count, pen);
    if (!canvas->svg || count == 0)
        return;
    style_of(pen, style, sizeof style);
    fprintf(canvas->svg, "<polyline fill=\"none\" %s points=\"", style);
    for (size_t i = 0; i < count; i++)
        fprintf(canvas->svg, "%s%.1f,%.1f", i ? " " : "", point[i][0], point[i][1]);
    fputs("\"/>\n", canvas->svg);
}

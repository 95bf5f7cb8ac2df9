#include "bench/chart/canvas.h"

#include "bench/chart/svg.h"
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

void canvas_line(const struct canvas *canvas, double x1, double y1, double x2, double y2,
                 double width, uint32_t colour)
{
    if (canvas->image)
        draw_line(canvas->image, x1, y1, x2, y2, width, colour);
    if (!canvas->svg)
        return;
    char colour_name[8], style[64];
    colour_text(colour, colour_name);
    snprintf(style, sizeof style, "stroke=\"%s\" stroke-width=\"%.1f\"", colour_name, width);
    svg_line(canvas->svg, x1, y1, x2, y2, style);
}

void canvas_lines(const struct canvas *canvas, const double (*point)[2], size_t count, double width,
                  uint32_t colour)
{
    char colour_name[8];
    colour_text(colour, colour_name);
    if (count == 1) {
        if (canvas->image)
            draw_line(canvas->image, point[0][0], point[0][1], point[0][0], point[0][1], DOT,
                      colour);
        if (canvas->svg)
            fprintf(canvas->svg, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>\n",
                    point[0][0], point[0][1], 0.5 * DOT, colour_name);
        return;
    }
    for (size_t i = 1; i < count && canvas->image; i++)
        draw_line(canvas->image, point[i - 1][0], point[i - 1][1], point[i][0], point[i][1], width,
                  colour);
    if (!canvas->svg || count == 0)
        return;
    fprintf(canvas->svg, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" points=\"",
            colour_name, width);
    for (size_t i = 0; i < count; i++)
        fprintf(canvas->svg, "%s%.1f,%.1f", i ? " " : "", point[i][0], point[i][1]);
    fputs("\"/>\n", canvas->svg);
}

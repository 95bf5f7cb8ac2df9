/* A drawing as SVG and as pixels: each call draws on both if both are set. Units are pixels of the
 * picture and SVG units. Text has the same width in the picture, and about the same in SVG. */
#ifndef CANVAS_H
#define CANVAS_H

#include "scenes/picture/image.h"

#include <stdio.h>

struct canvas {
    FILE *svg;           /* NULL: no SVG; else svg_begin was called */
    struct image *image; /* NULL: no picture */
};

enum canvas_anchor { CANVAS_START, CANVAS_MIDDLE, CANVAS_END, CANVAS_UP /* turned, centred */ };

#define CANVAS_CHARACTER 6 /* width of a character */

/* Draws text with its base line at y. */
void canvas_text(const struct canvas *canvas, double x, double y, enum canvas_anchor anchor,
                 uint32_t colour, const char *text);

#define CANVAS_DASHES 8u /* 0 is a solid line */

/* How a line is drawn; `dash` is taken modulo CANVAS_DASHES. */
struct canvas_pen {
    double width;
    unsigned dash;
    uint32_t colour;
};

void canvas_line(const struct canvas *canvas, double x1, double y1, double x2, double y2,
                 const struct canvas_pen *pen);

/* Draws a line through the points; a single point is a dot. */
void canvas_lines(const struct canvas *canvas, const double (*point)[2], size_t count,
                  const struct canvas_pen *pen);

#endif

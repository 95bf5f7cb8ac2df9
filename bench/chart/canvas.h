/* One drawing as SVG and as pixels: every call draws on each of the two that is set. Units are
 * pixels of the picture and of the SVG's own; text is as wide as in the picture, about as wide in
 * SVG. */
#ifndef CANVAS_H
#define CANVAS_H

#include "scenes/picture/image.h"

#include <stdio.h>

struct canvas {
    FILE *svg;           /* NULL: none; svg_begin was called */
    struct image *image; /* NULL: none */
};

enum canvas_anchor { CANVAS_START, CANVAS_MIDDLE, CANVAS_END, CANVAS_UP /* turned, its middle */ };

#define CANVAS_CHARACTER 6 /* width of one */

/* Text on the base line y. */
void canvas_text(const struct canvas *canvas, double x, double y, enum canvas_anchor anchor,
                 uint32_t colour, const char *text);

void canvas_line(const struct canvas *canvas, double x1, double y1, double x2, double y2,
                 double width, uint32_t colour);

/* A line from each point to the next; a single point is a dot. */
void canvas_lines(const struct canvas *canvas, const double (*point)[2], size_t count, double width,
                  uint32_t colour);

#endif

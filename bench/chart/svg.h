/* Pieces of SVG documents. Texts are escaped; write errors are left in the stream for its owner. */
#ifndef SVG_H
#define SVG_H

#include "ref/base/base.h"

#include <stdio.h>

/* Everything up to the drawing: the root element, the title, a white ground. svg_end closes it. */
void svg_begin(FILE *stream, double width, double height, const char *title);
void svg_end(FILE *stream);

/* Text content or attribute: what XML gives a meaning is escaped, what it forbids is left out. */
void svg_text(FILE *stream, const char *text);

/* A line of text at x, y, its baseline; `attributes` such as "text-anchor=\"end\"". */
void svg_label(FILE *stream, double x, double y, const char *attributes, const char *text);

/* A line of text turned to the left; x, y is the middle of its base line. */
void svg_label_up(FILE *stream, double x, double y, const char *text);

void svg_line(FILE *stream, double x1, double y1, double x2, double y2, const char *style);

#endif

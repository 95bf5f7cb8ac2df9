/* Parts of SVG documents. Texts are escaped. Write errors stay in the stream for its owner. */
#ifndef SVG_H
#define SVG_H

#include "ref/base/base.h"

#include <stdio.h>

/* Writes everything before the drawing: the root element, the title, a white background. svg_end
 * closes it. */
void svg_begin(FILE *stream, double width, double height, const char *title);
void svg_end(FILE *stream);

/* Writes text content or an attribute. Characters with a meaning in XML are escaped; forbidden ones
 * are dropped. */
void svg_text(FILE *stream, const char *text);

/* Writes a line of text with its base line at x, y; `attributes` such as "text-anchor=\"end\"". */
void svg_label(FILE *stream, double x, double y, const char *attributes, const char *text);

/* Writes a line of text turned to the left; x, y is the middle of its base line. */
void svg_label_up(FILE *stream, double x, double y, const char *text);

void svg_line(FILE *stream, double x1, double y1, double x2, double y2, const char *style);

#endif

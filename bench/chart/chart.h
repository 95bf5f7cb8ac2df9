/* Line charts of measurements, one number a frame, as SVG and as PNG from one description. Knows
 * nothing of rays. */
#ifndef CHART_H
#define CHART_H

#include "scenes/picture/image.h"

#include <stdio.h>

#define CHART_DURATION "Compute pass duration (ms)" /* the label of such a chart's y axis */

/* One line. Texts are borrowed. */
struct chart_series {
    const char *name;
    uint64_t bytes;              /* in the legend, if not 0 */
    double average, least, most; /* in the legend, if not NaN */
    const double *value;         /* not finite: missing, a gap in the line */
    size_t count;
};

struct chart {
    const char *title; /* NULL: none */
    const char *x_label, *y_label;
    const char *unit; /* behind the legend's numbers, such as "ms" */
    const struct chart_series *series;
    size_t series_count;
    size_t
        x_count; /* frames that the x axis has room for, so that it does not change while they come;
                       fewer than a series has: that many */
};

/* Writes one SVG document. Write errors are left in the stream for its owner. */
void chart_svg(FILE *stream, const struct chart *chart);

/* The same picture in pixels. Errors: STATUS_INPUT so many series that it is too large;
 * STATUS_MEMORY. */
enum status chart_image(const struct chart *chart, struct image *out,
                        struct reason *reason) MUST_USE;

/* Writes it to files, each whole or not at all; NULL: not that one.
 * Errors: STATUS_INPUT cannot write; those of chart_image. */
enum status chart_write(const struct chart *chart, const char *svg_path, const char *png_path,
                        struct reason *reason) MUST_USE;

#endif

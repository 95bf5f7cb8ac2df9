/* Line charts of measurements, one number per frame, as SVG and as PNG from one description.
 * Independent of ray tracing. */
#ifndef CHART_H
#define CHART_H

#include "scenes/picture/image.h"

#include <stdio.h>

#define CHART_DURATION "Compute pass duration (ms)" /* y label of a chart of durations */

/* One line of a chart. Texts are borrowed. */
struct chart_series {
    const char *name;
    uint64_t bytes;              /* shown in the legend unless 0 */
    double average, least, most; /* shown in the legend unless NaN */
    const double *value;         /* not finite: missing, leaves a gap */
    size_t count;
};

struct chart {
    const char *title; /* NULL: none */
    const char *x_label, *y_label;
    const char *unit; /* unit of the legend's numbers, such as "ms" */
    const struct chart_series *series;
    size_t series_count;
    /* Frames that the x axis has room for, so that it does not change during a run. At least the
     * frames of the longest series are shown. */
    size_t x_count;
};

/* Writes one SVG document. Write errors stay in the stream for its owner. */
void chart_svg(FILE *stream, const struct chart *chart);

/* The same picture in pixels. Errors: STATUS_INPUT so many series that it is too large;
 * STATUS_MEMORY. */
enum status chart_image(const struct chart *chart, struct image *out,
                        struct reason *reason) MUST_USE;

/* Writes the chart to files, each completely or not at all; NULL: not that file.
 * Errors: STATUS_INPUT cannot write; those of chart_image. */
enum status chart_write(const struct chart *chart, const char *svg_path, const char *png_path,
                        struct reason *reason) MUST_USE;

#endif

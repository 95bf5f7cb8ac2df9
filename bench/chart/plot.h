/* Scatter plots with logarithmic axes, as SVG: figures one below the other, each a row of panels
 * that share a legend. Knows nothing of rays. */
#ifndef PLOT_H
#define PLOT_H

#include "ref/base/base.h"

#include <stdio.h>

#define PLOT_PANELS 3

/* How a series looks everywhere: taken modulo the number of colours, shapes and fills. */
struct plot_series {
    const char *name;
    unsigned colour, shape, fill;
};

/* x and y are positive. A bar is drawn from lo to hi where they differ from the value; a low end
 * of 0 reaches the axis. */
struct plot_point {
    size_t series; /* index in plot_figure.series */
    double x, x_lo, x_hi;
    double y, y_lo, y_hi; /* y not finite: the point is left out; y 0: drawn on the axis */
    bool below;           /* y is an upper limit: an arrow points down from it */
};

struct plot_panel {
    const char *title;
    const char *x_label, *y_label; /* with units */
    const struct plot_point *point;
    size_t count;
};

struct plot_figure {
    const char *title, *subtitle;
    const struct plot_series *series;
    size_t series_count;
    struct plot_panel panel[PLOT_PANELS];
    size_t panel_count; /* 1 to PLOT_PANELS */
};

/* Writes one SVG document of `count` figures, 1 or more. Any text is escaped. Write errors are left
 * in the stream for its owner. */
void plot_write(FILE *stream, const struct plot_figure *figure, size_t count);

/* The same to a file, whole or not at all. Errors: STATUS_INPUT cannot write there, STATUS_MEMORY. */
enum status plot_write_file(const char *path, const struct plot_figure *figure, size_t count,
                            struct reason *reason) MUST_USE;

#endif

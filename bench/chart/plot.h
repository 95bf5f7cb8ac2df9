/* Scatter plots with logarithmic axes as SVG. Figures are placed below each other; each is a row of
 * panels with a shared legend. Independent of ray tracing. */
#ifndef PLOT_H
#define PLOT_H

#include "ref/base/base.h"

#include <stdio.h>

#define PLOT_PANELS 3

#define PLOT_SHAPES 8u
#define PLOT_FILLS  3u

/* The look of a series. Values are taken modulo the number of colours, shapes and fills. */
struct plot_series {
    const char *name;
    unsigned colour, shape, fill;
};

/* x and y are positive. A bar is drawn from lo to hi if they differ from the value; a low end of 0
 * reaches the axis. */
struct plot_point {
    size_t series; /* index in plot_figure.series */
    double x, x_lo, x_hi;
    double y, y_lo, y_hi; /* y not finite: the point is not drawn; y 0: drawn on the axis */
    bool below;           /* y is an upper limit, drawn with an arrow downwards */
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

/* Gives series that share shape and fill with an earlier one another pair, as long as there are
 * free ones: no two of the first PLOT_SHAPES * PLOT_FILLS differ by colour alone. */
void plot_tell_apart(struct plot_series *series, size_t count);

/* Writes `count` figures, 1 or more, as one SVG document. All text is escaped. Write errors stay in
 * the stream for its owner. */
void plot_write(FILE *stream, const struct plot_figure *figure, size_t count);

/* Writes the document to a file, completely or not at all. Errors: STATUS_INPUT cannot write,
 * STATUS_MEMORY. */
enum status plot_write_file(const char *path, const struct plot_figure *figure, size_t count,
                            struct reason *reason) MUST_USE;

#endif

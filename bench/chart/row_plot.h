/* Figures from the JSON rows of raydiff bench: speed against error, size against speed, and the
 * matrix. */
#ifndef ROW_PLOT_H
#define ROW_PLOT_H

#include "bench/chart/plot.h"

#include <jansson.h>

#define ROW_PLOT_FIGURES 16u   /* limit; `more` is set if there are further scenes and ray sets */
#define ROW_PLOT_ROWS    4096u /* number of rows that are read */

/* Figures and all they point to. Borrows the rows. */
struct row_plots {
    struct plot_figure *figure;
    size_t count;
    struct row_plot_page *page; /* `count` of them */
    bool more;
};

/* Figures of benchmark "error": one for each scene and ray set, with panels for inexact answers,
 * leaks (if counted) and the error of t.
 *   rows    an array of objects; members that are missing or of another type are not drawn
 *   driver  the driver of engine vulkan, for the subtitle, or ""
 * Errors: STATUS_MEMORY. */
enum status row_plots_error(const json_t *rows, const char *driver, struct row_plots *out,
                            struct reason *reason) MUST_USE;

/* Figures of benchmarks "layouts" and "error": one for each scene, with a panel for each ray set
 * (at most PLOT_PANELS). They show the bytes of the tree per triangle, or with `memory` all memory
 * that the engine holds per triangle. Rows without such bytes and figures without points are
 * omitted. Errors: STATUS_MEMORY. */
enum status row_plots_size(const json_t *rows, bool memory, struct row_plots *out,
                           struct reason *reason) MUST_USE;

/* The figure of benchmark "matrix": size against speed, with a panel for each scene (at most
 * PLOT_PANELS) and a point for each contestant at its first number of threads. Errors:
 * STATUS_MEMORY. */
enum status row_plots_matrix(const json_t *rows, struct row_plots *out,
                             struct reason *reason) MUST_USE;

void row_plots_free(struct row_plots *plots);

#endif

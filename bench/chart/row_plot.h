/* Figures from rows of raydiff bench, as its JSON has them: speed against error, size against
 * speed, and the matrix. */
#ifndef ROW_PLOT_H
#define ROW_PLOT_H

#include "bench/chart/plot.h"

#include <jansson.h>

#define ROW_PLOT_FIGURES 16u   /* at most; for scenes and ray sets beyond, `more` is set */
#define ROW_PLOT_ROWS    4096u /* that are looked at */

/* Figures with all that they point to; borrows the rows. */
struct row_plots {
    struct plot_figure *figure;
    size_t count;
    struct row_plot_page *page; /* `count` */
    bool more;
};

/* Of benchmark "error": a figure for each scene and ray set, with panels for answers that are not
 * the exact one, leaks (if counted) and the error of t.
 *   rows    an array of objects; members that are missing or of another type are left out of the
 *           figure
 *   driver  what engine vulkan runs on, for the subtitle, or ""
 * Errors: STATUS_MEMORY. */
enum status row_plots_error(const json_t *rows, const char *driver, struct row_plots *out,
                            struct reason *reason) MUST_USE;

/* Of benchmarks "layouts" and "error": a figure for each scene, with a panel for each ray set (at
 * most PLOT_PANELS), of the bytes of the tree per triangle, or of all memory that the engine holds
 * per triangle. Rows without such bytes are left out; so are figures without points.
 * Errors: STATUS_MEMORY. */
enum status row_plots_size(const json_t *rows, bool memory, struct row_plots *out,
                           struct reason *reason) MUST_USE;

/* Of benchmark "matrix": one figure of size against speed, with a panel for each scene (at most
 * PLOT_PANELS) and a point for each contestant, of its first number of threads. Errors:
 * STATUS_MEMORY. */
enum status row_plots_matrix(const json_t *rows, struct row_plots *out,
                             struct reason *reason) MUST_USE;

void row_plots_free(struct row_plots *plots);

#endif

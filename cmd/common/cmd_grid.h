/* Tables whose rows are written one by one as texts. For commands only. */
#ifndef CMD_GRID_H
#define CMD_GRID_H

#include "cmd/common/cmd_screen.h"

#define GRID_LINE_MOST 480u /* bytes of a row, its end included */

struct grid_row {
    char cells[GRID_LINE_MOST]; /* separated by tabs */
    enum paint paint;           /* of the first column */
};

/* All members but `column` and `column_count` begin as 0. */
struct row_grid {
    const struct column *column;
    size_t column_count;
    struct grid_row *row;
    size_t row_count, capacity;
};

/* Adds a row: cells separated by tabs. It is left out if there is no memory. */
void grid_add(struct row_grid *grid, enum paint paint, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints titles and rows, all columns if the screen is `wide`, and removes the rows. */
void grid_print(struct row_grid *grid, const struct screen *screen);

#endif

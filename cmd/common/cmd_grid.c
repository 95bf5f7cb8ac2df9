#include "cmd/common/cmd_grid.h"

#include "ref/base/base.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void grid_add(struct row_grid *grid, enum paint paint, const char *format, ...)
{
    if (array_reserve(&grid->row, &grid->capacity, grid->row_count + 1, sizeof *grid->row))
        return;
    struct grid_row *row = &grid->row[grid->row_count++];
    va_list args;
    va_start(args, format);
    vsnprintf(row->cells, sizeof row->cells, format, args);
    va_end(args);
    row->paint = paint;
}

static void write_cell(const void *data, size_t row, size_t column, char *text)
{
    const struct row_grid *grid = data;
    const char *at = grid->row[row].cells;
    for (size_t c = 0; c < column && *at; c++)
        at += strcspn(at, "\t") + 1;
    snprintf(text, CELL_MOST, "%.*s", (int)strcspn(at, "\t"), at);
}

static enum paint paint_of(const void *data, size_t row)
{
    const struct row_grid *grid = data;
    return grid->row[row].paint;
}

void grid_print(struct row_grid *grid, const struct screen *screen)
{
    const struct table_text table = {.column = grid->column,
                                     .column_count = grid->column_count,
                                     .row_count = grid->row_count,
                                     .data = grid,
                                     .cell = write_cell,
                                     .paint = paint_of};
    struct screen all = *screen;
    all.width = screen->wide ? UINT_MAX : screen->width;
    table_text_print(&table, &all);
    free(grid->row);
    grid->row = NULL;
    grid->row_count = grid->capacity = 0;
}

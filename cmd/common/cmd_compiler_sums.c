/* All rows of a compiler and an engine as one line. */
#include "cmd/common/cmd_compiler_inner.h"

#include "ref/base/text.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    COL_COMPILER,
    COL_ENGINE,
    COL_ROWS,
    COL_KEPT,
    COL_OPEN,
    COL_EQUAL,
    COL_OTHER,
    COL_WRONG,
    COL_SPEED,
    COL_SPAN
};

static const struct column columns[] = {
    [COL_COMPILER] = {"compiler", .left = true},
    [COL_ENGINE] = {"engine", .left = true},
    [COL_ROWS] = {"rows"},
    [COL_KEPT] = {"NoContraction"},
    [COL_OPEN] = {"open"},
    [COL_EQUAL] = {"equal"},
    [COL_OTHER] = {"other"},
    [COL_WRONG] = {"WRONG"},
    [COL_SPEED] = {"speed", .least = 6},
    [COL_SPAN] = {"least-most"},
};

struct compiler_sum {
    const struct row *first; /* of these rows */
    bool failed;             /* one of them */
    size_t rows, equal;
    size_t ops, kept, open, other, wrong; /* of all of them */
    double speed, least, most;            /* the median first; 0: there is none */
};

static bool belongs(const struct compiler_sum *sum, const struct row *row)
{
    return row->compiled.raw == sum->first->compiled.raw && row->engine == sum->first->engine;
}

/* Adds up the rows of one engine; `speed` has room for one of each row. */
static void add_up(const struct compiled_rows *rows, struct compiler_sum *sum, double *speed)
{
    size_t speeds = 0;
    for (size_t i = 0; i < rows->count; i++) {
        const struct row *row = rows->row[i];
        if (!belongs(sum, row))
            continue;
        sum->rows++;
        sum->failed = sum->failed || row_failed(row);
        sum->equal += compiled_equal(row);
        sum->ops += row->compiled.ops;
        sum->kept += row->compiled.kept;
        sum->open += row->compiled.foreign;
        sum->other += row->bits ? row->bit_differences : row->moved;
        sum->wrong += row->count[VERDICT_WRONG];
        if (compiled_speed(rows, i) > 0)
            speed[speeds++] = compiled_speed(rows, i);
    }
    if (speeds == 0)
        return;
    sort_doubles(speed, speeds);
    sum->speed = speeds % 2 ? speed[speeds / 2] : (speed[speeds / 2 - 1] + speed[speeds / 2]) / 2;
    sum->least = speed[0];
    sum->most = speed[speeds - 1];
}

static void write_cell(const void *data, size_t i, size_t column, char *text)
{
    const struct compiler_sum *sum = (const struct compiler_sum *)data + i;
    const size_t number[] = {[COL_ROWS] = sum->rows,
                             [COL_OPEN] = sum->open,
                             [COL_EQUAL] = sum->equal,
                             [COL_OTHER] = sum->other,
                             [COL_WRONG] = sum->wrong};
    switch (column) {
    case COL_COMPILER:
        cell_put(text, sum->first->compiled.compiler);
        break;
    case COL_ENGINE:
        cell_put(text, sum->first->compiled.raw->name);
        break;
    case COL_KEPT:
        if (sum->first->compiled.free)
            snprintf(text, CELL_MOST, "free, %zu", sum->ops);
        else
            snprintf(text, CELL_MOST, "%zu of %zu", sum->kept, sum->ops);
        break;
    case COL_SPEED:
        if (sum->speed > 0)
            snprintf(text, CELL_MOST, "%.2f", sum->speed);
        else
            cell_put(text, "-");
        break;
    case COL_SPAN:
        if (sum->speed > 0)
            snprintf(text, CELL_MOST, "%.2f-%.2f", sum->least, sum->most);
        else
            cell_put(text, "-");
        break;
    default:
        snprintf(text, CELL_MOST, "%zu", number[column]);
        break;
    }
}

static enum paint paint_of(const void *data, size_t i)
{
    const struct compiler_sum *sum = (const struct compiler_sum *)data + i;
    return sum->failed ? PAINT_BAD : PAINT_GOOD;
}

/* The sums of engines with several rows, in the order of their first ones. */
static size_t sums_of(const struct compiled_rows *rows, struct compiler_sum *sum, double *speed)
{
    size_t count = 0;
    for (size_t i = 0; i < rows->count; i++) {
        struct compiler_sum *mine = &sum[count];
        bool is_first = true;
        *mine = (struct compiler_sum){.first = rows->row[i]};
        for (size_t k = 0; k < i; k++)
            is_first = is_first && !belongs(mine, rows->row[k]);
        if (!is_first)
            continue;
        add_up(rows, mine, speed);
        count += mine->rows > 1;
    }
    return count;
}

enum status compiled_sums_print(const struct compiled_rows *rows, const struct screen *screen)
{
    struct compiler_sum *sum = alloc_zeroed(rows->count, sizeof *sum);
    double *speed = alloc_zeroed(rows->count, sizeof *speed);
    const bool has_room = sum && speed;
    const size_t count = has_room ? sums_of(rows, sum, speed) : 0;
    const struct table_text table = {columns, ARRAY_COUNT(columns), count, sum, write_cell, NULL,
                                     paint_of};
    if (count > 0) {
        screen_text(screen, "all rows of a compiler: how many have equal bits, answers with other "
                            "bits, median speed\n");
        table_text_print(&table, screen);
    }
    free(sum);
    free(speed);
    return has_room ? STATUS_OK : STATUS_MEMORY;
}

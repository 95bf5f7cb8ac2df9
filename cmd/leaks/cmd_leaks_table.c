/* The table of raydiff leaks that fits the screen. */
#include "cmd/leaks/cmd_leaks.h"

#include "ref/store.h"

#include <stdio.h>
#include <string.h>

enum {
    COL_VERDICT,
    COL_LAYOUT,
    COL_ENGINE,
    COL_BUILDER,
    COL_BOX,
    COL_TRI,
    COL_MISSES,
    COL_AIM, /* misses by aim */
    COL_DOUBLES = COL_AIM + LEAK_AIMS,
    COL_LOST,
    COL_PHANTOMS,
    COL_EVEN,
    COL_REPEATED,
    COL_BITS,
    COL_COUNT
};

static const struct column columns[COL_COUNT] = {
    [COL_VERDICT] = {"verdict", .left = true},
    [COL_LAYOUT] = {"layout", .left = true},
    [COL_ENGINE] = {"engine", .left = true},
    [COL_BUILDER] = {"builder", .left = true, .varies = true, .rank = 3},
    [COL_BOX] = {"box", .left = true, .varies = true, .rank = 2},
    [COL_TRI] = {"tri", .left = true, .varies = true, .rank = 1},
    [COL_MISSES] = {.title = "misses"},
    [COL_AIM] = {"vertex", .rank = 10},
    {"midpoint", .rank = 11},
    {"edge", .rank = 12},
    {"beside", .rank = 13},
    [COL_DOUBLES] = {"doubles", .rank = 4},
    [COL_LOST] = {"lost", .rank = 5},
    [COL_PHANTOMS] = {"phantom", .rank = 6},
    [COL_EVEN] = {"even", .rank = 8},
    [COL_REPEATED] = {"repeat", .rank = 9},
    [COL_BITS] = {"bits", .rank = 7},
};
_Static_assert(COL_DOUBLES == COL_AIM + 4, "a column for each aim");

static const char *verdict_of(const struct leak_row *row)
{
    if (row->status)
        return leak_row_ended(row);
    return row->broken[0] ? "BROKEN" : row->promises ? "kept" : "counted";
}

static void write_number(const struct leak_row *row, size_t column, char *text)
{
    struct leak_tally sum = leaks_total(&row->leaks);
    const size_t of_lists[] = {
        [COL_DOUBLES] = sum.doubles, [COL_LOST] = sum.lost,         [COL_PHANTOMS] = sum.phantoms,
        [COL_EVEN] = sum.even,       [COL_REPEATED] = sum.repeated,
    };
    bool known = column < COL_DOUBLES || (column == COL_BITS ? row->compared : row->leaks.lists);
    size_t number = column == COL_MISSES   ? sum.misses
                    : column < COL_DOUBLES ? row->leaks.tally[column - COL_AIM].misses
                    : column == COL_BITS   ? row->bit_differences
                                           : of_lists[column];
    snprintf(text, CELL_MOST, known ? "%zu" : "-", number);
}

static void write_cell(const void *data, size_t i, size_t column, char *text)
{
    const struct leak_row *row = &((const struct leak_scene *)data)->row[i];
    char name[STORED_NAME_MOST];
    const char *word = NULL;
    switch (column) {
    case COL_VERDICT:
        word = verdict_of(row);
        break;
    case COL_LAYOUT:
        word = stored_name(row->layout, row->store, name);
        break;
    case COL_ENGINE:
        word = row->engine ? row->engine->name : "-";
        break;
    case COL_BUILDER:
        word = row->layout ? row->builder->name : "-";
        break;
    case COL_BOX:
        word = row->engine && !row->engine->needs_packed ? "-" : row->box->name;
        break;
    case COL_TRI:
        word = leak_row_tri(row);
        break;
    default:
        write_number(row, column, text);
        return;
    }
    cell_put(text, word);
}

static struct row_note write_note(const void *data, size_t i)
{
    const struct leak_row *row = &((const struct leak_scene *)data)->row[i];
    return (struct row_note){COL_BUILDER, row->status ? row->reason.text : NULL};
}

static enum paint paint_of(const void *data, size_t i)
{
    const struct leak_row *row = &((const struct leak_scene *)data)->row[i];
    if (row->broken[0])
        return PAINT_BAD;
    return row->status || !row->promises ? PAINT_DIM : PAINT_GOOD;
}

void leaks_print_table(const struct leak_scene *scene, const struct screen *screen)
{
    const struct table_text table = {columns,    ARRAY_COUNT(columns), scene->row_count, scene,
                                     write_cell, write_note,           paint_of};
    const size_t tests[] = {COL_BUILDER, COL_BOX, COL_TRI};
    table_text_print_same(&table, tests, ARRAY_COUNT(tests), screen);
    table_text_print(&table, screen);
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct leak_row *row = &scene->row[i];
        char name[STORED_NAME_MOST];
        if (row->status == STATUS_OK && row->broken[0])
            screen_text(screen, "  %s on %s: BROKEN: %s\n", row->engine->name,
                        stored_name(row->layout, row->store, name), row->broken);
    }
}

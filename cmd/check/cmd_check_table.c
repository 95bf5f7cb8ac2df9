/* The table of raydiff check that fits the screen. */
#include "cmd/check/cmd_check.h"

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
    COL_QUERY,
    COL_WRONG,
    COL_ALLOWED,
    COL_BITS,
    COL_HITS,
    COL_BYTES,
    COL_ERROR,
    COL_SPEED,
    COL_SPAN
};

static const struct column columns[] = {
    [COL_VERDICT] = {"verdict", .left = true},
    [COL_LAYOUT] = {"layout", .left = true},
    [COL_ENGINE] = {"engine", .left = true},
    [COL_BUILDER] = {"builder", .left = true, .varies = true, .rank = 4},
    [COL_BOX] = {"box", .left = true, .varies = true, .rank = 3},
    [COL_TRI] = {"tri", .left = true, .varies = true, .rank = 2},
    [COL_QUERY] = {"query", .left = true, .varies = true, .rank = 1},
    [COL_WRONG] = {.title = "wrong"},
    [COL_ALLOWED] = {"allowed", .rank = 6},
    [COL_BITS] = {"bits", .rank = 9},
    [COL_HITS] = {"hits", .rank = 8},
    [COL_BYTES] = {"B/tri", .rank = 7},
    [COL_ERROR] = {"err/E", .rank = 10},
    [COL_SPEED] = {"Mray/s", .rank = 5},
    [COL_SPAN] = {"least-most", .rank = 11},
};

static bool ran(const struct row *row)
{
    return row->status == ROW_OK || row->status == ROW_VACUOUS;
}

static const char *verdict_of(const struct row *row)
{
    if (row->status != ROW_OK)
        return row_status_name(row->status);
    if (!row->judged)
        return "counted";
    if (row->count[VERDICT_WRONG])
        return "WRONG";
    if (row->bits && row->bit_differences && row->differences)
        return "BITS";
    if (!row->compiled.translates && engine_compiled_lost(&row->compiled))
        return "PRECISE";
    return row->differences ? "LOST" : "agrees";
}

static void write_bytes(const struct check_scene *scene, const struct row *row, char *text)
{
    uint64_t bytes = row->node_bytes + row->item_bytes + row->scene_bytes;
    if (row_bytes_known(row) && scene->tri_count)
        snprintf(text, CELL_MOST, "%.1f", (double)bytes / scene->tri_count);
    else
        strcpy(text, "-");
}

static size_t allowed_count(const struct row *row)
{
    size_t sum = 0;
    for (enum verdict v = VERDICT_RIGHT + 1; v < VERDICT_WRONG; v++)
        sum += row->count[v];
    return sum;
}

static void write_number(const struct check_scene *scene, const struct row *row, size_t column,
                         char *text)
{
    switch (column) {
    case COL_WRONG:
        snprintf(text, CELL_MOST, "%zu", row->count[VERDICT_WRONG]);
        break;
    case COL_ALLOWED:
        snprintf(text, CELL_MOST, "%zu", allowed_count(row));
        break;
    case COL_HITS:
        snprintf(text, CELL_MOST, "%zu", row->hits);
        break;
    case COL_BITS:
        snprintf(text, CELL_MOST, row->bits || row_counts_bits(row) ? "%zu" : "-",
                 row->bits ? row->bit_differences : row->moved);
        break;
    case COL_ERROR:
        snprintf(text, CELL_MOST, row->displacement.count ? "-" : "%.2f", row->worst_over);
        break;
    case COL_SPEED:
        snprintf(text, CELL_MOST, row->mrays[0] > 0 ? "%.3f" : "-", row->mrays[0]);
        break;
    case COL_SPAN:
        snprintf(text, CELL_MOST, row->mrays[0] > 0 ? "%.3f-%.3f" : "-", row->mrays[1],
                 row->mrays[2]); /* of a file's answers there is none */
        break;
    default:
        write_bytes(scene, row, text);
        break;
    }
}

static void write_cell(const void *data, size_t i, size_t column, char *text)
{
    const struct check_scene *scene = data;
    const struct row *row = &scene->row[i];
    char name[STORED_NAME_MOST];
    const char *word = NULL;
    switch (column) {
    case COL_VERDICT:
        word = verdict_of(row);
        break;
    case COL_LAYOUT:
        word = stored_name(row->layout, row->options.store, name);
        break;
    case COL_ENGINE:
        word = row->engine ? row->engine->name : "-";
        break;
    case COL_BUILDER:
        word = row->layout ? row->options.builder->name : "-";
        break;
    case COL_BOX:
        word = row_box_name(row);
        break;
    case COL_TRI:
        word = row_tri_name(row);
        break;
    case COL_QUERY:
        word = query_name(row->options.query);
        break;
    default:
        write_number(scene, row, column, text);
        return;
    }
    cell_put(text, word);
}

static struct row_note write_note(const void *data, size_t i)
{
    const struct row *row = &((const struct check_scene *)data)->row[i];
    return (struct row_note){COL_BUILDER, ran(row) ? NULL : row->reason.text};
}

static enum paint paint_of(const void *data, size_t i)
{
    const struct row *row = &((const struct check_scene *)data)->row[i];
    if (row->status == ROW_FAILED || row_failed(row))
        return PAINT_BAD;
    return row->status == ROW_OK && row->judged ? PAINT_GOOD : PAINT_DIM;
}

/* Prints what rows have besides their columns. */
static void print_notes(const struct check_scene *scene, const struct screen *screen)
{
    char note[CHECK_NOTE_MOST], name[STORED_NAME_MOST];
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (!ran(row))
            continue;
        check_row_note(row, note);
        if (note[0])
            screen_text(screen, "  %s on %s, %s %s:%s\n", row->engine->name,
                        stored_name(row->layout, row->options.store, name), row_tri_name(row),
                        query_name(row->options.query), note);
    }
}

void check_print_table(const struct check_scene *scene, const struct screen *screen)
{
    const struct table_text table = {columns,    ARRAY_COUNT(columns), scene->row_count, scene,
                                     write_cell, write_note,           paint_of};
    const size_t tests[] = {COL_BOX, COL_TRI, COL_QUERY};
    table_text_print_same(&table, tests, ARRAY_COUNT(tests), screen);
    table_text_print(&table, screen);
    print_notes(scene, screen);
}

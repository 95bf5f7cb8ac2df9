#include "tests/hard/matrix.h"

#include "tests/hard/members.h"

#include <stdlib.h>
#include <string.h>

const char *outcome_name(enum matrix_outcome outcome)
{
    static const char *const names[OUTCOME_COUNT] = {"skipped", "refused", "passed",
                                                     "known",   "waived",  "failed"};
    return (size_t)outcome < OUTCOME_COUNT ? names[outcome] : "unknown";
}

const char *outcome_meaning(enum matrix_outcome outcome)
{
    static const char *const meanings[OUTCOME_COUNT] = {
        "skipped: the engine cannot run here",
        "refused: a builder, layout or engine says why it will not take the scene",
        "passed",
        "known: shows the defect that the case is there to show",
        "waived: fails, and a waiver says why that is known",
        "FAILED",
    };
    return (size_t)outcome < OUTCOME_COUNT ? meanings[outcome] : "";
}

static bool is_engine(const struct engine *engine)
{
    for (size_t i = 0; engines[i]; i++)
        if (engines[i] == engine)
            return true;
    return false;
}

static struct matrix_column column_made_of(const struct hard_matrix *matrix,
                                           const struct hard_member *m)
{
    struct matrix_column c = {.engine = m->engine, .layout = m->layout};
    c.published = hard_member_published(m) > 0;
    c.made = (m->layout && !hard_table_has(layouts_all, m->layout)) || !is_engine(m->engine) ||
             (m->engine->needs_packed && !m->layout); /* a driver, measured directly */
    c.others = !matrix->apart && !c.made && m->layout && !hard_table_has(layouts, m->layout);
    if (c.others)
        c.layout = NULL;
    if (!c.others && !m->engine->own_tri && !(c.published && m->layout))
        c.tri = m->tri;
    return c;
}

static enum status column_of(struct hard_matrix *matrix, const struct hard_member *m,
                             size_t *column)
{
    const struct matrix_column c = column_made_of(matrix, m);
    for (*column = 0; *column < matrix->column_count; ++*column) {
        const struct matrix_column *at = &matrix->column[*column];
        if (at->engine == c.engine && at->layout == c.layout && at->tri == c.tri &&
            at->published == c.published && at->others == c.others)
            return STATUS_OK;
    }
    void *columns = matrix->column;
    enum status status = array_reserve(&columns, &matrix->column_room, *column + 1, sizeof c);
    matrix->column = columns;
    if (!status)
        matrix->column[matrix->column_count++] = c;
    return status;
}

static enum status row_of(struct hard_matrix *matrix, const struct hard_case *one, size_t *row)
{
    for (*row = 0; *row < matrix->row_count; ++*row)
        if (matrix->row[*row] == one)
            return STATUS_OK;
    void *rows = matrix->row;
    enum status status =
        array_reserve(&rows, &matrix->row_room, matrix->row_count + 1, sizeof(void *));
    matrix->row = rows;
    if (!status)
        matrix->row[matrix->row_count++] = one;
    return status;
}

static enum status cell_of(struct matrix_column *column, size_t row, struct matrix_cell **cell)
{
    void *cells = column->cell;
    const size_t had = column->cell_room;
    enum status status = array_reserve(&cells, &column->cell_room, row + 1, sizeof **cell);
    column->cell = cells;
    if (status)
        return status;
    memset(column->cell + had, 0, (column->cell_room - had) * sizeof **cell);
    *cell = &column->cell[row];
    return STATUS_OK;
}

static char *copy(const char *text)
{
    char *out = alloc_zeroed(strlen(text) + 1, 1);
    return out ? strcpy(out, text) : NULL;
}

static enum status note(struct hard_matrix *matrix, const struct hard_case *one,
                        const struct hard_member *member, enum matrix_outcome outcome,
                        const char *why)
{
    for (size_t i = 0; i < matrix->note_count && outcome != OUTCOME_FAILED; i++)
        if (matrix->note[i].outcome == outcome && strcmp(matrix->note[i].why, why) == 0) {
            matrix->note[i].count++;
            return STATUS_OK;
        }
    void *notes = matrix->note;
    enum status status =
        array_reserve(&notes, &matrix->note_room, matrix->note_count + 1, sizeof *matrix->note);
    matrix->note = notes;
    if (status)
        return status;
    char name[HARD_NAME_MOST];
    hard_name_print(one, member, name);
    struct matrix_note made = {copy(name), copy(why), outcome, 1};
    matrix->note[matrix->note_count++] = made;
    return made.name && made.why ? STATUS_OK : STATUS_MEMORY;
}

enum status matrix_add(struct hard_matrix *matrix, const struct hard_case *one,
                       const struct hard_member *member, enum matrix_outcome outcome, size_t rays,
                       const char *why, struct reason *reason)
{
    size_t row, column;
    struct matrix_cell *cell = NULL;
    enum status status = column_of(matrix, member, &column);
    if (!status)
        status = row_of(matrix, one, &row);
    if (!status)
        status = cell_of(&matrix->column[column], row, &cell);
    if (!status && outcome >= OUTCOME_KNOWN)
        status = note(matrix, one, member, outcome, why);
    if (status)
        return fail(reason, status, "no memory for the matrix");
    cell->count[outcome]++;
    matrix->total[outcome]++;
    matrix->rays += rays;
    return STATUS_OK;
}

void matrix_free(struct hard_matrix *matrix)
{
    for (size_t i = 0; i < matrix->note_count; i++) {
        free(matrix->note[i].name);
        free(matrix->note[i].why);
    }
    for (size_t c = 0; c < matrix->column_count; c++)
        free(matrix->column[c].cell);
    free(matrix->note);
    free(matrix->row);
    free(matrix->column);
    *matrix = (struct hard_matrix){0};
}

const struct matrix_cell *matrix_at(const struct hard_matrix *matrix, size_t row, size_t column)
{
    static const struct matrix_cell none = {.count = {0}};
    const struct matrix_column *c = &matrix->column[column];
    return row < c->cell_room ? &c->cell[row] : &none;
}

enum matrix_outcome matrix_worst(const struct matrix_cell *cell)
{
    for (int o = OUTCOME_COUNT - 1; o >= 0; o--)
        if (cell->count[o] > 0)
            return (enum matrix_outcome)o;
    return OUTCOME_COUNT;
}

const char *matrix_table_title(size_t table)
{
    static const char *const titles[MATRIX_TABLES] = {
        "Repaired members", "Members as published, faults included",
        "Members made to be wrong, drivers asked directly"};
    return titles[table];
}

bool matrix_in_table(const struct hard_matrix *matrix, size_t column, size_t table)
{
    const struct matrix_column *c = &matrix->column[column];
    return table == (c->made ? 2 : c->published ? 1 : 0);
}

bool matrix_table_is_empty(const struct hard_matrix *matrix, size_t table)
{
    for (size_t c = 0; c < matrix->column_count; c++)
        if (matrix_in_table(matrix, c, table))
            return false;
    return true;
}

const char *matrix_layout_name(const struct matrix_column *column)
{
    if (column->others)
        return "others";
    return column->layout ? column->layout->name : "-";
}

const char *matrix_tri_name(const struct matrix_column *column)
{
    if (column->tri)
        return column->tri->name;
    return column->engine->own_tri ? "own" : "all";
}

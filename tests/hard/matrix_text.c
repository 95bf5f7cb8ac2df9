#include "tests/hard/matrix.h"

#include <string.h>

static const char *const glyphs[OUTCOME_COUNT + 1] = {"s", "r", ".", "k", "w", "F", " "};

#define NAME_WIDTH   22
#define COLUMN_WIDTH 7

/* One line of a heading; a name equal to the previous column's is left out. */
static void text_heading(const struct hard_matrix *matrix, size_t table, int level, FILE *out)
{
    static const char *const words[] = {"engine", "layout", "triangle test"};
    const char *last = "";
    fprintf(out, "%-*s", NAME_WIDTH + 4, words[level]);
    for (size_t c = 0; c < matrix->column_count; c++) {
        if (!matrix_in_table(matrix, c, table))
            continue;
        const struct matrix_column *column = &matrix->column[c];
        const char *name = level == 0   ? column->engine->name
                           : level == 1 ? matrix_layout_name(column)
                                        : matrix_tri_name(column);
        char cut[COLUMN_WIDTH];
        /* "rtrs_rf_paper" and "embree_robust" differ behind the sixth letter */
        const char *tail = strlen(name) >= COLUMN_WIDTH ? strrchr(name, '_') : NULL;
        snprintf(cut, sizeof cut, "%.6s", tail && tail[1] ? tail + 1 : name);
        fprintf(out, " %-*s", COLUMN_WIDTH - 1, level < 2 && strcmp(last, name) == 0 ? "" : cut);
        last = name;
    }
    fputc('\n', out);
}

static void text_table(const struct hard_matrix *matrix, size_t table, FILE *out)
{
    fprintf(out, "\n%s\n", matrix_table_title(table));
    for (int level = 0; level < 3; level++)
        text_heading(matrix, table, level, out);
    for (size_t r = 0; r < matrix->row_count; r++) {
        bool any = false;
        for (size_t c = 0; c < matrix->column_count; c++)
            any |= matrix_in_table(matrix, c, table) &&
                   matrix_worst(matrix_at(matrix, r, c)) != OUTCOME_COUNT;
        if (!any)
            continue;
        fprintf(out, "%02u  %-*.*s", matrix->row[r]->number, NAME_WIDTH, NAME_WIDTH,
                matrix->row[r]->name);
        for (size_t c = 0; c < matrix->column_count; c++)
            if (matrix_in_table(matrix, c, table))
                fprintf(out, " %-*s", COLUMN_WIDTH - 1,
                        glyphs[matrix_worst(matrix_at(matrix, r, c))]);
        fputc('\n', out);
    }
}

static void text_notes(const struct hard_matrix *matrix, enum matrix_outcome outcome, FILE *out)
{
    bool first = true;
    for (size_t i = 0; i < matrix->note_count; i++) {
        const struct matrix_note *note = &matrix->note[i];
        if (note->outcome != outcome)
            continue;
        if (first)
            fprintf(out, "\n%s\n", outcome_meaning(outcome));
        first = false;
        if (outcome == OUTCOME_FAILED)
            fprintf(out, "  raydiff conform '%s'\n      %s\n", note->name, note->why);
        else
            fprintf(out, "  %6zu  %s\n          first: %s\n", note->count, note->why, note->name);
    }
}

static void text_totals(const struct hard_matrix *matrix, FILE *out)
{
    fprintf(out, "\n%zu hard cases, %zu rays:", matrix->row_count, matrix->rays);
    for (int o = OUTCOME_COUNT - 1; o >= 0; o--)
        fprintf(out, " %zu %s%s", matrix->total[o], outcome_name((enum matrix_outcome)o),
                o ? "," : "\n");
}

void matrix_text(const struct hard_matrix *matrix, FILE *out)
{
    fputs("legend, the worst of a cell's trials:", out);
    for (size_t o = 0; o < OUTCOME_COUNT; o++)
        fprintf(out, "\n  %s  %s", glyphs[o], outcome_meaning((enum matrix_outcome)o));
    fputc('\n', out);
    for (size_t t = 0; t < MATRIX_TABLES; t++)
        if (!matrix_table_is_empty(matrix, t))
            text_table(matrix, t, out);
    text_notes(matrix, OUTCOME_KNOWN, out);
    text_notes(matrix, OUTCOME_WAIVED, out);
    text_notes(matrix, OUTCOME_FAILED, out);
    text_totals(matrix, out);
}

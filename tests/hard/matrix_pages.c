/* The matrix as Markdown and as HTML: the same document in two styles. */
#include "tests/hard/matrix.h"

#include <string.h>

/* The markup of one of the two. */
struct style {
    const char *head, *foot;               /* of the document */
    const char *title, *title_end;         /* a heading */
    const char *paragraph, *paragraph_end; /* text */
    const char *table, *table_end;         /* rows */
    const char *row, *row_end, *cell, *cell_end;
    const char *code, *code_end;
    bool html;
};

static const struct style markdown = {
    .head = "",
    .foot = "",
    .title = "\n## ",
    .title_end = "\n\n",
    .paragraph = "",
    .paragraph_end = "\n\n",
    .table = "",
    .table_end = "\n",
    .row = "|",
    .row_end = "\n",
    .cell = " ",
    .cell_end = " |",
    .code = "`",
    .code_end = "`",
};

static const struct style page = {
    .head = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
            "<title>raydiff: hard cases</title>\n<style>\n"
            "body{font:14px/1.4 sans-serif;margin:2em;max-width:110em}\n"
            "table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:2px 6px;"
            "text-align:left;vertical-align:top}\n"
            "td.passed{background:#dff3df}td.failed{background:#e33;color:#fff;font-weight:bold}"
            "td.waived{background:#ffe9b0}td.known{background:#d6e4ff}"
            "td.refused{background:#eee}td.skipped{background:#fff;color:#777}\n"
            "code{font-size:12px}\n</style></head><body>\n<h1>Hard cases</h1>\n",
    .foot = "</body></html>\n",
    .title = "<h2>",
    .title_end = "</h2>\n",
    .paragraph = "<p>",
    .paragraph_end = "</p>\n",
    .table = "<table>\n",
    .table_end = "</table>\n",
    .row = "<tr>",
    .row_end = "</tr>\n",
    .cell = "<td>",
    .cell_end = "</td>",
    .code = "<code>",
    .code_end = "</code>",
    .html = true,
};

static void put(const struct style *style, const char *text, FILE *out)
{
    for (; *text; text++) {
        const char *entity = *text == '<'   ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '&' ? "&amp;"
                                            : "";
        if (*entity)
            fputs(entity, out);
        else if (*text == '|' && !style->html)
            fputs("\\|", out);
        else
            fputc(*text, out);
    }
}

static void put_cell(const struct style *style, const char *text, FILE *out)
{
    fputs(style->cell, out);
    put(style, text, out);
    fputs(style->cell_end, out);
}

/* "2 passed, 1 waived" */
static void put_counts(const struct style *style, const struct matrix_cell *cell, FILE *out)
{
    enum matrix_outcome bad = matrix_worst(cell);
    if (style->html)
        fprintf(out, "<td class=\"%s\" title=\"", bad == OUTCOME_COUNT ? "" : outcome_name(bad));
    for (int o = OUTCOME_COUNT - 1; o >= 0 && style->html; o--)
        if (cell->count[o])
            fprintf(out, "%zu %s ", cell->count[o], outcome_name((enum matrix_outcome)o));
    fputs(style->html ? "\">" : style->cell, out);
    fputs(bad == OUTCOME_COUNT ? "" : bad == OUTCOME_FAILED ? "FAILED" : outcome_name(bad), out);
    fputs(style->cell_end, out);
}

static void put_rule(const struct style *style, size_t columns, FILE *out)
{
    fputs(style->html ? "" : "|", out);
    for (size_t c = 0; c < columns && !style->html; c++)
        fputs("---|", out);
    fputs(style->html ? "" : "\n", out);
}

static void put_table(const struct style *style, const struct hard_matrix *matrix, size_t table,
                      FILE *out)
{
    size_t columns = 1;
    fprintf(out, "%s%s%s%s%s", style->title, matrix_table_title(table), style->title_end,
            style->table, style->row);
    put_cell(style, "case", out);
    for (size_t c = 0; c < matrix->column_count; c++) {
        char name[64];
        const struct matrix_column *column = &matrix->column[c];
        if (!matrix_in_table(matrix, c, table))
            continue;
        snprintf(name, sizeof name, "%s %s %s", column->engine->name, matrix_layout_name(column),
                 matrix_tri_name(column));
        put_cell(style, name, out);
        columns++;
    }
    fputs(style->row_end, out);
    put_rule(style, columns, out);
    for (size_t r = 0; r < matrix->row_count; r++) {
        char name[64];
        snprintf(name, sizeof name, "%02u %s", matrix->row[r]->number, matrix->row[r]->name);
        fputs(style->row, out);
        put_cell(style, name, out);
        for (size_t c = 0; c < matrix->column_count; c++)
            if (matrix_in_table(matrix, c, table))
                put_counts(style, matrix_at(matrix, r, c), out);
        fputs(style->row_end, out);
    }
    fputs(style->table_end, out);
}

static void put_recipes(const struct style *style, const struct hard_matrix *matrix, FILE *out)
{
    fprintf(out, "%sThe cases%s%s%s", style->title, style->title_end, style->table, style->row);
    put_cell(style, "case", out);
    put_cell(style, "recipe", out);
    put_cell(style, "expected", out);
    put_cell(style, "source", out);
    fputs(style->row_end, out);
    put_rule(style, 4, out);
    for (size_t r = 0; r < matrix->row_count; r++) {
        const struct hard_case *one = matrix->row[r];
        char name[64];
        snprintf(name, sizeof name, "%02u %s", one->number, one->name);
        fputs(style->row, out);
        put_cell(style, name, out);
        put_cell(style, one->recipe, out);
        put_cell(style, one->expected, out);
        put_cell(style, one->source, out);
        fputs(style->row_end, out);
    }
    fputs(style->table_end, out);
}

static void put_notes(const struct style *style, const struct hard_matrix *matrix,
                      enum matrix_outcome outcome, FILE *out)
{
    bool first = true;
    for (size_t i = 0; i < matrix->note_count; i++) {
        const struct matrix_note *note = &matrix->note[i];
        if (note->outcome != outcome)
            continue;
        if (first)
            fprintf(out, "%s%s%s", style->title, outcome_meaning(outcome), style->title_end);
        first = false;
        fprintf(out, "%s%sraydiff conform '%s'%s", style->paragraph, style->code, note->name,
                style->code_end);
        if (outcome != OUTCOME_FAILED)
            fprintf(out, " (the first of %zu)", note->count);
        fputs(": ", out);
        put(style, note->why, out);
        fputs(style->paragraph_end, out);
    }
}

static void put_document(const struct style *style, const struct hard_matrix *matrix,
                         const char *versions, FILE *out)
{
    fputs(style->html ? style->head : "# Hard cases\n\n", out);
    fputs(style->paragraph, out);
    fprintf(out, "%zu cases, %zu rays:", matrix->row_count, matrix->rays);
    for (int o = OUTCOME_COUNT - 1; o >= 0; o--)
        fprintf(out, " %zu %s%s", matrix->total[o], outcome_name((enum matrix_outcome)o),
                o ? "," : ".");
    fputs(" A cell shows the worst of its trials.", out);
    fputs(style->paragraph_end, out);
    for (size_t o = 0; o < OUTCOME_COUNT; o++)
        fprintf(out, "%s%s%s", style->html ? "<br>" : "- ", outcome_meaning((enum matrix_outcome)o),
                "\n");
    fprintf(out, "%s%s", style->title, "Played by");
    fputs(style->title_end, out);
    fputs(style->html ? "<pre>" : "```\n", out);
    put(style, versions, out);
    fputs(style->html ? "</pre>\n" : "```\n", out);
    put_notes(style, matrix, OUTCOME_FAILED, out);
    for (size_t t = 0; t < MATRIX_TABLES; t++)
        if (!matrix_table_is_empty(matrix, t))
            put_table(style, matrix, t, out);
    put_notes(style, matrix, OUTCOME_KNOWN, out);
    put_notes(style, matrix, OUTCOME_WAIVED, out);
    put_recipes(style, matrix, out);
    fputs(style->foot, out);
}

void matrix_markdown(const struct hard_matrix *matrix, const char *versions, FILE *out)
{
    put_document(&markdown, matrix, versions, out);
}

void matrix_html(const struct hard_matrix *matrix, const char *versions, FILE *out)
{
    put_document(&page, matrix, versions, out);
}

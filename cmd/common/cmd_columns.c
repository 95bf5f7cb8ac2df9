/* Tables that fit the screen. */
#include "cmd/common/cmd_screen.h"

#include <stdio.h>
#include <string.h>

static struct row_note note_of(const struct table_text *table, size_t row)
{
    return table->note ? table->note(table->data, row) : (struct row_note){0, NULL};
}

/* Whether a cell stands for a member without such a part, or with one of its own. */
static bool stands_apart(const char *cell)
{
    return strcmp(cell, "-") == 0 || strcmp(cell, "own") == 0;
}

bool table_text_same(const struct table_text *table, size_t column, char *text)
{
    char cell[CELL_MOST];
    bool first = true;
    text[0] = '\0';
    for (size_t i = 0; i < table->row_count; i++) {
        if (note_of(table, i).text)
            continue;
        table->cell(table->data, i, column, cell);
        if (stands_apart(cell))
            continue;
        if (first)
            snprintf(text, CELL_MOST, "%s", cell);
        else if (strcmp(text, cell) != 0)
            return false;
        first = false;
    }
    return true;
}

static size_t width_of(const struct table_text *table, size_t column)
{
    char cell[CELL_MOST];
    size_t most = strlen(table->column[column].title);
    if (table->column[column].least > most)
        most = table->column[column].least;
    for (size_t i = 0; i < table->row_count; i++) {
        struct row_note note = note_of(table, i);
        if (note.text && column >= note.from)
            continue;
        table->cell(table->data, i, column, cell);
        if (strlen(cell) > most)
            most = strlen(cell);
    }
    return most;
}

/* Widths of the columns; 0: left out. */
static void choose(const struct table_text *table, size_t screen, size_t width[COLUMNS_MOST])
{
    char same[CELL_MOST];
    size_t all = 0;
    for (size_t c = 0; c < table->column_count; c++) {
        bool hidden = table->column[c].varies && table_text_same(table, c, same);
        width[c] = hidden ? 0 : width_of(table, c);
        all += width[c] ? width[c] + 1 : 0;
    }
    while (all > screen + 1) {
        size_t worst = COLUMNS_MOST;
        for (size_t c = 0; c < table->column_count; c++)
            if (width[c] && table->column[c].rank > 0 &&
                (worst == COLUMNS_MOST || table->column[c].rank > table->column[worst].rank))
                worst = c;
        if (worst == COLUMNS_MOST)
            return;
        all -= width[worst] + 1;
        width[worst] = 0;
    }
}

/* Prints a cell, after a blank unless it is the first; blanks at the end of a line are left out. */
static size_t put_cell(const struct column *column, size_t width, const char *text, size_t at,
                       bool last)
{
    if (at > 0)
        putchar(' ');
    if (column->left && last)
        fputs(text, stdout);
    else
        printf("%*s", column->left ? -(int)width : (int)width, text);
    return at + (at > 0) + width;
}

static void print_note(const char *text, size_t room)
{
    size_t length = strcspn(text, "\n");
    if (length <= room)
        printf(" %.*s", (int)length, text);
    else
        printf(" %.*s...", (int)(room > 3 ? room - 3 : 0), text);
}

static void print_row(const struct table_text *table, const struct screen *screen,
                      const size_t width[COLUMNS_MOST], size_t last, size_t row)
{
    struct row_note note = note_of(table, row);
    size_t end = note.text ? note.from : table->column_count, at = 0;
    for (size_t c = 0; c < end; c++) {
        char cell[CELL_MOST];
        if (width[c] == 0)
            continue;
        table->cell(table->data, row, c, cell);
        if (at == 0)
            screen_paint(screen, table->paint ? table->paint(table->data, row) : PAINT_PLAIN);
        bool first = at == 0;
        at = put_cell(&table->column[c], width[c], cell, at, c == last);
        if (first)
            screen_paint(screen, PAINT_PLAIN);
    }
    if (note.text)
        print_note(note.text, screen->width > at + 1 ? screen->width - at - 1 : 0);
    putchar('\n');
}

void table_text_print(const struct table_text *table, const struct screen *screen)
{
    size_t width[COLUMNS_MOST] = {0}, at = 0, last = 0;
    choose(table, screen->width, width);
    for (size_t c = 0; c < table->column_count; c++)
        last = width[c] ? c : last;
    for (size_t c = 0; c < table->column_count; c++)
        if (width[c])
            at = put_cell(&table->column[c], width[c], table->column[c].title, at, c == last);
    putchar('\n');
    for (size_t i = 0; i < table->row_count; i++)
        print_row(table, screen, width, last, i);
}

void cell_put(char *text, const char *word)
{
    if (strlen(word) < CELL_MOST)
        strcpy(text, word);
    else
        snprintf(text, CELL_MOST, "%.*s...", (int)CELL_MOST - 4, word);
}

void table_text_print_same(const struct table_text *table, const size_t *column, size_t count,
                           const struct screen *screen)
{
    char text[(CELL_MOST + 16) * 8] = "", same[CELL_MOST];
    size_t at = 0;
    for (size_t i = 0; i < count && i < 8; i++)
        if (table_text_same(table, column[i], same) && same[0])
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s %s", at ? ", " : "",
                                   table->column[column[i]].title, same);
    if (at)
        screen_text(screen, "tests: %s\n", text);
}

/* The screen that a command prints to: its width, colours, and tables that fit it. For commands
 * only. */
#ifndef CMD_SCREEN_H
#define CMD_SCREEN_H

#include "cmd/common/cmd_rows.h"

#include <stdbool.h>
#include <stddef.h>

#define SCREEN_WIDTH 80u /* of what is no terminal, and at least of any */
#define COLUMNS_MOST 20u
#define CELL_MOST    64u /* bytes of a cell, its end included */

/* Values of the options. */
struct screen_options {
    bool wide;      /* all columns and counters, whatever the width */
    unsigned color; /* index into auto, always, never */
};

/* --wide and --color, in a struct screen_options. */
extern const struct option_row screen_rows[];

struct screen {
    unsigned width;
    bool wide, colour, terminal;
};

/* The width of a terminal, at least SCREEN_WIDTH; of what is none, SCREEN_WIDTH. `file` is a file
 * descriptor. */
unsigned screen_width(int file);

/* The standard output's width, if it is a terminal, else SCREEN_WIDTH. Colours are on with --color
 * always, or on a terminal unless --color never, NO_COLOR or TERM=dumb. */
struct screen screen_make(const struct screen_options *options);

enum paint { PAINT_PLAIN, PAINT_BAD, PAINT_GOOD, PAINT_DIM };

/* Begins and ends a colour on the standard output; prints nothing without colours. */
void screen_paint(const struct screen *screen, enum paint paint);

/* Prints a text. Unless `wide`, lines are broken between words to fit, and continue at least
 * two columns behind the indent of the first, and at column 4 or later. The text ends with a
 * newline. */
void screen_text(const struct screen *screen, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Prints a record, which other programs read by lines: as screen_text on a terminal, else as it is.
 * The first word has the colour. At most 2047 bytes. */
void screen_record(const struct screen *screen, enum paint paint, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* As screen_record without colours and whatever --wide is, for commands that have no such options:
 * lines after the first begin at column `next`. At most 4095 bytes. */
void screen_line(size_t next, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints lines as screen_text does; those that begin with `whole` are not broken. A line with a
 * title continues behind it. */
void screen_page(const struct screen *screen, const char *text, const char *whole);

/* A column of a table. */
struct column {
    const char *title;
    bool left;      /* aligned left, else right */
    bool varies;    /* left out if all cells are the same, but for "-" and "own" */
    unsigned rank;  /* if the width does not suffice, the highest ranks are left out; 0: never */
    unsigned least; /* its width at least: of times, so that two runs show the same columns */
};

#define TIME_WIDTH 7u  /* `least` of a time or a speed */
#define SPAN_WIDTH 13u /* of a ratio's least and most */

/* A row may end with a note in place of its last columns. */
struct row_note {
    size_t from;      /* the first column that the note takes the place of */
    const char *text; /* cut to the width; NULL: no note */
};

struct table_text {
    const struct column *column;
    size_t column_count; /* at most COLUMNS_MOST */
    size_t row_count;
    const void *data;
    /* Writes the cell, at most CELL_MOST bytes. */
    void (*cell)(const void *data, size_t row, size_t column, char *text);
    struct row_note (*note)(const void *data, size_t row); /* or NULL */
    enum paint (*paint)(const void *data, size_t row);     /* of the first column */
};

/* Copies a word into a cell, cut to its size. */
void cell_put(char *text, const char *word);

/* Prints "tests: TITLE CELL, ..." of those columns that are the same in all rows. */
void table_text_print_same(const struct table_text *table, const size_t *column, size_t count,
                           const struct screen *screen);

/* Prints titles and rows. */
void table_text_print(const struct table_text *table, const struct screen *screen);

/* Whether all rows without a note have the same cell, those of "-" and "own" left aside; `text` is
 * then that cell, empty if there is none. */
bool table_text_same(const struct table_text *table, size_t column, char *text);

#endif

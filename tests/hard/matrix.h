/* The matrix of hard cases: the outcome of each case on each engine, layout and triangle test, as a
 * report. */
#ifndef HARD_MATRIX_H
#define HARD_MATRIX_H

#include "tests/hard/run.h"

#include <stdio.h>

/* Outcomes of a trial, the worst last. */
enum matrix_outcome {
    OUTCOME_SKIPPED, /* an engine cannot run here */
    OUTCOME_REFUSED, /* a builder, layout or engine refuses, with a reason */
    OUTCOME_PASSED,
    OUTCOME_KNOWN,  /* shows the defect that the case demonstrates */
    OUTCOME_WAIVED, /* fails, and a waiver has the reason */
    OUTCOME_FAILED,
    OUTCOME_COUNT
};

/* "skipped", "refused", "passed", "known", "waived", "failed". */
const char *outcome_name(enum matrix_outcome outcome);
/* One line: what it means. */
const char *outcome_meaning(enum matrix_outcome outcome);

struct matrix_cell {
    size_t count[OUTCOME_COUNT];
};

/* One engine on one layout with one triangle test, repaired; or all that is as published on one
 * engine and layout; or one engine on all layouts that the hard cases meet by turns. */
struct matrix_column {
    const struct engine *engine;
    const struct layout *layout; /* NULL: no tree, or `others` */
    const struct tri_test *tri;  /* NULL: the engine's own, or several as published */
    bool published;              /* some part is as published */
    bool others;                 /* layouts outside layouts[], together */
    bool made;                   /* a member outside the tables, wrong on purpose */
    struct matrix_cell *cell;    /* cell_room: rows behind that have none */
    size_t cell_room;
};

/* An entry of the report: a failure, or everything that one waiver or one case's defect excuses. */
struct matrix_note {
    char *name; /* the reproduction; of several the first */
    char *why;  /* of a failure what is broken, of others the excuse */
    enum matrix_outcome outcome;
    size_t count; /* 1 of a failure */
};

/* Owns its arrays; zero is empty. */
struct hard_matrix {
    bool apart;                   /* layouts outside layouts[] have columns of their own */
    struct matrix_column *column; /* in order of their first result, as rows are */
    size_t column_count, column_room;
    const struct hard_case **row;
    size_t row_count, row_room;
    struct matrix_note *note;
    size_t note_count, note_room;
    size_t total[OUTCOME_COUNT];
    size_t rays;
};

/* Adds a result. `why` is one line: what is broken, or the excuse. Errors: STATUS_MEMORY. */
enum status matrix_add(struct hard_matrix *matrix, const struct hard_case *one,
                       const struct hard_member *member, enum matrix_outcome outcome, size_t rays,
                       const char *why, struct reason *reason) MUST_USE;
void matrix_free(struct hard_matrix *matrix);

/* A cell without results is all zero. */
const struct matrix_cell *matrix_at(const struct hard_matrix *matrix, size_t row, size_t column);
/* The worst of a cell's outcomes; OUTCOME_COUNT if it has none. */
enum matrix_outcome matrix_worst(const struct matrix_cell *cell);

/* The matrix is shown in tables: repaired members, those as published, those made to be wrong. */
#define MATRIX_TABLES 3
const char *matrix_table_title(size_t table);
bool matrix_in_table(const struct hard_matrix *matrix, size_t column, size_t table);
bool matrix_table_is_empty(const struct hard_matrix *matrix, size_t table);
/* "-" without a tree; "others": by turns. */
const char *matrix_layout_name(const struct matrix_column *column);
/* "own": the engine's; "all": of several. */
const char *matrix_tri_name(const struct matrix_column *column);

/* Writers. The caller checks the stream for errors. `versions` has a line for each engine. */
void matrix_text(const struct hard_matrix *matrix, FILE *out);
void matrix_markdown(const struct hard_matrix *matrix, const char *versions, FILE *out);
void matrix_html(const struct hard_matrix *matrix, const char *versions, FILE *out);

#endif

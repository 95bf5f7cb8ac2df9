/* The raydiff explain command for an answer, as other commands print it. For commands only. */
#ifndef CMD_EXPLAIN_LINE_H
#define CMD_EXPLAIN_LINE_H

#include "ref/match/match.h"

#include <stdio.h>

#define EXPLAIN_COMMAND_MOST 768

/* print_float prints "0x1.8p+1 (3)". print_floats prints a line "TITLE X Y ...", indented by
 * `indent` blanks. */
void print_float(FILE *out, float x);
void print_floats(FILE *out, int indent, const char *title, const float *x, int count);

/* What to explain, as a user names it. */
struct explain_of {
    const char *spec; /* scene */
    uint64_t seed;    /* for generators and rays */
    const struct engine *engine;
    const struct layout *layout;   /* NULL: no tree; builder, store and tree are unused */
    const struct builder *builder; /* not used if `tree` is not NULL */
    struct build_options build;
    const struct tri_store *store; /* NULL: indexed */
    const char *tree;              /* from --bvh; NULL: built */
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query;
    const char *driver; /* or NULL */
};

/* Rays as a user names them: those of a set, all of which are traced. */
struct explain_set {
    const char *rays; /* the set's name; NULL: they have none */
    size_t count;
};

/* Writes the command that explains `ray`: "raydiff explain SCENE --ray '...' ...", with floats in
 * hexadecimal and names with odd characters in quotes. At most EXPLAIN_COMMAND_MOST bytes. */
void explain_command(const struct explain_of *of, const struct ray *ray,
                     char text[EXPLAIN_COMMAND_MOST]);

/* The same of ray `index` of a set, among its other rays. */
void explain_command_among(const struct explain_of *of, const struct explain_set *set, size_t index,
                           char text[EXPLAIN_COMMAND_MOST]);

/* What to explain for a row of check or conform. */
struct explain_of explain_of_row(const struct row *row, const char *spec, uint64_t seed,
                                 const char *driver);

#endif

/* The command line that explains an answer, as other commands print it. For commands only. */
#ifndef CMD_EXPLAIN_LINE_H
#define CMD_EXPLAIN_LINE_H

#include "ref/match/match.h"

#define EXPLAIN_COMMAND_MOST 768

/* Prints "0x1.8p+1 (3)"; and a line "TITLE     X  Y  ...", so many blanks in front. */
void print_float(float x);
void print_floats(int indent, const char *title, const float *x, int count);

/* What is explained, as a user names it. */
struct explain_of {
    const char *spec; /* scene */
    uint64_t seed;    /* of generators and rays */
    const struct engine *engine;
    const struct layout *layout;   /* NULL: the engine has no tree, as are the next two */
    const struct builder *builder; /* tree_file_builder with `tree` */
    struct build_options build;
    const struct tri_store *store; /* NULL: indexed */
    const char *tree;              /* of --bvh; NULL: built */
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query;
    const char *driver; /* or NULL */
};

/* Writes the command line that explains `ray`: "raydiff explain SCENE --ray '...' ...", floats in
 * hexadecimal, a name with odd characters in quotes. At most EXPLAIN_COMMAND_MOST bytes. */
void explain_command(const struct explain_of *of, const struct ray *ray,
                     char text[EXPLAIN_COMMAND_MOST]);

/* The same for a row of check or conform. */
struct explain_of explain_of_row(const struct row *row, const char *spec, uint64_t seed,
                                 const char *driver);

#endif

/* What raydiff explain and its page share, and how others refer to it. For commands only. */
#ifndef CMD_EXPLAIN_H
#define CMD_EXPLAIN_H

#include "ref/explain/judged.h"
#include "ref/match.h"

#define EXPLAIN_COMMAND_MOST 768

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

struct explain_decode; /* ref/cmd_explain_inner.h */

/* One explained ray with everything a page needs; borrowed. */
struct explain_page {
    const struct explain_of *of;
    const struct scene *scene;
    const struct judged *judged;
    const struct judged_ray *ray;
    const char *rays; /* set it comes from, or NULL */
    size_t index, count;
    const char *again; /* command that shows the page again, NULL: raydiff explain */
    const struct explain_decode *decode; /* or NULL */
};

/* Prints the page for a person. */
void explain_print(const struct explain_page *page);

/* Writes it as JSON. Errors: STATUS_INPUT cannot write, STATUS_MEMORY. */
enum status explain_write_json(const char *path, const struct explain_page *page, int exit_code,
                               struct reason *reason) MUST_USE;

/* True if the answer is not what it should be: not allowed, or other bits than C's. */
static inline bool explain_is_wrong(const struct judged_ray *ray)
{
    return ray->why.cause != CAUSE_NONE;
}

#endif

/* raydiff explain --query all: every triangle along one ray, exactly and as the engine lists them.
 * Commands only. */
#ifndef CMD_EXPLAIN_LIST_H
#define CMD_EXPLAIN_LIST_H

#include "cmd/explain/cmd_explain_inner.h"

/* What lists are made of; all borrowed. */
struct explain_lists {
    const struct explain_options *options;
    const struct scene *scene;
    const struct oracle *oracle;
    void *self;            /* options->of.engine, opened */
    const struct job *job; /* it is prepared with it; query all */
    const struct ray *ray;
    size_t count;
};

/* Lists the hits of the ray of --ray or --index, or of the first whose list is WRONG, prints them
 * beside the exact ones, and writes options->json. Of a hit that is lost the engine is asked as the
 * nearest from just before it on. `conclusion` gets the last line's text. *code: the exit code.
 * Errors: those of all_hits_next and prepare; STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status explain_list(const struct explain_lists *lists,
                         char conclusion[EXPLAIN_CONCLUSION_MOST], int *code,
                         struct reason *reason) MUST_USE;

/* Rejects options that a list does not use. Returns -1 if there are none, else the exit code. */
int explain_list_check_use(const struct explain_options *options);

#endif

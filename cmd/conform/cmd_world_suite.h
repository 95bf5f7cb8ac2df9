/* The trials of raydiff conform --worlds. Commands only. */
#ifndef CMD_WORLD_SUITE_H
#define CMD_WORLD_SUITE_H

#include "cmd/common/cmd_tables.h"
#include "cmd/conform/cmd_world_trial.h"

/* Members that may take part, and the trials that are made of them. */
struct world_suite {
    struct list list[TABLE_COUNT]; /* named members; an empty list: see world_suite_make */
    const char *pattern;           /* NULL: all */
    struct world_trial *trial;
    size_t count, capacity;
};

/* Makes trials in which every two members of different fields of a name meet: of the engines that
 * trace worlds with a tree on the processor, then in shaders, then of those without one. If no
 * member of a table is named, those that are not as published take part, and layouts as table_all
 * has them; builders, and on the processor layouts, also below another as top. A pattern with
 * wildcards takes the trials whose name it matches, a whole name is one trial. Sorted so that
 * neighbours share the world. Errors: STATUS_INPUT an invalid name, nothing matches;
 * STATUS_MEMORY. */
enum status world_suite_make(struct world_suite *suite, struct reason *reason) MUST_USE;

/* As suite_pairs of cmd_conform_suite.h: counts the pairs in the trials, and those that met only in
 * trials that did not run; `more` (may be NULL) gets a trial for each of these with other members
 * that run with most. Errors: STATUS_MEMORY. */
enum status world_suite_pairs(const struct world_suite *suite, const bool *ran, size_t *pairs,
                              size_t *unmet, char *example, size_t example_bytes,
                              struct world_suite *more) MUST_USE;

/* Appends the trials of `more`. Errors: STATUS_MEMORY. */
enum status world_suite_append(struct world_suite *suite, bool **ran,
                               const struct world_suite *more) MUST_USE;

void world_suite_free(struct world_suite *suite);

#endif

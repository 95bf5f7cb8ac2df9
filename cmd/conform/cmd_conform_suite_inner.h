/* What cmd_conform_suite.c and cmd_conform_pairs.c share; private to them. */
#ifndef CMD_CONFORM_SUITE_INNER_H
#define CMD_CONFORM_SUITE_INNER_H

#include "cmd/conform/cmd_conform_suite.h"

/* Member indices of a trial, by table. */
struct suite_choice {
    size_t index[TABLE_COUNT];
};

struct trial suite_trial(const struct suite_choice *c);

enum status suite_add(struct suite *suite, const struct trial *trial);

/* True if storages are a table like others: some are named, by the option or in the field of the
 * layout; else all trials are of `indexed`. */
bool suite_takes_stores(const struct suite *suite);

/* The members of a table that take part; of engines those with or without a tree. */
struct list suite_members(const struct suite *suite, enum table table, bool tree);

/* Names of the trial's members, by table; NULL where it has none. */
void suite_names(const struct trial *trial, const char *name[TABLE_COUNT]);

/* The order of trials, for qsort. */
int suite_by_stage(const void *a, const void *b);

#endif

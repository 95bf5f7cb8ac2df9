/* Shared by cmd_conform_suite.c and cmd_conform_pairs.c; private to them. */
#ifndef CMD_CONFORM_SUITE_INNER_H
#define CMD_CONFORM_SUITE_INNER_H

#include "cmd/conform/cmd_conform_suite.h"

/* Member indices of a trial, by table. */
struct suite_choice {
    size_t index[TABLE_COUNT];
};

struct trial suite_trial(const struct suite_choice *c);

enum status suite_add(struct suite *suite, const struct trial *trial);

/* True if storages are a table like the others, because some are named by the option or by the
 * layout's field. Otherwise all trials use `indexed`. */
bool suite_takes_stores(const struct suite *suite);

/* The participating members of a table; for engines only those with or without a tree. */
struct list suite_members(const struct suite *suite, enum table table, bool tree);

/* Names of the trial's members, by table; NULL for tables it does not use. */
void suite_names(const struct trial *trial, const char *name[TABLE_COUNT]);

/* The order of trials, for qsort. */
int suite_by_stage(const void *a, const void *b);

#endif

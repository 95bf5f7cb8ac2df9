/* The trials of a conformance run. Commands only. */
#ifndef CMD_CONFORM_SUITE_H
#define CMD_CONFORM_SUITE_H

#include "cmd/conform/cmd_trial.h"

enum suite_kind {
    SUITE_COVERING, /* few trials in which every two members of different tables meet */
    SUITE_PRODUCT,  /* every combination of members once; scenes and ray sets take turns */
    SUITE_PATTERN,  /* everything that matches suite.pattern */
};

/* Members that may take part, in order. SUITE_COVERING counts their pairs. */
struct suite {
    enum suite_kind kind;
    const char *pattern; /* SUITE_PATTERN: matches names; without wildcards it is a name */
    struct list list[TABLE_COUNT]; /* named members; for an empty table see suite_make */
    struct trial *trial;
    size_t count, capacity;
};

/* Makes the trials, sorted so that neighbours share scene, rays and tree. If no member of a table
 * is named, all take part, except: engine brute, which the others are compared with; storages other
 * than `indexed`. With a pattern of fewer than nine fields, layouts beyond layouts[] take part only
 * if one of its fields names them. Errors: STATUS_INPUT an invalid name, nothing matches;
 * STATUS_MEMORY. */
enum status suite_make(struct suite *suite, struct reason *reason) MUST_USE;

/* Counts the pairs of members in the trials (*pairs), and those that met only in trials that did
 * not run (*unmet). ran[i] belongs to suite->trial[i]. `example` gets one unmet pair. Unless it is
 * NULL, `more` gets a trial for each unmet pair; free it. Its other members are the first of their
 * tables that take part, since these run with most, and its engine always takes part. Errors:
 * STATUS_MEMORY. */
enum status suite_pairs(const struct suite *suite, const bool *ran, size_t *pairs, size_t *unmet,
                        char *example, size_t example_bytes, struct suite *more) MUST_USE;

/* Appends the trials of `more`, and their entries to *ran, which is replaced. Errors:
 * STATUS_MEMORY. */
enum status suite_append(struct suite *suite, bool **ran, const struct suite *more) MUST_USE;

void suite_free(struct suite *suite);

#endif

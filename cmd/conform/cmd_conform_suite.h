/* Which trials a conformance run has. For commands only. */
#ifndef CMD_CONFORM_SUITE_H
#define CMD_CONFORM_SUITE_H

#include "cmd/conform/cmd_trial.h"

enum suite_kind {
    SUITE_COVERING, /* few trials such that every two members of different tables meet */
    SUITE_PRODUCT,  /* every combination of members once, scenes and ray sets by turns */
    SUITE_PATTERN,  /* everything that matches suite.pattern */
};

/* Members that may take part, in order. Pairs of them are what SUITE_COVERING counts. */
struct suite {
    enum suite_kind kind;
    const char *pattern;           /* SUITE_PATTERN: of names; one without wildcards is a name */
    struct list list[TABLE_COUNT]; /* those that were named; none of a table: see suite_make */
    struct trial *trial;
    size_t count, capacity;
};

/* Makes the trials, sorted so that neighbours share scene, rays and tree. Where no member of a
 * table is named all take part (engine brute is left to compare others with; of storages
 * `indexed`); with a pattern of fewer than nine fields only those layouts beyond layouts[] that one
 * of its fields names. Errors: STATUS_INPUT a name that is none, nothing matches; STATUS_MEMORY. */
enum status suite_make(struct suite *suite, struct reason *reason) MUST_USE;

/* Counts the pairs of members of trials, and those of them that met only in trials that did not
 * run; ran[i] is of suite->trial[i]. `example` gets two such members. For each of those pairs
 * `more`, unless it is NULL, gets a trial in which the other members are the first that take part
 * of their tables, that run with most, and no engine that does not take part; free it. Errors:
 * STATUS_MEMORY. */
enum status suite_pairs(const struct suite *suite, const bool *ran, size_t *pairs, size_t *unmet,
                        char *example, size_t example_bytes, struct suite *more) MUST_USE;

/* Appends the trials of `more`, and their entries to *ran, which is replaced. Errors:
 * STATUS_MEMORY.
 */
enum status suite_append(struct suite *suite, bool **ran, const struct suite *more) MUST_USE;

void suite_free(struct suite *suite);

#endif

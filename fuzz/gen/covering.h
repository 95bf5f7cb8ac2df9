/* Covering arrays of strength 2: few combinations of the members of several tables such that every
 * two members of different tables meet. Greedy, a row at a time, as in Cohen, Dalal, Fredman and
 * Patton 1997 (The AETG System, section 4), without its random candidates: the same tables give
 * the same rows. */
#ifndef COVERING_H
#define COVERING_H

#include "ref/base/base.h"

#define COVERING_TABLES_MOST 12u

/* Owns `member`; free with covering_free. */
struct covering {
    uint32_t tables, rows;
    uint16_t *member; /* row r takes member[r * tables + t] of table t */
};

/* Makes the rows for tables of so many members each. At least as many rows as the two largest
 * tables have pairs. Errors: STATUS_INPUT a table is empty or has more than 65,535 members, fewer
 * than 2 or more than COVERING_TABLES_MOST tables; STATUS_MEMORY. On error *out is zero. */
enum status covering_make(const uint32_t *members, uint32_t tables, struct covering *out,
                          struct reason *reason) MUST_USE;

void covering_free(struct covering *covering);

#endif

/* Lists of crossings. For the oracle's own files. */
#ifndef ORACLE_CROSSINGS_H
#define ORACLE_CROSSINGS_H

#include "ref/oracle/pair.h"

/* Appends a pair in range if its t_lo <= t_most. Errors: STATUS_MEMORY. */
enum status crossings_add(const struct decided *pair, double t_most, struct oracle_crossing **list,
                          size_t *capacity, size_t *count) MUST_USE;

/* No triangle at a greater t has t_lo <= t_most. */
double crossings_reach(const struct ray *ray, double t_most);

/* Sorts by the exact t of a hit or t_lo of an interval, then by index. */
void crossings_sort(const struct oracle *oracle, const struct ray *ray,
                    struct oracle_crossing *list, size_t count);

#endif

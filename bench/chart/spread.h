/* Median, least and most of measured values. */
#ifndef SPREAD_H
#define SPREAD_H

#include <stddef.h>

struct spread {
    double median, least, most;
};

/* Of `count` values, which are sorted in place; count >= 1. */
struct spread spread_of(double *value, size_t count);

/* The upper end of the interval that holds the median of the values' distribution with 95 %
 * confidence, whatever its shape: by ranks, n / 2 + 0.98 sqrt(n) rounded up, at most the largest;
 * infinite for fewer than 5, which may all lie below it.
 * Of `count` values, which are sorted in place; count >= 1. */
double spread_median_most(double *value, size_t count);

#endif

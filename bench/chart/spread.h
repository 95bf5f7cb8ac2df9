/* Median, least and largest of measured values. */
#ifndef SPREAD_H
#define SPREAD_H

#include <stddef.h>

struct spread {
    double median, least, most;
};

/* The spread of `count` >= 1 values, which are sorted in place. */
struct spread spread_of(double *value, size_t count);

/* The upper end of the 95 % confidence interval for the median of the values' distribution,
 * whatever its shape. By ranks: n / 2 + 0.98 sqrt(n) rounded up, at most the largest; infinite for
 * fewer than 5 values, which may all lie below it. Sorts the `count` >= 1 values in place. */
double spread_median_most(double *value, size_t count);

#endif

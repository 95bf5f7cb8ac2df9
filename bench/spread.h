/* Median, least and most of measured values. */
#ifndef SPREAD_H
#define SPREAD_H

#include <stddef.h>

struct spread {
    double median, least, most;
};

/* Of `count` values, which are sorted in place; count >= 1. */
struct spread spread_of(double *value, size_t count);

#endif

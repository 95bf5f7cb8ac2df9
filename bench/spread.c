#include "bench/spread.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct spread spread_of(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_value);
    double middle = count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
    return (struct spread){middle, value[0], value[count - 1]};
}

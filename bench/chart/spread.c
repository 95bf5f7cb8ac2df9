#include "bench/chart/spread.h"
#include "ref/base/base.h"

#include <math.h>

struct spread spread_of(double *value, size_t count)
{
    sort_doubles(value, count);
    double middle = count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
    return (struct spread){middle, value[0], value[count - 1]};
}

double spread_median_most(double *value, size_t count)
{
    double rank = ceil(0.5 * (double)count + 0.98 * sqrt((double)count));
    sort_doubles(value, count);
    if (count < 5) /* all below with 1 in 2^count */
        return INFINITY;
    return rank < (double)count ? value[(size_t)rank - 1] : value[count - 1];
}

/* Positions and texts of axis ticks. */
#ifndef TICKS_H
#define TICKS_H

#include "ref/base/base.h"

#define TICKS_MOST 32

/* Makes [*lo, *hi] a range that an axis can show: finite, within +-1e300 and of positive width. A
 * single value becomes the middle of a range; an empty range (*lo > *hi, NaN) becomes 0 to 1. */
void ticks_range(double *lo, double *hi);

/* Ticks at multiples of 1, 2 or 5 times a power of ten within [lo, hi], which ticks_range made:
 * about `wanted` (2 to TICKS_MOST / 3), at most TICKS_MOST. Returns their count; *step is their
 * distance. */
size_t ticks_linear(double lo, double hi, size_t wanted, double tick[TICKS_MOST], double *step);

/* Ticks of a logarithmic axis, 0 < lo < hi: at 1, 2 and 5 times the powers of ten, or only at
 * powers of ten over more than 2.2 decades. Returns their count. */
size_t ticks_log(double lo, double hi, double tick[TICKS_MOST]);

/* Writes "0", "0.5", "-2000", "1.5e6", with as many digits as ticks `step` apart need; step 0:
 * seven digits. */
void tick_text(double value, double step, char *text, size_t text_bytes);

#endif

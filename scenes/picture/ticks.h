/* Positions of the ticks of an axis, and their texts. */
#ifndef TICKS_H
#define TICKS_H

#include "ref/base/base.h"

#define TICKS_MOST 32

/* Makes [*lo, *hi] a range that an axis can show: finite, not beyond +-1e300, and never of zero
 * width. One value becomes the middle of a range; no range at all (*lo > *hi, NaN) becomes 0 to 1.
 */
void ticks_range(double *lo, double *hi);

/* Ticks at multiples of 1, 2 or 5 times a power of ten within [lo, hi], a range of ticks_range:
 * about `wanted` (2 to TICKS_MOST / 3), at most TICKS_MOST. Returns how many; *step is their
 * distance. */
size_t ticks_linear(double lo, double hi, size_t wanted, double tick[TICKS_MOST], double *step);

/* Ticks of a logarithmic axis, 0 < lo < hi: at 1, 2 and 5 times the powers of ten, or at the powers
 * alone where those are many. */
size_t ticks_log(double lo, double hi, double tick[TICKS_MOST]);

/* "0", "0.5", "-2000", "1.5e6": as many digits as ticks `step` apart need; 0: seven. */
void tick_text(double value, double step, char *text, size_t text_bytes);

#endif

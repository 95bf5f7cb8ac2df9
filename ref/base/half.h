/* IEEE binary16, in integer arithmetic only: the same bits on every machine, in every rounding mode
 * and with any handling of subnormals. */
#ifndef HALF_H
#define HALF_H

#include <stdint.h>

/* The largest finite half. */
#define HALF_MAX 65504.0f

struct half {
    uint16_t bits;
};

/* Round to -infinity, to +infinity, and to nearest with ties to even. Infinity and -0 are
 * unchanged; a NaN stays a NaN (quiet; sign and upper payload bits kept). Out of range: half_down
 * gives 65504 above and -infinity below, half_up the mirror image; half_nearest overflows from
 * 65520 on. */
struct half half_down(float x);
struct half half_up(float x);
struct half half_nearest(float x);

/* The largest half <= x and the smallest half >= x that can be a stored bound: neither subnormal
 * nor -0, which a GPU may flush or confuse. So 0 < |x| < 2^-14 goes outward to 0 or 2^-14 in
 * magnitude. NaN gives -infinity and +infinity, which contain everything. */
struct half half_bound_down(float x);
struct half half_bound_up(float x);

/* Exact. NaN stays NaN with its payload. */
float half_to_float(struct half h);

#endif

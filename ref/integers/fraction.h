/* Exact rationals num / den * 2^scale, compared and enclosed without rounding. */
#ifndef ORACLE_FRACTION_H
#define ORACLE_FRACTION_H

#include "ref/integers/wide.h"

#include <stdbool.h>
#include <stddef.h>

/* den is not 0, of either sign. num has at most 1671 bits, den 1394, or less in sum
 * (ref/integers/wide.h). */
struct fraction {
    struct oracle_wide num, den;
    int scale;
};

/* Sign of a - b. */
int fraction_compare(const struct fraction *a, const struct fraction *b);

/* Sign of a - x; x may be infinite, not NaN. */
int fraction_compare_double(const struct fraction *a, double x);

/* What is smaller than the one or larger than the other may be enclosed by these alone. */
#define FRACTION_LEAST 0x1p-1000
#define FRACTION_MOST  0x1p1000

/* The doubles next to a on both sides: *lo <= a <= *hi, equal if a is a double of at most 53 bits
 * that is easily seen to be one, else at most 3 neighbours apart. Of |a| from FRACTION_MOST on it
 * may be [FRACTION_MOST, INFINITY], up to FRACTION_LEAST [0, FRACTION_LEAST] if it is not 0. */
void fraction_enclose(const struct fraction *a, double *lo, double *hi);

/* Writes "num/den" in lowest terms, with "*2^k" behind it if that keeps both odd and |k| is over
 * 60. Returns false if text_bytes are not enough. */
bool fraction_text(const struct fraction *a, char *text, size_t text_bytes);

#endif

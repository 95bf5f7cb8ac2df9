/* Exact rationals num / den * 2^scale, compared and enclosed without rounding. */
#ifndef ORACLE_FRACTION_H
#define ORACLE_FRACTION_H

#include "ref/integers/wide.h"

#include <stdbool.h>
#include <stddef.h>

/* den is not 0, of either sign. num and den have at most 839 bits. */
struct fraction {
    struct oracle_wide num, den;
    int scale;
};

/* Sign of a - b. */
int fraction_compare(const struct fraction *a, const struct fraction *b);

/* Sign of a - x; x may be infinite, not NaN. */
int fraction_compare_double(const struct fraction *a, double x);

/* The doubles next to a on both sides: *lo <= a <= *hi, equal if a is a double of at most 53 bits
 * that is easily seen to be one, else at most 3 neighbours apart. |a| in [2^-1000, 2^1000] or 0. */
void fraction_enclose(const struct fraction *a, double *lo, double *hi);

/* Writes "num/den" in lowest terms, with "*2^k" behind it if that keeps both odd and |k| is over
 * 60. Returns false if text_bytes are not enough. */
bool fraction_text(const struct fraction *a, char *text, size_t text_bytes);

#endif

/* An exact t as text for people. */
#include "ref/base/decimal.h"
#include "ref/oracle/oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FRACTION_MOST 24                 /* characters of a fraction that is still readable */
#define DIGITS        100000000000000000 /* that a decimal has is below this: 17 of them */

/* A fraction "num/den" in lowest terms whose den is a power of two, as a decimal without a needless
 * 0; false if that is not exact in 17 digits, or no double is. num / 2^q is num 5^q / 10^q, and num
 * is odd unless q is 0: the decimal's digits are those of num 5^q. */
static bool as_decimal(const char *fraction, char text[ORACLE_T_TEXT])
{
    char *end;
    bool minus = *fraction == '-';
    unsigned long long num = strtoull(fraction + minus, &end, 10), digits = num;
    unsigned long long den = strtoull(end + 1, &end, 10);
    if (*end || num > 1ull << 53)
        return false;
    for (unsigned long long twos = den; twos > 1; twos /= 2)
        if (twos % 2 != 0 || (digits *= 5) > DIGITS)
            return false;
    snprintf(text, ORACLE_T_TEXT, "= %s%.17g", minus ? "-" : "", (double)num / (double)den);
    return true;
}

void oracle_t_text(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                   char text[ORACLE_T_TEXT])
{
    char fraction[FRACTION_MOST], about[DECIMAL_WITHIN_MOST];
    struct oracle_pair pair;
    bool is_short = oracle_rational(oracle, ray, prim, fraction, sizeof fraction);
    oracle_pair(oracle, ray, prim, &pair);
    decimal_within(pair.t_lo, pair.t_hi, about);
    if (!isfinite(pair.t_lo))
        snprintf(text, ORACLE_T_TEXT, "is none");
    else if (!is_short)
        snprintf(text, ORACLE_T_TEXT, "about %s", about);
    else if (!as_decimal(fraction, text))
        snprintf(text, ORACLE_T_TEXT, "= %s, about %s", fraction, about);
}

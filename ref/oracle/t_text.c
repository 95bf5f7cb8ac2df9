/* An exact t as text for people. */
#include "ref/base/decimal.h"
#include "ref/oracle/oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRACTION_MOST 24 /* characters of a fraction that is still readable */
#define DIGITS_MOST   17 /* of a decimal that is exact */

/* A fraction "num/den" whose den is a power of two, as a decimal without a needless 0; false if
 * that is not exact in DIGITS_MOST digits. */
static bool as_decimal(const char *fraction, char text[ORACLE_T_TEXT])
{
    char *end;
    unsigned long long num = strtoull(fraction + (*fraction == '-'), &end, 10);
    unsigned long long den = *end == '/' ? strtoull(end + 1, &end, 10) : 0;
    if (*end || den == 0 || (den & (den - 1)) != 0 || num >= 1ull << 53)
        return false;
    double x = (double)num / (double)den, back;
    snprintf(text, ORACLE_T_TEXT, "= %s%.*g", *fraction == '-' ? "-" : "", DIGITS_MOST, x);
    /* Seventeen digits distinguish doubles, but need not be the exact value: more digits must be
     * 0. */
    char full[1200], exact[ORACLE_T_TEXT];
    snprintf(full, sizeof full, "%.*e", 1100, x);
    snprintf(exact, sizeof exact, "%.*e", DIGITS_MOST - 1, x);
    size_t shown = strcspn(exact, "e");
    return strncmp(full, exact, shown) == 0 && full[shown + strspn(full + shown, "0")] == 'e' &&
           decimal_read_double(exact, &back) && back == x;
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

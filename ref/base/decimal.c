#define _GNU_SOURCE /* strtof_l */
#include "ref/base/decimal.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A decimal as written: digits * 10^exponent, if `exact`. Otherwise it has more digits than 64 bits
 * hold or an exponent beyond any double. */
struct decimal {
    uint64_t digits;
    int32_t exponent;
    bool negative, exact;
};

#define EXPONENT_MOST 100000

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static void add_digit(struct decimal *decimal, char c, bool after_point)
{
    if (!decimal->exact || decimal->digits > (UINT64_MAX - 9) / 10) {
        decimal->exact = false;
        return;
    }
    decimal->digits = decimal->digits * 10 + (uint64_t)(c - '0');
    decimal->exponent -= after_point;
    if (decimal->exponent < -EXPONENT_MOST)
        decimal->exact = false; /* exact stays false, so the exponent need not be counted further */
}

/* Reads the grammar of decimal.h; returns NULL if there is no number. */
static const char *scan(const char *text, struct decimal *out)
{
    *out = (struct decimal){.negative = *text == '-', .exact = true};
    const char *at = text + (*text == '-' || *text == '+');
    bool any = is_digit(*at);
    for (; is_digit(*at); at++)
        add_digit(out, *at, false);
    if (*at == '.') {
        at++;
        any = any || is_digit(*at);
        for (; is_digit(*at); at++)
            add_digit(out, *at, true);
    }
    if (!any)
        return NULL;
    if (*at != 'e' && *at != 'E')
        return at;
    const char *power = at + 1 + (at[1] == '-' || at[1] == '+');
    if (!is_digit(*power))
        return NULL;
    int32_t exponent = 0;
    for (; is_digit(*power); power++)
        exponent = exponent < EXPONENT_MOST ? exponent * 10 + (*power - '0') : exponent;
    out->exponent += at[1] == '-' ? -exponent : exponent;
    return power;
}

/* Computes the double nearest to the decimal if one multiplication or division of two exact doubles
 * gives it: both factors below 2^53 and 10^23. Returns false otherwise. */
static bool nearest_double(const struct decimal *decimal, double *out)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (!decimal->exact || decimal->digits > (UINT64_C(1) << 53))
        return false;
    double value = (double)decimal->digits;
    if (decimal->digits != 0) {
        if (decimal->exponent > 22 || decimal->exponent < -22)
            return false;
        value = decimal->exponent < 0 ? value / power[-decimal->exponent]
                                      : value * power[decimal->exponent];
    }
    *out = decimal->negative ? -value : value;
    return true;
}

/* `x` is a decimal rounded to double. True if rounding it again to float gives the float nearest to
 * the decimal: x is not halfway between two floats, and the result is not subnormal. */
static bool rounds_once(double x)
{
    union {
        double d;
        uint64_t u;
    } pun = {.d = x};
    double size = fabs(x);
    if (x == 0)
        return true;
    return size >= FLT_MIN && size < FLT_MAX && (pun.u & 0x1FFFFFFFu) != 0x10000000u;
}

const char *decimal_read_float(const char *text, float *out)
{
    *out = 0;
    struct decimal decimal;
    const char *end = scan(text, &decimal);
    if (!end)
        return NULL;
    double nearest;
    if (nearest_double(&decimal, &nearest) && rounds_once(nearest)) {
        *out = (float)nearest;
        return end;
    }
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c)
        return NULL;
    *out = strtof_l(text, NULL, c);
    freelocale(c);
    return end;
}

const char *decimal_read_double(const char *text, double *out)
{
    *out = 0;
    struct decimal decimal;
    const char *end = scan(text, &decimal);
    if (!end || nearest_double(&decimal, out))
        return end;
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c)
        return NULL;
    *out = strtod_l(text, NULL, c);
    freelocale(c);
    return end;
}

/* True if digits * 10^exponent reads as `x`. */
static bool reads_as(uint32_t digits, int exponent, float x)
{
    char text[32];
    snprintf(text, sizeof text, "%ue%d", digits, exponent);
    float back;
    return decimal_read_float(text, &back) && back == x;
}

/* Finds the `count`-digit decimal nearest to x > 0 that reads as x, if there is one. Below a power
 * of two floats are twice as dense as above it. There the nearest decimal may lie just below x and
 * read as its neighbour, while the next decimal above, farther away, still reads as x. */
static bool digits_of(float x, int count, uint32_t *digits, int *exponent)
{
    char text[32];
    snprintf(text, sizeof text, "%.*e", count - 1, (double)x);
    const char *at = text;
    *digits = 0;
    for (; *at != 'e'; at++) /* the only other byte is the locale's decimal point */
        if (is_digit(*at))
            *digits = *digits * 10 + (uint32_t)(*at - '0');
    *exponent = (int)strtol(at + 1, NULL, 10) - (count - 1);
    if (reads_as(*digits, *exponent, x))
        return true;
    (*digits)++;
    return (float_bits(x) & 0x7FFFFFu) == 0 && reads_as(*digits, *exponent, x);
}

/* Writes 0.d1d2.. * 10^whole: `whole` of the digits come before the point. */
static int place_point(const char *digits, int count, int whole, char *out, size_t size)
{
    if (whole > 13 || whole <= -6)
        return snprintf(out, size, "%c%s%se%d", digits[0], count > 1 ? "." : "", digits + 1,
                        whole - 1);
    if (whole <= 0)
        return snprintf(out, size, "0.%.*s%s", -whole, "00000", digits);
    if (whole >= count)
        return snprintf(out, size, "%s%.*s.0", digits, whole - count, "0000000000000");
    return snprintf(out, size, "%.*s.%s", whole, digits, digits + whole);
}

size_t decimal_write_float(float x, char text[DECIMAL_TEXT])
{
    size_t sign = float_bits(x) >> 31;
    if (sign)
        text[0] = '-';
    uint32_t digits = 0;
    int exponent = 0;
    if (x != 0) {
        /* If some length can represent x, every greater one can; most floats need 7. */
        float size = fabsf(x);
        int count = 7;
        bool found = digits_of(size, count, &digits, &exponent);
        while (!found && count < 9)
            found = digits_of(size, ++count, &digits, &exponent);
        uint32_t fewer;
        int scale;
        while (count > 1 && count <= 7 && digits_of(size, count - 1, &fewer, &scale)) {
            digits = fewer;
            exponent = scale;
            count--;
        }
    }
    char plain[16];
    int count = snprintf(plain, sizeof plain, "%u", digits);
    return sign +
           (size_t)place_point(plain, count, count + exponent, text + sign, DECIMAL_TEXT - sign);
}

void decimal_within(double lo, double hi, char text[DECIMAL_WITHIN_MOST])
{
    bool interval = isfinite(lo) && isfinite(hi) && lo <= hi;
    for (int digits = interval ? 1 : 17; digits <= 17; digits++) {
        double x;
        snprintf(text, DECIMAL_WITHIN_MOST, "%.*g", digits, interval ? lo + 0.5 * (hi - lo) : lo);
        if (digits < 17 && decimal_read_double(text, &x) && x >= lo && x <= hi)
            return;
    }
}

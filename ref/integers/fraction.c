#include "ref/integers/fraction.h"

#include "ref/integers/oracle_grid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int sign_of(const struct fraction *a)
{
    return a->num.sign * a->den.sign;
}

/* Sign of |a| * 2^shift - |b|, of two numbers that are not 0; of two zeros, any sign. The sizes are
 * compared first, so that no shift can overflow: when it is done, the shifted number is as long as
 * the other. */
static int compare_shifted(struct oracle_wide *a, struct oracle_wide *b, int shift)
{
    int a_bits = (int)wide_bits(a) + shift, b_bits = (int)wide_bits(b);
    if (a_bits != b_bits)
        return a_bits > b_bits ? 1 : -1;
    if (shift > 0)
        wide_shift_left(a, (unsigned)shift);
    else
        wide_shift_left(b, (unsigned)-shift);
    return wide_compare_size(a, b);
}

int fraction_compare(const struct fraction *a, const struct fraction *b)
{
    int sign = sign_of(a);
    if (sign != sign_of(b))
        return sign > sign_of(b) ? 1 : -1;
    struct oracle_wide left, right;
    wide_mul(&a->num, &b->den, &left);
    wide_mul(&b->num, &a->den, &right);
    return sign * compare_shifted(&left, &right, a->scale - b->scale);
}

int fraction_compare_double(const struct fraction *a, double x)
{
    int sign = sign_of(a), x_sign = (x > 0) - (x < 0);
    if (isinf(x))
        return -x_sign;
    if (sign != x_sign)
        return sign > x_sign ? 1 : -1;
    int exponent;
    double mantissa = frexp(fabs(x), &exponent); /* in [1/2, 1) */
    struct oracle_wide left = a->num, right, whole;
    wide_set((__int128)ldexp(mantissa, 53), &whole);
    wide_mul(&whole, &a->den, &right);
    return sign * compare_shifted(&left, &right, a->scale - (exponent - 53));
}

/* The next double above a positive one, or below (by -1). */
static double neighbour(double x, int by)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits += (uint64_t)(int64_t)by;
    memcpy(&x, &bits, sizeof x);
    return x;
}

void fraction_enclose(const struct fraction *a, double *lo, double *hi)
{
    *lo = *hi = 0;
    if (a->num.sign == 0)
        return;
    uint64_t n, d;
    int n_exponent, d_exponent;
    bool n_whole = wide_top(&a->num, &n, &n_exponent), d_whole = wide_top(&a->den, &d, &d_exponent);
    /* n and d are in [2^63, 2^64): both quotients are in (2^61, 2^64). */
    unsigned __int128 n_wide = (unsigned __int128)n << 62;
    unsigned __int128 below = n_wide / ((unsigned __int128)d + !d_whole);
    unsigned __int128 above = (n_wide + ((unsigned __int128)!n_whole << 62)) / d;
    bool exact = n_whole && d_whole && n_wide % d == 0 && (below & 0x1FFF) == 0; /* 51 bits left */
    int exponent = n_exponent - d_exponent - 62 + a->scale;
    double small = times_power((double)(uint64_t)below, exponent), large = small;
    if (exponent + 61 >= 1000) { /* |a| is in 2^exponent times (2^61, 2^64) */
        small = FRACTION_MOST;
        large = INFINITY;
    } else if (exponent + 64 <= -1000) {
        small = 0;
        large = FRACTION_LEAST;
    } else if (!exact) { /* (double) rounds either way */
        small = neighbour(small, -1);
        large = neighbour(times_power((double)(above + 1), exponent), 1);
    }
    *lo = sign_of(a) > 0 ? small : -large;
    *hi = sign_of(a) > 0 ? large : -small;
}

/* Greatest common divisor of two odd positive numbers, by Stein's method; destroys both. */
static void greatest_common(struct oracle_wide *a, struct oracle_wide *b)
{
    int order;
    while ((order = wide_compare_size(a, b)) != 0) {
        struct oracle_wide *larger = order > 0 ? a : b, *smaller = order > 0 ? b : a;
        wide_sub(larger, smaller, larger);
        wide_shift_right(larger, wide_trailing(larger));
    }
}

/* a / by, exactly, both odd and positive: by long division in binary. */
static void divide_exact(struct oracle_wide *a, const struct oracle_wide *by)
{
    struct oracle_wide quotient, one;
    wide_set(0, &quotient);
    while (a->sign != 0) {
        unsigned shift = wide_bits(a) - wide_bits(by);
        struct oracle_wide part = *by;
        wide_shift_left(&part, shift);
        if (wide_compare_size(&part, a) > 0) {
            part = *by;
            wide_shift_left(&part, --shift);
        }
        wide_sub(a, &part, a);
        wide_set(1, &one);
        wide_shift_left(&one, shift);
        wide_add(&quotient, &one, &quotient);
    }
    *a = quotient;
}

/* Appends |a| in decimal; false if it does not fit. */
static bool append(const struct oracle_wide *a, char *text, size_t text_bytes)
{
    char digits[20 * WIDE_LIMBS + 1];
    size_t at = sizeof digits - 1, used = strlen(text);
    struct oracle_wide rest = *a;
    digits[at] = 0;
    do
        digits[--at] = (char)('0' + wide_divide_small(&rest, 10));
    while (rest.sign != 0);
    size_t length = sizeof digits - 1 - at;
    if (used + length + 1 > text_bytes)
        return false;
    memcpy(text + used, digits + at, length + 1);
    return true;
}

bool fraction_text(const struct fraction *a, char *text, size_t text_bytes)
{
    struct fraction f = *a;
    int power = 0;
    char tail[16] = "";
    if (text_bytes < 2)
        return false;
    text[0] = 0;
    if (f.num.sign == 0) {
        wide_set(1, &f.den);
    } else {
        unsigned n_zeros = wide_trailing(&f.num), d_zeros = wide_trailing(&f.den);
        wide_shift_right(&f.num, n_zeros);
        wide_shift_right(&f.den, d_zeros);
        power = f.scale + (int)n_zeros - (int)d_zeros;
        f.num.sign = f.den.sign = 1;
        struct oracle_wide x = f.num, y = f.den;
        greatest_common(&x, &y);
        struct oracle_wide common = x;
        divide_exact(&f.num, &common);
        divide_exact(&f.den, &common);
        if (power > 60 || power < -60)
            snprintf(tail, sizeof tail, "*2^%d", power);
        else
            wide_shift_left(power > 0 ? &f.num : &f.den, (unsigned)(power > 0 ? power : -power));
    }
    if (sign_of(a) < 0)
        strcpy(text, "-");
    if (!append(&f.num, text, text_bytes) || strlen(text) + 2 > text_bytes)
        return false;
    strcat(text, "/");
    if (!append(&f.den, text, text_bytes) || strlen(text) + strlen(tail) + 1 > text_bytes)
        return false;
    strcat(text, tail);
    return true;
}

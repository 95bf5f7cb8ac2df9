#include "ref/base/float_word.h"

#include "ref/base/decimal.h"

#include <stdio.h>
#include <string.h>

#define SIGN     0x80000000u
#define INFINITE 0x7F800000u
#define FRACTION 0x007FFFFFu

size_t float_word_write(float x, char text[FLOAT_WORD_MOST])
{
    uint32_t bits = float_bits(x), fraction = bits & FRACTION;
    int exponent = (int)(bits >> 23 & 0xFF) - 127;
    const char *sign = bits & SIGN ? "-" : "";
    if (exponent == 128 && fraction)
        return (size_t)snprintf(text, FLOAT_WORD_MOST, "nan:0x%08x", bits);
    if (exponent == 128)
        return (size_t)snprintf(text, FLOAT_WORD_MOST, "%sinf", sign);
    if (exponent == -127 && fraction == 0)
        return (size_t)snprintf(text, FLOAT_WORD_MOST, "%s0x0p+0", sign);
    if (exponent == -127) /* subnormal: shifted until its leading bit is the hidden one */
        for (exponent = -126; !(fraction & (FRACTION + 1)); exponent--)
            fraction <<= 1;
    fraction = (fraction & FRACTION) << 1; /* 24 bits: six digits */
    char digits[8];
    snprintf(digits, sizeof digits, "%06x", fraction);
    size_t kept = 6;
    while (kept > 0 && digits[kept - 1] == '0')
        kept--;
    return (size_t)snprintf(text, FLOAT_WORD_MOST, "%s0x1%s%.*sp%+d", sign, kept ? "." : "",
                            (int)kept, digits, exponent);
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Sets *out to digits * 2^exponent if that is a float32. */
static bool exact_float(uint64_t digits, int exponent, uint32_t sign, float *out)
{
    if (digits == 0) {
        *out = float_from_bits(sign);
        return true;
    }
    for (; !(digits & 1); exponent++)
        digits >>= 1;
    if (digits > 2 * (uint64_t)FRACTION + 1 || exponent < -149)
        return false;
    int top = exponent; /* exponent of the leading bit */
    for (uint64_t rest = digits; rest > 1; rest >>= 1)
        top++;
    if (top > 127)
        return false;
    uint32_t bits;
    if (top < -126)
        bits = (uint32_t)digits << (exponent + 149);
    else
        bits = (uint32_t)(top + 127) << 23 | ((uint32_t)digits << (23 - top + exponent) & FRACTION);
    *out = float_from_bits(bits | sign);
    return true;
}

/* Reads the part after "0x". */
static const char *read_hexadecimal(const char *at, uint32_t sign, float *out, const char **rule)
{
    uint64_t digits = 0;
    int exponent = 0, count = 0, written = 0;
    bool point = false, negative;
    *rule = "not a hexadecimal number of up to 15 digits and an exponent, like 0x1.8p+1";
    for (; hex_digit(*at) >= 0 || (*at == '.' && !point); at++) {
        if (*at == '.') {
            point = true;
            continue;
        }
        digits = digits << 4 | (uint64_t)hex_digit(*at);
        exponent -= point ? 4 : 0;
        if (++count > 15)
            return NULL;
    }
    if (count == 0 || (*at != 'p' && *at != 'P'))
        return NULL;
    at++;
    negative = *at == '-';
    at += *at == '-' || *at == '+';
    for (count = 0; *at >= '0' && *at <= '9'; at++, count++) {
        if (count == 4)
            return NULL;
        written = 10 * written + (*at - '0');
    }
    if (count == 0)
        return NULL;
    *rule = "not exactly a 32-bit float";
    return exact_float(digits, exponent + (negative ? -written : written), sign, out) ? at : NULL;
}

/* Reads the part after "nan:0x": exactly eight digits, the bits of a NaN. */
static const char *read_nan(const char *at, float *out, const char **rule)
{
    uint32_t bits = 0;
    *rule = "not the eight hexadecimal digits of a NaN, like nan:0x7fc00000";
    for (int i = 0; i < 8; i++, at++) {
        if (hex_digit(*at) < 0)
            return NULL;
        bits = bits << 4 | (uint32_t)hex_digit(*at);
    }
    if ((bits & INFINITE) != INFINITE || !(bits & FRACTION))
        return NULL;
    *out = float_from_bits(bits);
    return at;
}

const char *float_word_read(const char *text, float *out, const char **rule)
{
    const char *at = text + (*text == '-' || *text == '+');
    uint32_t sign = *text == '-' ? SIGN : 0;
    *out = 0;
    if (strncmp(text, "nan:0x", 6) == 0)
        return read_nan(text + 6, out, rule);
    if (strncmp(at, "inf", 3) == 0) {
        *out = float_from_bits(INFINITE | sign);
        return at + 3;
    }
    if (at[0] == '0' && (at[1] == 'x' || at[1] == 'X'))
        return read_hexadecimal(at + 2, sign, out, rule);
    *rule = "not a number";
    const char *end = decimal_read_float(text, out);
    if (!end || float_is_finite(*out))
        return end;
    *rule = "beyond the range of a 32-bit float";
    return NULL;
}

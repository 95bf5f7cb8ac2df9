#include "ref/integers/wide.h"
#include "ref/base/invariant.h"

#include <stdbool.h>

/* Drops leading zero limbs; no limb left means zero. */
static void trim(struct oracle_wide *a, int sign, int count)
{
    while (count > 0 && a->limb[count - 1] == 0)
        count--;
    a->count = count;
    a->sign = count ? sign : 0;
}

void wide_set(__int128 value, struct oracle_wide *out)
{
    unsigned __int128 size = value < 0 ? -(unsigned __int128)value : (unsigned __int128)value;
    out->limb[0] = (uint64_t)size;
    out->limb[1] = (uint64_t)(size >> 64);
    trim(out, value < 0 ? -1 : 1, 2);
}

int wide_compare_size(const struct oracle_wide *a, const struct oracle_wide *b)
{
    if (a->count != b->count)
        return a->count > b->count ? 1 : -1;
    for (int i = a->count - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] > b->limb[i] ? 1 : -1;
    return 0;
}

static void add_sizes(const struct oracle_wide *a, const struct oracle_wide *b, int sign,
                      struct oracle_wide *out)
{
    if (a->count < b->count) {
        const struct oracle_wide *swap = a;
        a = b;
        b = swap;
    }
    uint64_t carry = 0;
    int count = a->count;
    for (int i = 0; i < count; i++) {
        unsigned __int128 sum =
            (unsigned __int128)a->limb[i] + (i < b->count ? b->limb[i] : 0) + carry;
        out->limb[i] = (uint64_t)sum;
        carry = (uint64_t)(sum >> 64);
    }
    if (carry) {
        invariant(count < WIDE_LIMBS);
        out->limb[count++] = carry;
    }
    trim(out, sign, count);
}

/* |a| >= |b| */
static void sub_sizes(const struct oracle_wide *a, const struct oracle_wide *b, int sign,
                      struct oracle_wide *out)
{
    uint64_t borrow = 0;
    int count = a->count;
    for (int i = 0; i < count; i++) {
        unsigned __int128 less = (unsigned __int128)(i < b->count ? b->limb[i] : 0) + borrow;
        borrow = a->limb[i] < less;
        out->limb[i] = (uint64_t)(a->limb[i] - less);
    }
    trim(out, sign, count);
}

static void add_signed(const struct oracle_wide *a, const struct oracle_wide *b, int b_sign,
                       struct oracle_wide *out)
{
    if (a->sign == b_sign || a->sign == 0 || b_sign == 0)
        add_sizes(a, b, a->sign ? a->sign : b_sign, out);
    else if (wide_compare_size(a, b) >= 0)
        sub_sizes(a, b, a->sign, out);
    else
        sub_sizes(b, a, b_sign, out);
}

void wide_add(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out)
{
    add_signed(a, b, b->sign, out);
}

void wide_sub(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out)
{
    add_signed(a, b, -b->sign, out);
}

void wide_mul(const struct oracle_wide *a, const struct oracle_wide *b, struct oracle_wide *out)
{
    int count = a->count + b->count;
    invariant(out != a && out != b);
    /* The operands are bounded so that the product fits, its leading zero limb included. */
    invariant(count <= WIDE_LIMBS);
    for (int i = 0; i < count; i++)
        out->limb[i] = 0;
    for (int i = 0; i < a->count; i++) {
        uint64_t carry = 0;
        for (int j = 0; j < b->count; j++) {
            unsigned __int128 sum =
                (unsigned __int128)a->limb[i] * b->limb[j] + out->limb[i + j] + carry;
            out->limb[i + j] = (uint64_t)sum;
            carry = (uint64_t)(sum >> 64);
        }
        if (b->count)
            out->limb[i + b->count] = carry;
    }
    trim(out, a->sign * b->sign, count);
}

void wide_shift_left(struct oracle_wide *a, unsigned bits)
{
    int limbs = (int)(bits / 64);
    unsigned rest = bits % 64;
    if (a->sign == 0 || bits == 0)
        return;
    invariant(wide_bits(a) + bits <= 64u * WIDE_LIMBS);
    int count = a->count + limbs;
    uint64_t over = rest ? a->limb[a->count - 1] >> (64 - rest) : 0;
    for (int i = count - 1; i >= limbs; i--) {
        uint64_t low = i > limbs && rest ? a->limb[i - limbs - 1] >> (64 - rest) : 0;
        a->limb[i] = a->limb[i - limbs] << rest | low;
    }
    for (int i = 0; i < limbs; i++)
        a->limb[i] = 0;
    if (over)
        a->limb[count++] = over;
    a->count = count;
}

void wide_shift_right(struct oracle_wide *a, unsigned bits)
{
    int limbs = (int)(bits / 64);
    unsigned rest = bits % 64;
    int count = a->count - limbs;
    for (int i = 0; i < count; i++) {
        uint64_t high = rest && i + 1 < count ? a->limb[i + limbs + 1] << (64 - rest) : 0;
        a->limb[i] = a->limb[i + limbs] >> rest | high;
    }
    trim(a, a->sign, count > 0 ? count : 0);
}

unsigned wide_bits(const struct oracle_wide *a)
{
    return a->count ? 64u * (unsigned)a->count - (unsigned)__builtin_clzll(a->limb[a->count - 1])
                    : 0;
}

unsigned wide_trailing(const struct oracle_wide *a)
{
    for (int i = 0; i < a->count; i++)
        if (a->limb[i])
            return 64u * (unsigned)i + (unsigned)__builtin_ctzll(a->limb[i]);
    return 0;
}

int wide_top(const struct oracle_wide *a, uint64_t *top, int *exponent)
{
    int at = a->count - 1, zeros = __builtin_clzll(a->limb[at]);
    uint64_t below = at > 0 ? a->limb[at - 1] : 0;
    *top = zeros ? a->limb[at] << zeros | below >> (64 - zeros) : a->limb[at];
    *exponent = 64 * at - zeros;
    bool whole = (zeros ? below << zeros : below) == 0;
    for (int i = 0; whole && i < at - 1; i++)
        whole = a->limb[i] == 0;
    return whole;
}

uint64_t wide_divide_small(struct oracle_wide *a, uint64_t by)
{
    unsigned __int128 rest = 0;
    for (int i = a->count - 1; i >= 0; i--) {
        rest = rest << 64 | a->limb[i];
        a->limb[i] = (uint64_t)(rest / by);
        rest %= by;
    }
    trim(a, a->sign, a->count);
    return (uint64_t)rest;
}

#include "ref/oracle/medium.h"

typedef unsigned __int128 u128;

/* A product of two __int128. */
struct medium_pair {
    uint64_t limb[4];
};

static inline uint64_t high(u128 x)
{
    return (uint64_t)(x >> 64);
}

/* The product of the bits as if they had no sign is too large by 2^128 times one factor where the
 * other is negative. */
static inline struct medium_pair multiply(__int128 x, __int128 y)
{
    uint64_t x0 = (uint64_t)x, x1 = high((u128)x), y0 = (uint64_t)y, y1 = high((u128)y);
    u128 low = (u128)x0 * y0, one = (u128)x0 * y1, two = (u128)x1 * y0, top = (u128)x1 * y1;
    u128 middle = one + high(low), rest = two + (uint64_t)middle;
    top += high(middle);
    top += high(rest);
    top -= x < 0 ? (u128)y : 0;
    top -= y < 0 ? (u128)x : 0;
    return (struct medium_pair){{(uint64_t)low, (uint64_t)rest, (uint64_t)top, high(top)}};
}

/* a -= b */
static inline void pair_subtract(struct medium_pair *a, const struct medium_pair *b)
{
    uint64_t borrow = 0;
    for (int i = 0; i < 4; i++) {
        u128 less = (u128)b->limb[i] + borrow;
        borrow = a->limb[i] < less;
        a->limb[i] -= (uint64_t)less;
    }
}

static inline void add(struct medium *sum, const struct medium *x)
{
    uint64_t carry = 0;
    for (int i = 0; i < MEDIUM_LIMBS; i++) {
        u128 limb = (u128)sum->limb[i] + x->limb[i] + carry;
        sum->limb[i] = (uint64_t)limb;
        carry = high(limb);
    }
}

static inline struct medium negative(const struct medium *a)
{
    struct medium out;
    uint64_t carry = 1;
    for (int i = 0; i < MEDIUM_LIMBS; i++) {
        out.limb[i] = ~a->limb[i] + carry;
        carry = carry && out.limb[i] == 0;
    }
    return out;
}

/* sum += x * y, all modulo 2^320. */
static inline void add_product(struct medium *sum, __int128 x, const struct medium_pair *y)
{
    u128 size = x < 0 ? -(u128)x : (u128)x;
    const uint64_t factor[2] = {(uint64_t)size, high(size)};
    const uint64_t wide[MEDIUM_LIMBS] = {y->limb[0], y->limb[1], y->limb[2], y->limb[3],
                                         y->limb[3] >> 63 ? ~(uint64_t)0 : 0};
    struct medium product = {{0}};
    for (int f = 0; f < 2; f++) {
        uint64_t carry = 0;
        for (int i = 0; f + i < MEDIUM_LIMBS; i++) {
            u128 limb = (u128)factor[f] * wide[i] + product.limb[f + i] + carry;
            product.limb[f + i] = (uint64_t)limb;
            carry = high(limb);
        }
        if (factor[1] == 0)
            break;
    }
    if (x < 0)
        product = negative(&product);
    add(sum, &product);
}

static struct medium dot(const __int128 x[3], const struct medium_pair y[3])
{
    struct medium sum = {{0}};
    for (int k = 0; k < 3; k++)
        add_product(&sum, x[k], &y[k]);
    return sum;
}

/* As small_multiply: |D| <= 18 * 2^(b_d + 2 b_p), |T| <= 6 * 2^(3 b_p), below 2^319; and minors
 * below 2^255. */
bool medium_multiply(const struct medium_input *in, struct medium_products *out)
{
    if (in->way_bits + 2 * in->place_bits > 314 || 3 * in->place_bits > 314)
        return false;
    struct medium_pair n[3];
    for (int turn = 0; turn < 3; turn++) {
        int c = (turn + 1) % 3; /* 0 last: T has its n */
        const __int128 *x = in->a[(c + 1) % 3], *y = in->a[(c + 2) % 3];
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            struct medium_pair right = multiply(x[j], y[i]);
            n[k] = multiply(x[i], y[j]);
            pair_subtract(&n[k], &right);
        }
        out->w[c] = dot(in->d, n);
    }
    out->det = out->w[0];
    add(&out->det, &out->w[1]);
    add(&out->det, &out->w[2]);
    out->t = dot(in->a[0], n);
    return true;
}

int medium_sign(const struct medium *a)
{
    uint64_t any = 0;
    for (int i = 0; i < MEDIUM_LIMBS; i++)
        any |= a->limb[i];
    return a->limb[MEDIUM_LIMBS - 1] >> 63 ? -1 : any != 0;
}

void medium_wide(const struct medium *a, struct oracle_wide *out)
{
    int sign = medium_sign(a), count = MEDIUM_LIMBS;
    struct medium size = sign < 0 ? negative(a) : *a;
    while (count > 0 && size.limb[count - 1] == 0)
        count--;
    for (int i = 0; i < count; i++)
        out->limb[i] = size.limb[i];
    out->sign = sign;
    out->count = count;
}

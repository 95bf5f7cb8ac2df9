#include "ref/world/object_ray.h"

#include "ref/integers/fraction.h"
#include "ref/integers/oracle_grid.h"

#include <math.h>

/* Largest number of bits of a float32's significand, and the power of two of its lowest bit. */
#define SIGNIFICAND 24
#define LOWEST      (-149)

/* The nine numbers as integers on their grid, and what stays below the bars of the inverse. */
struct inverse_parts {
    struct oracle_wide x[3][3];
    struct oracle_wide det; /* in units of the grid's cube */
    int exponent;           /* of the grid */
};

/* a b - c d */
static void two_products(const struct oracle_wide *a, const struct oracle_wide *b,
                         const struct oracle_wide *c, const struct oracle_wide *d,
                         struct oracle_wide *out)
{
    struct oracle_wide left, right;
    wide_mul(a, b, &left);
    wide_mul(c, d, &right);
    wide_sub(&left, &right, out);
}

/* Element i, j of the adjugate: the cofactor of element j, i. Indices modulo 3 have its sign. */
static void adjugate(const struct inverse_parts *m, int i, int j, struct oracle_wide *out)
{
    int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
    two_products(&m->x[r][c], &m->x[s][d], &m->x[r][d], &m->x[s][c], out);
}

static void matrix_of(const float m[3][4], struct inverse_parts *out)
{
    struct odd odd[9];
    struct oracle_wide cofactor, product, sum;
    for (int i = 0; i < 9; i++)
        odd[i] = odd_of(m[i / 3][i % 3]);
    struct oracle_grid grid = grid_of(odd, 9);
    out->exponent = grid.exponent;
    for (int i = 0; i < 9; i++)
        grid_wide(grid, odd[i], &out->x[i / 3][i % 3]);
    wide_set(0, &sum);
    for (int j = 0; j < 3; j++) {
        adjugate(out, j, 0, &cofactor);
        wide_mul(&out->x[0][j], &cofactor, &product);
        wide_add(&sum, &product, &sum);
    }
    wide_copy(&sum, &out->det);
}

/* |num / den| * 2^shift rounded down to an integer below 2^SIGNIFICAND, by long division in binary;
 * *half is 0 if the rest is below one half, 1 if it is one half, 2 above. */
static uint32_t divide(const struct oracle_wide *num, const struct oracle_wide *den, int shift,
                       int *half)
{
    struct oracle_wide rest, by, part;
    uint32_t quotient = 0;
    wide_copy(num, &rest);
    wide_copy(den, &by);
    rest.sign = rest.sign ? 1 : 0;
    by.sign = 1;
    /* One bit more than the quotient has: the half. */
    if (shift >= 0)
        wide_shift_left(&rest, (unsigned)shift + 1);
    else
        wide_shift_left(&by, (unsigned)-shift - 1);
    for (int bit = SIGNIFICAND; bit >= 0; bit--) {
        wide_copy(&by, &part);
        wide_shift_left(&part, (unsigned)bit);
        if (wide_compare_size(&rest, &part) >= 0) {
            wide_sub(&rest, &part, &rest);
            quotient |= 1u << bit;
        }
    }
    *half = (quotient & 1) ? 1 + (rest.sign != 0) : 0;
    return quotient >> 1;
}

/* The fraction rounded to float32; infinite if it is beyond. */
static float round_once(const struct fraction *a)
{
    struct oracle_wide left, right;
    int sign = a->num.sign * a->den.sign, half;
    if (sign == 0)
        return 0.0f;
    /* 2^exponent <= |a| < 2^(exponent + 1): the quotient of two numbers of so many bits begins with
     * that bit or the one below. */
    int bits = (int)wide_bits(&a->num) - (int)wide_bits(&a->den);
    wide_copy(&a->num, &left);
    wide_copy(&a->den, &right);
    if (bits > 0)
        wide_shift_left(&right, (unsigned)bits);
    else
        wide_shift_left(&left, (unsigned)-bits);
    int exponent = bits - (wide_compare_size(&left, &right) < 0) + a->scale;
    if (exponent < LOWEST - 1)
        return sign < 0 ? -0.0f : 0.0f;
    if (exponent > 127)
        return sign < 0 ? -INFINITY : INFINITY;
    int lowest = exponent - (SIGNIFICAND - 1);
    lowest = lowest < LOWEST ? LOWEST : lowest;
    uint32_t whole = divide(&a->num, &a->den, a->scale - lowest, &half);
    whole += half == 2 || (half == 1 && (whole & 1));
    return (float)ldexp(sign * (double)whole, lowest);
}

enum status transform_inverse(const float m[3][4], float w[9], struct reason *reason)
{
    struct inverse_parts matrix;
    matrix_of(m, &matrix);
    for (int i = 0; i < 9; i++) {
        struct fraction element = {.scale = -matrix.exponent};
        adjugate(&matrix, i / 3, i % 3, &element.num);
        wide_copy(&matrix.det, &element.den);
        w[i] = round_once(&element);
        if (!float_is_finite(w[i])) {
            for (int k = 0; k < 9; k++)
                w[k] = 0;
            return fail(reason, STATUS_LIMIT,
                        "row %d, column %d of the transform's inverse is beyond float32", i / 3,
                        i % 3);
        }
    }
    return STATUS_OK;
}

/* The exact inverse of a transform, from integers. */
#include "ref/twin/twin_placed.h"

#include "ref/integers/fraction.h"
#include "ref/integers/oracle_grid.h"

#include <float.h>
#include <math.h>
#include <string.h>

#ifndef PLACED_TURNED /* a test turns them */
/* Rounding to nearest is off by at most u of the number, or half of the least float32. */
#define INVERSE_SHARE 0x1p-24
#define INVERSE_LEAST 0x1p-150
#endif
/* Of what is computed in double below. */
#define OUTWARD (1.0 + 0x1p-40)

/* The nine numbers of M on a common grid. */
struct whole_matrix {
    struct oracle_wide cell[3][3];
    int exponent;
};

static void load(const float m[3][4], struct whole_matrix *out)
{
    struct odd odd[9];
    for (int i = 0; i < 9; i++)
        odd[i] = odd_of(m[i / 3][i % 3]);
    struct oracle_grid grid = grid_of(odd, 9);
    for (int i = 0; i < 9; i++)
        grid_wide(grid, odd[i], &out->cell[i / 3][i % 3]);
    out->exponent = grid.exponent;
}

/* The minor of row i and column j with its sign. */
static void cofactor(const struct whole_matrix *m, int i, int j, struct oracle_wide *out)
{
    int r = (i + 1) % 3, s = (i + 2) % 3, k = (j + 1) % 3, l = (j + 2) % 3;
    struct oracle_wide plus, minus;
    wide_mul(&m->cell[r][k], &m->cell[s][l], &plus);
    wide_mul(&m->cell[r][l], &m->cell[s][k], &minus);
    wide_sub(&plus, &minus, out);
}

static void determinant(const struct whole_matrix *m, struct oracle_wide *out)
{
    wide_set(0, out);
    for (int j = 0; j < 3; j++) {
        struct oracle_wide minor, term;
        cofactor(m, 0, j, &minor);
        wide_mul(&m->cell[0][j], &minor, &term);
        wide_add(out, &term, out);
    }
}

/* The largest double that is at most `a`, which is positive: within 2^-52 of it. */
static double below(const struct fraction *a)
{
    double lo, hi;
    fraction_enclose(a, &lo, &hi);
    while (hi > lo && fraction_compare_double(a, hi) < 0)
        hi = nextafter(hi, 0.0);
    return hi;
}

/* The float32 nearest to `a`, which is positive, ties to even; `near` is a double beside it. */
static float nearest(const struct fraction *a, double near)
{
    float f = near > (double)FLT_MAX ? FLT_MAX : (float)near;
    float next[2] = {f == 0.0f ? f : nextafterf(f, 0.0f), nextafterf(f, INFINITY)};
    for (int i = 0; i < 2; i++) {
        double end = isinf(next[i]) ? 0x1p128 : (double)next[i];
        double middle = ((double)f + end) / 2.0; /* exact */
        int side = fraction_compare_double(a, middle);
        uint32_t bits;
        memcpy(&bits, &f, sizeof bits);
        if (end != (double)f && (side == (i ? 1 : -1) || (side == 0 && (bits & 1u))))
            return next[i];
    }
    return f;
}

static enum status invert(const float m[3][4], struct twin_place *out, struct reason *reason)
{
    struct whole_matrix matrix;
    struct oracle_wide det;
    load(m, &matrix);
    determinant(&matrix, &det);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            struct fraction a = {.den = det, .scale = -matrix.exponent};
            int at = 3 * i + j;
            cofactor(&matrix, j, i, &a.num);
            int sign = a.num.sign * a.den.sign;
            if (sign == 0)
                continue; /* all zeros */
            a.num.sign = a.den.sign = 1;
            double near = below(&a);
            float w = nearest(&a, near);
            if (isinf(w))
                return fail(reason, STATUS_LIMIT,
                            "row %d, column %d of the inverse is beyond float32", i, j);
            bool exact = fraction_compare_double(&a, (double)w) == 0;
            out->w[at] = sign > 0 ? w : -w;
            out->near[at] = sign > 0 ? near : -near;
            out->off[at] = exact ? 0.0 : fmax(INVERSE_SHARE * near * OUTWARD, INVERSE_LEAST);
        }
    return STATUS_OK;
}

static double kappa_of(const float m[3][4], const double inverse[9])
{
    double most = 0.0;
    for (int i = 0; i < 3; i++) {
        double sum = 0.0;
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                sum += fabs((double)m[i][k] * inverse[3 * k + j]);
        most = fmax(most, sum);
    }
    return most;
}

enum status twin_place_of(const struct instance *instance, struct twin_place *out,
                          struct reason *reason)
{
    *out = (struct twin_place){.identity = instance_is_identity(instance)};
    for (int k = 0; k < 3; k++)
        out->t[k] = instance->m[k][3];
    enum status status = invert(instance->m, out, reason);
    if (status)
        *out = (struct twin_place){0};
    else
        out->kappa = kappa_of(instance->m, out->near);
    return status;
}

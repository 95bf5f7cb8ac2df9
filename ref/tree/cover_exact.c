#include "ref/tree/cover_exact.h"

#include "ref/base/base.h"
#include "ref/integers/wide.h"

#include <math.h>

/* With e = 2^-53: differences of floats, products and sums of them have a relative error of at most
 * e each and neither over- nor underflow in double (floats are multiples of 2^-149 below 2^128). A
 * term of a 2x2 determinant has 2 + 1 + 1 roundings, one of a 3x3 determinant 3 + 2 + 3, and the
 * sum of magnitudes as many: 6 e and 17 e of the computed sum are enough. */
#define ERROR_2 0x1p-50
#define ERROR_3 0x1p-48

static _Thread_local unsigned long long integers;

unsigned long long cover_integers(void)
{
    return integers;
}

/* A difference of coordinates, not yet computed. */
struct diff {
    float to, from;
};

static double diff_double(struct diff d)
{
    return (double)d.to - (double)d.from;
}

/* x times 2^149, an integer for every finite float. */
static void float_wide(float x, struct oracle_wide *out)
{
    uint32_t bits = float_bits(x), exponent = bits >> 23 & 0xFFu;
    int64_t digits = (int64_t)(bits & 0x7FFFFFu) | (exponent ? 0x800000 : 0);
    wide_set(bits >> 31 ? -digits : digits, out);
    if (digits)
        wide_shift_left(out, exponent ? exponent - 1 : 0);
}

static void diff_wide(struct diff d, struct oracle_wide *out)
{
    struct oracle_wide to, from;
    float_wide(d.to, &to);
    float_wide(d.from, &from);
    wide_sub(&to, &from, out);
}

static int sign_of(double x)
{
    return (x > 0) - (x < 0);
}

/* a b - c d */
static void minor_wide(struct diff a, struct diff b, struct diff c, struct diff d,
                       struct oracle_wide *out)
{
    struct oracle_wide x, y, left, right;
    diff_wide(a, &x);
    diff_wide(b, &y);
    wide_mul(&x, &y, &left);
    diff_wide(c, &x);
    diff_wide(d, &y);
    wide_mul(&x, &y, &right);
    wide_sub(&left, &right, out);
}

static int sign_minor(struct diff a, struct diff b, struct diff c, struct diff d)
{
    double left = diff_double(a) * diff_double(b), right = diff_double(c) * diff_double(d);
    if (fabs(left - right) > ERROR_2 * (fabs(left) + fabs(right)))
        return sign_of(left - right);
    if (left == 0 && right == 0) /* products of differences of floats do not underflow */
        return 0;
    struct oracle_wide exact;
    integers++;
    minor_wide(a, b, c, d, &exact);
    return exact.sign;
}

/* Sign of the triple product of x, y and z. */
static int sign_triple(const struct diff x[3], const struct diff y[3], const struct diff z[3])
{
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double left = diff_double(y[i]) * diff_double(z[j]);
        double right = diff_double(y[j]) * diff_double(z[i]);
        sum += diff_double(x[k]) * (left - right);
        size += fabs(diff_double(x[k])) * (fabs(left) + fabs(right));
    }
    if (fabs(sum) > ERROR_3 * size)
        return sign_of(sum);
    if (size == 0)
        return 0;
    struct oracle_wide exact, factor, minor, term;
    integers++;
    wide_set(0, &exact);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        minor_wide(y[i], z[j], y[j], z[i], &minor);
        diff_wide(x[k], &factor);
        wide_mul(&factor, &minor, &term);
        wide_add(&exact, &term, &exact);
    }
    return exact.sign;
}

/* Finds the least (or greatest) corner of `part` along an axis, given by the signs of its
 * components. *inner: the corner is on an open side that moves it along the axis. */
static void corner_along(const struct cover_part *part, const int sign[3], bool greatest,
                         float corner[3], bool *inner)
{
    *inner = false;
    for (int k = 0; k < 3; k++) {
        bool high = greatest == (sign[k] > 0);
        corner[k] = high ? part->box.hi[k] : part->box.lo[k];
        if (sign[k] != 0 && (part->open & (high ? COVER_OPEN_HI(k) : COVER_OPEN_LO(k))))
            *inner = true;
    }
}

static bool apart_on_box_axes(float v[3][3], const struct cover_part *part)
{
    for (int k = 0; k < 3; k++) {
        float least = v[0][k], most = v[0][k];
        for (int c = 1; c < 3; c++) {
            least = v[c][k] < least ? v[c][k] : least;
            most = v[c][k] > most ? v[c][k] : most;
        }
        if (most < part->box.lo[k] || least > part->box.hi[k] ||
            (most == part->box.lo[k] && (part->open & COVER_OPEN_LO(k))) ||
            (least == part->box.hi[k] && (part->open & COVER_OPEN_HI(k))))
            return true;
    }
    return false;
}

static bool apart_on_normal(float v[3][3], const struct cover_part *part)
{
    struct diff edge[2][3];
    int sign[3];
    for (int k = 0; k < 3; k++)
        for (int e = 0; e < 2; e++)
            edge[e][k] = (struct diff){v[e + 1][k], v[0][k]};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sign[k] = sign_minor(edge[0][i], edge[1][j], edge[0][j], edge[1][i]);
    }
    for (int greatest = 0; greatest < 2; greatest++) {
        float corner[3];
        bool inner;
        struct diff way[3];
        corner_along(part, sign, greatest, corner, &inner);
        for (int k = 0; k < 3; k++)
            way[k] = (struct diff){corner[k], v[0][k]};
        int side = sign_triple(way, edge[0], edge[1]);
        if (greatest ? side < 0 || (side == 0 && inner) : side > 0 || (side == 0 && inner))
            return true;
    }
    return false;
}

/* Tests the cross product of unit vector `axis` and the edge from vertex `from`. Along it the
 * triangle extends from that edge to the opposite vertex. */
static bool apart_on_cross(float v[3][3], const struct cover_part *part, int axis, int from)
{
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const float *start = v[from], *end = v[(from + 1) % 3], *other = v[(from + 2) % 3];
    struct diff edge_i = {end[i], start[i]}, edge_j = {end[j], start[j]};
    int sign[3] = {0, 0, 0};
    sign[i] = (end[j] > start[j]) - (end[j] < start[j]);
    sign[j] = (end[i] < start[i]) - (end[i] > start[i]);
    for (int greatest = 0; greatest < 2; greatest++) {
        float corner[3];
        bool inner, apart = true;
        corner_along(part, sign, greatest, corner, &inner);
        for (int base = 0; base < 2 && apart; base++) {
            const float *at = base ? other : start;
            int side = sign_minor(edge_j, (struct diff){corner[i], at[i]}, edge_i,
                                  (struct diff){corner[j], at[j]});
            apart = (greatest ? side < 0 : side > 0) || (side == 0 && inner);
        }
        if (apart)
            return true;
    }
    return false;
}

bool cover_part_empty(const struct cover_part *part)
{
    for (int k = 0; k < 3; k++) {
        float lo = part->box.lo[k], hi = part->box.hi[k];
        if (!(lo <= hi) || (lo == hi && (part->open & (COVER_OPEN_LO(k) | COVER_OPEN_HI(k)))))
            return true;
    }
    return false;
}

bool cover_meets(float v[3][3], const struct cover_part *part)
{
    if (cover_part_empty(part) || apart_on_box_axes(v, part) || apart_on_normal(v, part))
        return false;
    for (int axis = 0; axis < 3; axis++)
        for (int from = 0; from < 3; from++)
            if (apart_on_cross(v, part, axis, from))
                return false;
    return true;
}

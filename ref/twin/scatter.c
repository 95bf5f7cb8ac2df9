#include "ref/twin/scatter.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define UNIT 0x1p-24
/* Operands and results below it may be flushed; also where conversion to float32 may depend on the
 * thread's mode. */
#define NORMAL 0x1p-126
/* The least float32. */
#define LEAST 0x1p-149
/* Of a bound, for the roundings of the double that it is computed in. */
#define OUTWARD (1.0 + 0x1p-40)

static bool flushes(const struct liberty *k)
{
    return k->rounding.tiny > LEAST;
}

static struct scatter unknown(void)
{
    return (struct scatter){.lo = -INFINITY, .hi = INFINITY, .grid = -149};
}

static struct scatter zero(void)
{
    return (struct scatter){.grid = SCATTER_ZERO, .count = 1};
}

bool scatter_is_zero(const struct scatter *a)
{
    return a->lo == 0.0 && a->hi == 0.0;
}

bool scatter_has_zero(const struct scatter *a)
{
    for (int i = 0; i < a->count; i++)
        if (a->value[i] == 0.0)
            return true;
    return a->count == 0 && a->lo <= 0.0 && a->hi >= 0.0;
}

double scatter_least(const struct scatter *a)
{
    double least = INFINITY;
    for (int i = 0; i < a->count; i++)
        if (a->value[i] != 0.0)
            least = fmin(least, fabs(a->value[i]));
    if (a->count || scatter_is_zero(a))
        return least;
    return a->lo > 0.0 ? a->lo : a->hi < 0.0 ? -a->hi : ldexp(1.0, a->grid);
}

/* The exponent of x's lowest bit that is set. */
static int lowest_bit(double x)
{
    int exponent;
    double f = frexp(x, &exponent);
    if (f == 0.0)
        return SCATTER_ZERO;
    while (f != floor(f)) { /* at the lowest bit it is whole */
        f *= 2.0;
        exponent--;
    }
    return exponent;
}

struct scatter scatter_single(double x)
{
    struct scatter out = {.lo = x, .hi = x, .grid = lowest_bit(x), .count = 1};
    out.value[0] = x;
    return out;
}

struct scatter scatter_of(float x)
{
    return scatter_single((double)x);
}

struct scatter scatter_negate(const struct scatter *a)
{
    struct scatter out = {.lo = -a->hi, .hi = -a->lo, .grid = a->grid, .count = a->count};
    for (int i = 0; i < a->count; i++)
        out.value[i] = -a->value[a->count - 1 - i];
    return out;
}

/* --- lists ----------------------------------------------------------------------------------- */

/* Puts x in its place; a list that is full is dropped (count < 0). */
static void put(struct scatter *s, double x)
{
    int at = s->count;
    if (at < 0)
        return;
    while (at > 0 && s->value[at - 1] > x)
        at--;
    if (at > 0 && s->value[at - 1] == x)
        return;
    if (s->count == SCATTER_MOST) {
        s->count = -1;
        return;
    }
    memmove(s->value + at + 1, s->value + at, (size_t)(s->count - at) * sizeof *s->value);
    s->value[at] = x == 0.0 ? 0.0 : x;
    s->count++;
}

/* The float32 nearest to s + tail, the exact value: s is rounded to odd first. */
static double nearest(double s, double tail)
{
    uint64_t bits;
    memcpy(&bits, &s, sizeof bits);
    if (tail != 0.0 && !(bits & 1))
        s = nextafter(s, tail > 0.0 ? (double)INFINITY : -(double)INFINITY);
    return (double)(float)s;
}

/* Lists what s + tail, the exact result, may be rounded to by an operation of k u. */
static void put_rounded(double relative, double s, double tail, struct scatter *out)
{
    if (fabs(s) < NORMAL) {
        if (s != 0.0 || tail != 0.0) { /* below the normal range: by bounds alone */
            out->count = -1;
            return;
        }
        put(out, 0.0);
        return;
    }
    double f = nearest(s, tail);
    bool exact = f == s && tail == 0.0;
    put(out, f);
    if (relative > 1.0 && !exact) {
        double other = s + tail > f || (s == f && tail > 0.0) ? INFINITY : -INFINITY;
        put(out, (double)nextafterf((float)f, (float)other));
    }
}

/* Returns x + y - sum, exactly (Knuth). */
static double sum_tail(double x, double y, double sum)
{
    double back = sum - x;
    return (x - (sum - back)) + (y - back);
}

/* Lists what all pairs of numbers may come to, unless that is not known; out->count < 0 before. */
static void list_pairs(const struct liberty *k, double relative, bool sum, const struct scatter *a,
                       const struct scatter *b, struct scatter *out)
{
    if (relative > 2.0 || !a->count || !b->count)
        return;
    out->count = 0;
    for (int i = 0; i < a->count && out->count >= 0; i++)
        for (int j = 0; j < b->count && out->count >= 0; j++) {
            double x = a->value[i], y = b->value[j], total = x + y, product = x * y;
            if (sum)
                put_rounded(relative, total, sum_tail(x, y, total), out);
            else
                put_rounded(relative, product, 0.0, out); /* exact: 48 bits */
            if (!sum && k->fuses)
                put(out, product);
        }
}

/* --- bounds ---------------------------------------------------------------------------------- */

/* From the bounds of exact results to those of rounded ones. `sum`: exact below the normal range if
 * its operands are float32. */
static void round_bounds(const struct liberty *k, double relative, bool sum, struct scatter *out)
{
    double lo = out->lo, hi = out->hi, slip = relative * UNIT * OUTWARD;
    out->lo -= slip * fabs(lo);
    out->hi += slip * fabs(hi);
    bool low = out->lo < NORMAL && out->hi > -NORMAL && !(lo == 0.0 && hi == 0.0);
    if (low && (!sum || k->fuses)) {
        out->lo -= LEAST;
        out->hi += LEAST;
    }
    if (lo >= 0.0 && out->lo < 0.0)
        out->lo = 0.0;
    if (hi <= 0.0 && out->hi > 0.0)
        out->hi = 0.0;
    if (low && flushes(k)) {
        out->lo = fmin(out->lo, 0.0);
        out->hi = fmax(out->hi, 0.0);
    }
}

/* Bounds, grid and list of float32 numbers within the bounds. */
static void settle(struct scatter *out)
{
    if (!(fabs(out->lo) < (double)FLT_MAX && fabs(out->hi) < (double)FLT_MAX)) {
        *out = unknown();
        return;
    }
    if (out->count < 0)
        out->count = 0;
    if (out->count) {
        out->lo = out->value[0];
        out->hi = out->value[out->count - 1];
    }
    if (out->lo == 0.0 && out->hi == 0.0) {
        *out = zero();
        return;
    }
    if (out->grid < -149)
        out->grid = -149;
    double least = out->lo > 0.0 ? out->lo : out->hi < 0.0 ? -out->hi : 0.0;
    if (least > NORMAL) {
        int exponent;
        frexp(least, &exponent); /* least >= 2^(exponent - 1) */
        if (out->grid < exponent - 24)
            out->grid = exponent - 24;
    }
}

static bool may_be_subnormal(const struct scatter *a)
{
    for (int i = 0; i < a->count; i++)
        if (a->value[i] != 0.0 && fabs(a->value[i]) < NORMAL)
            return true;
    return a->count == 0 && a->lo < NORMAL && a->hi > -NORMAL;
}

/* An operand as an operation sees it: a subnormal one may be flushed. */
static struct scatter seen(const struct liberty *k, const struct scatter *a)
{
    struct scatter out = *a;
    if (!flushes(k) || !may_be_subnormal(a))
        return out;
    if (out.count)
        put(&out, 0.0);
    if (out.count < 0)
        out.count = 0;
    out.lo = fmin(out.lo, 0.0);
    out.hi = fmax(out.hi, 0.0);
    return out;
}

static bool is_unknown(const struct scatter *a)
{
    return !(isfinite(a->lo) && isfinite(a->hi));
}

static double away(double x, double tail, double to)
{
    return tail != 0.0 ? nextafter(x, to) : x;
}

struct scatter scatter_add(const struct liberty *k, const struct scatter *p,
                           const struct scatter *q)
{
    struct scatter a = seen(k, p), b = seen(k, q), out = {.count = -1};
    double relative = k->rounding.add;
    if (is_unknown(&a) || is_unknown(&b))
        return unknown();
    out.lo = a.lo + b.lo;
    out.hi = a.hi + b.hi;
    out.lo = away(out.lo, sum_tail(a.lo, b.lo, out.lo), -INFINITY);
    out.hi = away(out.hi, sum_tail(a.hi, b.hi, out.hi), INFINITY);
    out.grid = a.grid < b.grid ? a.grid : b.grid;
    list_pairs(k, relative, true, &a, &b, &out);
    round_bounds(k, relative, true, &out);
    settle(&out);
    return out;
}

struct scatter scatter_sub(const struct liberty *k, const struct scatter *a,
                           const struct scatter *b)
{
    struct scatter minus = scatter_negate(b);
    return scatter_add(k, a, &minus);
}

/* Bounds of the exact products. */
static void product_bounds(const struct scatter *a, const struct scatter *b, struct scatter *out)
{
    double x[2] = {a->lo, a->hi}, y[2] = {b->lo, b->hi};
    out->lo = INFINITY;
    out->hi = -INFINITY;
    for (int i = 0; i < 4; i++) {
        double p = x[i / 2] * y[i % 2], tail = fma(x[i / 2], y[i % 2], -p);
        out->lo = fmin(out->lo, away(p, tail, -INFINITY));
        out->hi = fmax(out->hi, away(p, tail, INFINITY));
    }
    out->grid = a->grid + b->grid;
}

struct scatter scatter_mul(const struct liberty *k, const struct scatter *p,
                           const struct scatter *q)
{
    struct scatter a = seen(k, p), b = seen(k, q), out = {.count = -1};
    double relative = k->rounding.mul;
    if (scatter_is_zero(&a) || scatter_is_zero(&b))
        return zero();
    if (is_unknown(&a) || is_unknown(&b))
        return unknown();
    product_bounds(&a, &b, &out);
    int grid = out.grid;
    list_pairs(k, relative, false, &a, &b, &out);
    round_bounds(k, relative, false, &out); /* the exact products are in them, too */
    settle(&out);
    if (k->fuses && !is_unknown(&out) && !scatter_is_zero(&out))
        out.grid = grid;
    return out;
}

struct scatter scatter_div(const struct liberty *k, const struct scatter *p,
                           const struct scatter *q)
{
    struct scatter a = seen(k, p), b = seen(k, q), out = {.grid = -149};
    double relative = k->rounding.div;
    if (is_unknown(&a) || is_unknown(&b) || scatter_has_zero(&b) || b.lo * b.hi <= 0.0)
        return unknown();
    double least = fmin(fabs(b.lo), fabs(b.hi)), most = fmax(fabs(b.lo), fabs(b.hi));
    if (relative > 1.0 && (least < 0x1p-125 || most > 0x1p125)) /* nothing is promised */
        return unknown();
    if (scatter_is_zero(&a))
        return zero();
    double x[2] = {a.lo, a.hi}, y[2] = {b.lo, b.hi};
    out.lo = INFINITY;
    out.hi = -INFINITY;
    for (int i = 0; i < 4; i++) {
        double quotient = x[i / 2] / y[i % 2], tail = fma(-quotient, y[i % 2], x[i / 2]);
        out.lo = fmin(out.lo, away(quotient, tail, -INFINITY));
        out.hi = fmax(out.hi, away(quotient, tail, INFINITY));
    }
    out.count = -1;
    if (relative <= 1.0 && a.count == 1 && b.count == 1) {
        double quotient = a.value[0] / b.value[0];
        out.count = 0;
        put_rounded(relative, quotient, fma(-quotient, b.value[0], a.value[0]) * b.value[0], &out);
    }
    round_bounds(k, relative, false, &out);
    settle(&out);
    return out;
}

struct scatter scatter_either(const struct scatter *a, const struct scatter *b)
{
    struct scatter out = *a;
    for (int i = 0; i < b->count && a->count; i++)
        put(&out, b->value[i]);
    out.lo = fmin(a->lo, b->lo);
    out.hi = fmax(a->hi, b->hi);
    out.grid = a->grid < b->grid ? a->grid : b->grid;
    if (out.count < 0 || !a->count || !b->count)
        out.count = 0;
    return out;
}

#include "tests/trace/scatter_truth.h"

#include <assert.h>
#include <float.h>
#include <gmp.h>
#include <math.h>

#define NORMAL 0x1p-126

static void add_value(struct scatter_truth *out, double x)
{
    int at = 0;
    while (at < out->count && out->value[at] < x)
        at++;
    if (at < out->count && out->value[at] == x)
        return;
    assert(out->count < TRUTH_MOST);
    for (int i = out->count++; i > at; i--)
        out->value[i] = out->value[i - 1];
    out->value[at] = x == 0.0 ? 0.0 : x;
}

/* The largest float32 at most x and the least at least x. */
static void around(const mpq_t x, double *below, double *above)
{
    mpq_t y;
    mpq_init(y);
    float f = (float)mpq_get_d(x);
    for (;;) {
        mpq_set_d(y, (double)f);
        if (mpq_cmp(y, x) <= 0)
            break;
        f = nextafterf(f, -INFINITY);
    }
    for (;;) {
        float next = nextafterf(f, INFINITY);
        if (isinf(next))
            break;
        mpq_set_d(y, (double)next);
        if (mpq_cmp(y, x) > 0)
            break;
        f = next;
    }
    mpq_set_d(y, (double)f);
    *below = (double)f;
    *above = mpq_equal(y, x) ? (double)f : (double)nextafterf(f, INFINITY);
    mpq_clear(y);
}

/* Of the two, which is nearest to x; if both are, the even one. */
static double nearest_of(const mpq_t x, double below, double above)
{
    mpq_t down, up;
    mpq_inits(down, up, NULL);
    mpq_set_d(down, below);
    mpq_set_d(up, above);
    mpq_sub(down, x, down);
    mpq_sub(up, up, x);
    int order = mpq_cmp(down, up);
    mpq_clears(down, up, NULL);
    if (order != 0)
        return order < 0 ? below : above;
    int exponent;
    double ulp = above - below, steps = frexp(below, &exponent) == 0.0 ? 0.0 : below / ulp;
    return fmod(steps, 2.0) == 0.0 ? below : above;
}

/* The exact result joins the bounds. */
static void widen(const mpq_t x, struct scatter_truth *out)
{
    mpq_t y;
    double lo = mpq_get_d(x), hi = lo; /* truncated */
    mpq_init(y);
    mpq_set_d(y, lo);
    if (mpq_cmp(y, x) < 0)
        hi = nextafter(lo, INFINITY);
    else if (mpq_cmp(y, x) > 0)
        lo = nextafter(lo, -INFINITY);
    mpq_clear(y);
    out->lo = fmin(out->lo, lo);
    out->hi = fmax(out->hi, hi);
}

static void add_exact(const struct liberty *k, double relative, const mpq_t x,
                      struct scatter_truth *out)
{
    double below, above, limit = mpq_get_d(x);
    bool flushes = k->rounding.tiny > 0x1p-149;
    widen(x, out);
    if (fabs(limit) >= (double)FLT_MAX) {
        out->beyond = true;
        return;
    }
    around(x, &below, &above);
    out->small = out->small || (mpq_sgn(x) != 0 && fabs(limit) < NORMAL);
    double nearest = nearest_of(x, below, above);
    add_value(out, nearest);
    if (relative > 1.0) {
        add_value(out, below);
        add_value(out, above);
    }
    if (flushes && fabs(limit) < NORMAL)
        add_value(out, 0.0);
}

static void add_pair(const struct liberty *k, enum scatter_op op, double a, double b,
                     struct scatter_truth *out)
{
    const double relative[] = {k->rounding.add, k->rounding.add, k->rounding.mul, k->rounding.div};
    mpq_t x, y;
    if (op == SCATTER_DIV && b == 0.0) {
        out->beyond = true;
        return;
    }
    mpq_inits(x, y, NULL);
    mpq_set_d(x, a);
    mpq_set_d(y, b);
    if (op == SCATTER_ADD)
        mpq_add(x, x, y);
    else if (op == SCATTER_SUB)
        mpq_sub(x, x, y);
    else if (op == SCATTER_MUL)
        mpq_mul(x, x, y);
    else
        mpq_div(x, x, y);
    add_exact(k, relative[op], x, out);
    if (op == SCATTER_MUL && k->fuses)
        add_value(out, mpq_get_d(x)); /* 48 bits */
    mpq_clears(x, y, NULL);
}

/* What an operation sees of a list. */
static int seen(const struct liberty *k, const struct scatter *a, double out[SCATTER_MOST + 1])
{
    int count = 0;
    bool zero = false;
    for (int i = 0; i < a->count; i++) {
        out[count++] = a->value[i];
        zero = zero || (k->rounding.tiny > 0x1p-149 && fabs(a->value[i]) < NORMAL);
    }
    if (zero)
        out[count++] = 0.0;
    return count;
}

void scatter_truth_make(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                        const struct scatter *b, struct scatter_truth *out)
{
    double x[SCATTER_MOST + 1], y[SCATTER_MOST + 1];
    int xs = seen(k, a, x), ys = seen(k, b, y);
    *out = (struct scatter_truth){.lo = INFINITY, .hi = -INFINITY};
    for (int i = 0; i < xs; i++)
        for (int j = 0; j < ys; j++)
            add_pair(k, op, x[i], y[j], out);
}

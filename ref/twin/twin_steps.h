/* The steps of the twins (ref/twin/twin.h) and the formulas made of them, for one pair or for a
 * vector of pairs: included once per kind of number, each in a unit of its own, which defines
 *   KERNEL_TARGET           an attribute, or nothing
 *   real, single            double and float, or vectors of them
 *   ALL(x), EACH(x)         the number in every lane of a real, of a single
 *   WIDEN(single)           as real
 *   SIZE(real)              |x|
 *   mask                    what comparisons give; & works on it
 *   LESS, NOT_ABOVE, EQUAL, NOT
 *   ANY(mask)               whether it is true in some lane
 *   SELECT(mask, a, b), SELECT_EACH(mask, a, b)  of real, of single
 * Arithmetic takes a vector and a number, too. No operation may be fused or reordered.
 * RAY_BOUNDED is 1 where a ray's own numbers have bounds (ref/twin/twin_placed.h). */
#ifndef TWIN_STEPS_H
#define TWIN_STEPS_H

#include "ref/twin/model.h"

#include <math.h>
#include <stdbool.h>

#ifndef RAY_BOUNDED
#define RAY_BOUNDED 0
#endif

#define UNIT 0x1p-24
#ifndef TWIN_TURNED /* a test turns them */
/* The bounds are computed in double from values known to 2^-28 of their own bound (see below), so
 * that both errors together stay below this factor, over all steps of a formula. */
#define SLACK (1.0 + 0x1p-20)
/* From here on a result may round to infinity: FLT_MAX less two units of its last place. */
#define LARGEST 0x1.fffffap127
/* Flushed subnormals are below this, with room for the error of the comparison itself. */
#define NORMAL 0x1.001p-126
/* Divisions that are not correctly rounded are promised for divisors up to 2^126 and from 2^-126;
 * at the ends an estimated reciprocal may already be flushed. */
#define DIVISOR_LEAST 0x1p-125
#define DIVISOR_MOST  0x1p125
#endif
/* Embree's robust test gives u = v = 0 below this sum of edge functions. */
#define EMBREE_LEAST_SUM 1e-18

/* A value of the formula.
 *   v  as float32 with round to nearest and subnormals kept: one evaluation of many
 *   x  the same in double: within 2^-28 e of the exact value, since each float32 step adds at least
 *      2^-24 of its result to e where the double step errs by 2^-53 of it
 *   e  |c - exact value| <= e for every evaluation c that the rounding allows; infinite if there is
 *      none (overflow, division by what may be zero), never NaN */
struct bounded {
    single v;
    real x, e;
};

/* A rounding, ready for use. Most of a fuzzing run's own time goes into the steps below, so they
 * are inlined, and what depends only on the rounding is computed once. */
struct rules {
    double add, mul, div; /* relative */
    double tiny, flush;   /* what a subnormal operand or result may lose */
    bool estimated;       /* divisions are promised for some divisors only */
};

#define STEP    KERNEL_TARGET static inline __attribute__((always_inline))
#define FORMULA KERNEL_TARGET static

static struct rules rules_of(const struct rounding *k)
{
    return (struct rules){.add = k->add * UNIT,
                          .mul = k->mul * UNIT,
                          .div = k->div * UNIT,
                          .tiny = k->tiny,
                          .flush = k->tiny > 0x1p-149 ? k->tiny : 0.0,
                          .estimated = k->div > 1.0};
}

STEP struct bounded exact(single v)
{
    return (struct bounded){v, WIDEN(v), ALL(0.0)};
}

STEP struct bounded settle(single v, real x, real e)
{
    e = SELECT(LESS(SIZE(x) + e, ALL(LARGEST)), e, ALL(INFINITY)); /* NaN, too */
    return (struct bounded){v, x, e * SLACK};
}

/* An operand as the operation sees it: a subnormal one may be flushed. */
STEP real operand_error(const struct rules *k, struct bounded a)
{
    if (k->flush == 0.0)
        return a.e;
    mask zero = EQUAL(a.x, ALL(0.0)) & EQUAL(a.e, ALL(0.0));
    mask flushed = NOT(zero) & LESS(SIZE(a.x) - a.e, ALL(NORMAL));
    return SELECT(flushed, a.e + k->flush, a.e);
}

/* Sums of float32 are exact below the normal range, unless they are flushed. */
STEP struct bounded add(const struct rules *k, struct bounded a, struct bounded b)
{
    real x = a.x + b.x, carried = operand_error(k, a) + operand_error(k, b);
    real e = carried + k->add * (SIZE(x) + carried) + k->flush;
    return settle(a.v + b.v, x, e);
}

STEP struct bounded negate(struct bounded a)
{
    return (struct bounded){-a.v, -a.x, a.e};
}

STEP struct bounded sub(const struct rules *k, struct bounded a, struct bounded b)
{
    return add(k, a, negate(b));
}

/* a - b where the engine compares a with b: nothing is rounded. */
STEP struct bounded compare(struct bounded a, struct bounded b)
{
    return settle(a.v - b.v, a.x - b.x, a.e + b.e);
}

STEP struct bounded mul(const struct rules *k, struct bounded a, struct bounded b)
{
    real ea = operand_error(k, a), eb = operand_error(k, b);
    real x = a.x * b.x, carried = SIZE(a.x) * eb + SIZE(b.x) * ea + ea * eb;
    real e = carried + k->mul * (SIZE(x) + carried) + k->tiny;
    return settle(a.v * b.v, x, e);
}

/* With a = exact a + da and so on: a'/b' - a/b = (da - a/b db) / b', |b'| >= |b| - eb. */
STEP struct bounded divide(const struct rules *k, struct bounded a, struct bounded b)
{
    real ea = operand_error(k, a), eb = operand_error(k, b);
    real x = a.x / b.x, least = SIZE(b.x) - eb, most = SIZE(b.x) + eb;
    mask promised = LESS(ALL(0.0), least);
    if (k->estimated)
        promised = NOT_ABOVE(ALL(DIVISOR_LEAST), least) & NOT_ABOVE(most, ALL(DIVISOR_MOST));
    real carried = (ea + SIZE(x) * eb) / least;
    real e = carried + k->div * (SIZE(x) + carried) + k->tiny;
    return settle(a.v / b.v, x, SELECT(promised, e, ALL(INFINITY)));
}

/* Twice a value, without error. */
STEP struct bounded twice(struct bounded a)
{
    return settle(2.0f * a.v, 2.0 * a.x, 2.0 * a.e);
}

STEP void subtract(const struct rules *k, const struct bounded a[3], const struct bounded b[3],
                   struct bounded out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = sub(k, a[i], b[i]);
}

STEP void cross(const struct rules *k, const struct bounded a[3], const struct bounded b[3],
                struct bounded out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        out[i] = sub(k, mul(k, a[j], b[l]), mul(k, a[l], b[j]));
    }
}

/* (x + y) + z */
STEP struct bounded dot(const struct rules *k, const struct bounded a[3], const struct bounded b[3])
{
    struct bounded sum = add(k, mul(k, a[0], b[0]), mul(k, a[1], b[1]));
    return add(k, sum, mul(k, a[2], b[2]));
}

/* x + (y + z), as Embree sums. */
STEP struct bounded dot_embree(const struct rules *k, const struct bounded a[3],
                               const struct bounded b[3])
{
    struct bounded sum = add(k, mul(k, a[1], b[1]), mul(k, a[2], b[2]));
    return add(k, mul(k, a[0], b[0]), sum);
}

#include "ref/twin/twin_ratio.h"

/* The results of every formula. */
struct outcome {
    struct bounded edge[3]; /* inside they have one sign */
    struct bounded det;     /* their sum, or in proportion to it */
    struct bounded t, u, v;
    real t_running; /* t's bound by running errors, which t.x keeps to 2^-28 of itself */
    real band;      /* by how much an edge function may have the other sign and still be accepted */
    bool det_alone; /* det's sign takes no part in the decision */
};

struct input {
    struct bounded o[3], d[3], v[3][3];
};

FORMULA struct outcome eval_moeller_trumbore(const struct rules *k, const struct input *in)
{
    struct bounded e1[3], e2[3], s[3], p[3], q[3];
    real own_p[3], own_q[3];
    struct mt_parts mt = {e1, e2, s, in->d, own_p, own_q, ALL(0.0), ALL(0.0)};
    struct outcome out = {.band = ALL(0.0)};
    subtract(k, in->v[1], in->v[0], e1);
    subtract(k, in->v[2], in->v[0], e2);
    subtract(k, in->o, in->v[0], s);
    cross_from(k, in->d, e2, p, own_p);
    cross_from(k, s, e1, q, own_q);
    out.det = dot_from(k, e1, p, false, &mt.own_bottom);
    out.edge[1] = dot(k, s, p);
    out.edge[2] = dot(k, in->d, q);
    out.edge[0] = compare(out.det, add(k, out.edge[1], out.edge[2]));
    out.t = divide(k, dot_from(k, e2, q, false, &mt.own_top), out.det);
    out.t_running = out.t.e;
    out.t = t_by_quotient(k, out.t, out.det, mt_residual(&mt, out.t));
    out.u = divide(k, out.edge[1], out.det);
    out.v = divide(k, out.edge[2], out.det);
    return out;
}

/* Axes are turned so that they are kx, ky, kz (ref/primitives/tri.h). */
FORMULA struct outcome eval_woop(const struct rules *k, const struct input *in)
{
    struct bounded x[3], y[3], z[3], az[3];
    struct outcome out = {.band = ALL(0.0)};
    struct woop_parts w = {.x = x, .y = y, .z = z, .depth = az, .edge = out.edge};
    w.sx = divide(k, in->d[0], in->d[2]);
    w.sy = divide(k, in->d[1], in->d[2]);
    w.sz = divide(k, exact(EACH(1.0f)), in->d[2]);
    for (int c = 0; c < 3; c++) {
        az[c] = sub(k, in->v[c][2], in->o[2]);
        x[c] = sub(k, sub(k, in->v[c][0], in->o[0]), mul(k, w.sx, az[c]));
        y[c] = sub(k, sub(k, in->v[c][1], in->o[1]), mul(k, w.sy, az[c]));
        z[c] = mul(k, w.sz, az[c]);
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        struct bounded p = mul(k, x[a], y[b]), q = mul(k, y[a], x[b]);
        out.edge[c] = sub(k, p, q);
        w.own[c] = own_of_product(k, x[a], y[b], p) + own_of_product(k, y[a], x[b], q) +
                   own_of_sum(k, out.edge[c]);
    }
    struct bounded part = add(k, out.edge[0], out.edge[1]);
    out.det = add(k, part, out.edge[2]);
    w.own_bottom = own_of_sum(k, part) + own_of_sum(k, out.det);
    out.t = divide(k, dot_from(k, out.edge, z, false, &w.own_top), out.det);
    out.t_running = out.t.e;
    out.t = t_by_quotient(k, out.t, out.det, woop_residual(&w, out.t));
    out.u = divide(k, out.edge[1], out.det);
    out.v = divide(k, out.edge[2], out.det);
    return out;
}

/* The sum of the sides divides u and v, and its sign is tested beside the determinant's: where it
 * is open nothing is certain. */
FORMULA struct outcome eval_pluecker(const struct rules *k, const struct input *in)
{
    struct bounded a[3][3], e[3][3], sum[3], side[3], n[3];
    struct outcome out = {.band = ALL(0.0)};
    for (int c = 0; c < 3; c++)
        subtract(k, in->v[c], in->o, a[c]);
    for (int c = 0; c < 3; c++) {
        int p = (c + 1) % 3, q = (c + 2) % 3;
        subtract(k, in->v[q], in->v[p], e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = add(k, a[p][i], a[q][i]);
        cross(k, sum, e[c], side);
        out.edge[c] = dot(k, in->d, side);
    }
    cross(k, e[1], e[2], n);
    real own_top, own_bottom;
    struct bounded det = dot_from(k, in->d, n, false, &own_bottom);
    struct bounded all = add(k, add(k, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = divide(k, dot_from(k, a[0], n, false, &own_top), det);
    out.t_running = out.t.e;
    out.t =
        t_by_quotient(k, out.t, det, plane_residual(n, a[0], in->d, out.t, own_top, own_bottom));
    out.u = divide(k, out.edge[1], all);
    out.v = divide(k, out.edge[2], all);
    out.det = det;
    out.det.e = SELECT(LESS(all.e, SIZE(all.x)), det.e, ALL(INFINITY));
    return out;
}

/* Embree multiplies by an estimated reciprocal. u and v are cut off at 1, which of an accepted hit
 * takes them no farther from the exact value than the bound. The range is tested as
 * |det| tmin < |T| <= |det| tmax: the product's error, one rounding and one underflow, is among
 * those that t's bound has counted in T and in the multiplication by the reciprocal. */
FORMULA struct outcome eval_embree(const struct rules *k, const struct input *in)
{
    struct bounded e1[3], e2[3], n[3], c[3], r[3];
    struct outcome out = {.band = ALL(0.0)};
    subtract(k, in->v[0], in->v[1], e1);
    subtract(k, in->v[2], in->v[0], e2);
    subtract(k, in->v[0], in->o, c);
    cross(k, e2, e1, n);
    cross(k, c, in->d, r);
    real own_top, own_bottom;
    out.det = dot_from(k, n, in->d, true, &own_bottom);
    out.edge[1] = dot_embree(k, r, e2);
    out.edge[2] = dot_embree(k, r, e1);
    out.edge[0] = compare(out.det, add(k, out.edge[1], out.edge[2]));
    struct bounded inverse = divide(k, exact(EACH(1.0f)), out.det);
    struct bounded top = dot_from(k, n, c, true, &own_top);
    out.t = mul(k, top, inverse);
    out.t_running = out.t.e;
    out.t = t_by_reciprocal(k, out.t, top, out.det, inverse,
                            plane_residual(n, c, in->d, out.t, own_top, own_bottom));
    out.u = mul(k, out.edge[1], inverse);
    out.v = mul(k, out.edge[2], inverse);
    return out;
}

/* Embree's normal of edges a, b, c is, component by component, a x b or b x c, whichever has the
 * smaller products. Either may be chosen where they are as good as equal. */
STEP struct bounded stable_component(const struct rules *k, const struct bounded e[3][3], int i)
{
    int j = (i + 1) % 3, l = (i + 2) % 3;
    struct bounded ab = mul(k, e[0][l], e[1][j]), bc = mul(k, e[1][l], e[2][j]);
    struct bounded first = sub(k, mul(k, e[0][j], e[1][l]), ab);
    struct bounded second = sub(k, mul(k, e[1][j], e[2][l]), bc);
    mask left = LESS(SIZE(WIDEN(ab.v)), SIZE(WIDEN(bc.v)));
    return (struct bounded){SELECT_EACH(left, first.v, second.v), SELECT(left, first.x, second.x),
                            SELECT(LESS(first.e, second.e), second.e, first.e)};
}

/* Pluecker edge functions of vertices relative to the origin; negative ones within EMBREE_BAND of
 * their sum are accepted. Edge 0 of Embree's is opposite vertex 1 of the triangle, and so on. */
FORMULA struct outcome eval_embree_robust(const struct rules *k, const struct input *in)
{
    struct bounded v[3][3], e[3][3], sum[3], side[3], n[3], edge[3];
    struct outcome out = {.det_alone = true};
    for (int c = 0; c < 3; c++)
        subtract(k, in->v[c], in->o, v[c]);
    for (int c = 0; c < 3; c++) { /* e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2 */
        int from = (c + 2) % 3;
        subtract(k, v[from], v[c], e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = add(k, v[from][i], v[c][i]);
        cross(k, e[c], sum, side);
        edge[c] = dot_embree(k, side, in->d);
        out.edge[(c + 1) % 3] = edge[c];
    }
    struct bounded all = add(k, add(k, edge[0], edge[1]), edge[2]);
    out.band = (SIZE(all.x) + all.e) * EMBREE_BAND * SLACK + k->tiny;
    for (int i = 0; i < 3; i++)
        n[i] = stable_component(k, e, i);
    real own_top, own_bottom;
    out.det = twice(dot_from(k, n, in->d, true, &own_bottom));
    struct bounded top = twice(dot_from(k, v[0], n, true, &own_top));
    struct bounded inverse = divide(k, exact(EACH(1.0f)), out.det);
    out.t = mul(k, inverse, top);
    out.t_running = out.t.e;
    out.t = t_by_reciprocal(k, out.t, top, out.det, inverse,
                            2.0 * plane_residual(n, v[0], in->d, out.t, own_top, own_bottom));
    inverse = divide(k, exact(EACH(1.0f)), all);
    inverse.e = SELECT(LESS(SIZE(all.x) - all.e, ALL(EMBREE_LEAST_SUM)), ALL(INFINITY), inverse.e);
    out.u = mul(k, edge[0], inverse);
    out.v = mul(k, edge[1], inverse);
    return out;
}

#include "ref/twin/twin_baldwin_webber.h"

FORMULA struct outcome evaluate(enum twin_formula formula, const struct rules *k,
                                const struct input *in)
{
    switch (formula) {
    case TWIN_MT:
    case TWIN_MT_RTRS:
    case TWIN_UNKNOWN:
        break;
    case TWIN_WOOP:
        return eval_woop(k, in);
    case TWIN_PLUECKER:
        return eval_pluecker(k, in);
    case TWIN_BALDWIN_WEBBER:
    case TWIN_TRI_ACCEL:
        return eval_baldwin_webber(k, in, formula == TWIN_TRI_ACCEL);
    case TWIN_EMBREE:
        return eval_embree(k, in);
    case TWIN_EMBREE_ROBUST:
        return eval_embree_robust(k, in);
    }
    return eval_moeller_trumbore(k, in);
}

#endif

#include "ref/twin.h"

#include "ref/base.h"
#include "ref/mutant.h"

#include <math.h>

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
    float v;
    double x, e;
};

/* A rounding, ready for use. Of a fuzzing run's own time most goes into the steps below, so they
 * are inlined and what depends on the rounding alone is computed once. */
struct rules {
    double add, mul, div; /* relative */
    double tiny, flush;   /* what a subnormal operand or result may lose */
    bool estimated;       /* divisions are promised for some divisors only */
};

#define STEP static inline __attribute__((always_inline))

static struct rules rules_of(const struct rounding *k)
{
    return (struct rules){.add = k->add * UNIT,
                          .mul = k->mul * UNIT,
                          .div = k->div * UNIT,
                          .tiny = k->tiny,
                          .flush = k->tiny > 0x1p-149 ? k->tiny : 0.0,
                          .estimated = k->div > 1.0};
}

STEP struct bounded exact(float v)
{
    return (struct bounded){v, (double)v, 0.0};
}

STEP struct bounded settle(float v, double x, double e)
{
#if MUTANT == MUTANT_BAD_TWIN
    e *= 1e-4;
#endif
    if (!(fabs(x) + e < LARGEST)) /* NaN, too */
        e = INFINITY;
    return (struct bounded){v, x, e * SLACK};
}

/* An operand as the operation sees it: a subnormal one may be flushed. */
STEP double operand_error(const struct rules *k, struct bounded a)
{
#if MUTANT == MUTANT_OPERAND_KEPT
    (void)k;
    return a.e;
#endif
    if (k->flush == 0.0)
        return a.e;
    bool zero = a.x == 0.0 && a.e == 0.0;
    return !zero && fabs(a.x) - a.e < NORMAL ? a.e + k->flush : a.e;
}

/* Sums of float32 are exact below the normal range, unless they are flushed. */
STEP struct bounded add(const struct rules *k, struct bounded a, struct bounded b)
{
    double x = a.x + b.x, carried = operand_error(k, a) + operand_error(k, b);
    double e = carried + k->add * (fabs(x) + carried) + k->flush;
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
    double ea = operand_error(k, a), eb = operand_error(k, b);
    double x = a.x * b.x, carried = fabs(a.x) * eb + fabs(b.x) * ea + ea * eb;
    double e = carried + k->mul * (fabs(x) + carried) + k->tiny;
    return settle(a.v * b.v, x, e);
}

/* With a = exact a + da and so on: a'/b' - a/b = (da - a/b db) / b', |b'| >= |b| - eb. */
STEP struct bounded divide(const struct rules *k, struct bounded a, struct bounded b)
{
    double ea = operand_error(k, a), eb = operand_error(k, b);
    double x = a.x / b.x, least = fabs(b.x) - eb, most = fabs(b.x) + eb;
    bool promised = least > 0.0;
    if (k->estimated)
        promised = least >= DIVISOR_LEAST && most <= DIVISOR_MOST;
    double carried = (ea + fabs(x) * eb) / least;
    double e = carried + k->div * (fabs(x) + carried) + k->tiny;
    return settle(a.v / b.v, x, promised ? e : INFINITY);
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

/* What every formula ends in. */
struct outcome {
    struct bounded edge[3]; /* inside they have one sign */
    struct bounded det;     /* their sum, or in proportion to it */
    struct bounded t, u, v;
    double band;    /* by how much an edge function may have the other sign and still be accepted */
    bool det_alone; /* det's sign takes no part in the decision */
};

struct input {
    struct bounded o[3], d[3], v[3][3];
};

static struct outcome eval_moeller_trumbore(const struct rules *k, const struct input *in)
{
    struct bounded e1[3], e2[3], s[3], p[3], q[3];
    struct outcome out = {.band = 0.0};
    subtract(k, in->v[1], in->v[0], e1);
    subtract(k, in->v[2], in->v[0], e2);
    subtract(k, in->o, in->v[0], s);
    cross(k, in->d, e2, p);
    cross(k, s, e1, q);
    out.det = dot(k, e1, p);
    out.edge[1] = dot(k, s, p);
    out.edge[2] = dot(k, in->d, q);
    out.edge[0] = compare(out.det, add(k, out.edge[1], out.edge[2]));
    out.t = divide(k, dot(k, e2, q), out.det);
    out.u = divide(k, out.edge[1], out.det);
    out.v = divide(k, out.edge[2], out.det);
    return out;
}

static struct outcome eval_woop(const struct rules *k, const struct input *in,
                                const struct tri_ray *r)
{
    struct bounded x[3], y[3], z[3];
    struct outcome out = {.band = 0.0};
    struct bounded sx = divide(k, in->d[r->kx], in->d[r->kz]);
    struct bounded sy = divide(k, in->d[r->ky], in->d[r->kz]);
    struct bounded sz = divide(k, exact(1.0f), in->d[r->kz]);
    for (int c = 0; c < 3; c++) {
        struct bounded az = sub(k, in->v[c][r->kz], in->o[r->kz]);
        x[c] = sub(k, sub(k, in->v[c][r->kx], in->o[r->kx]), mul(k, sx, az));
        y[c] = sub(k, sub(k, in->v[c][r->ky], in->o[r->ky]), mul(k, sy, az));
        z[c] = mul(k, sz, az);
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        out.edge[c] = sub(k, mul(k, x[a], y[b]), mul(k, y[a], x[b]));
    }
    out.det = add(k, add(k, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = divide(k, dot(k, out.edge, z), out.det);
    out.u = divide(k, out.edge[1], out.det);
    out.v = divide(k, out.edge[2], out.det);
    return out;
}

/* Embree multiplies by an estimated reciprocal. u and v are cut off at 1, which of an accepted hit
 * takes them no farther from the exact value than the bound. The range is tested as
 * |det| tmin < |T| <= |det| tmax: the product's error, one rounding and one underflow, is among
 * those that t's bound has counted in T and in the multiplication by the reciprocal. */
static struct outcome eval_embree(const struct rules *k, const struct input *in)
{
    struct bounded e1[3], e2[3], n[3], c[3], r[3];
    struct outcome out = {.band = 0.0};
    subtract(k, in->v[0], in->v[1], e1);
    subtract(k, in->v[2], in->v[0], e2);
    subtract(k, in->v[0], in->o, c);
    cross(k, e2, e1, n);
    cross(k, c, in->d, r);
    out.det = dot_embree(k, n, in->d);
    out.edge[1] = dot_embree(k, r, e2);
    out.edge[2] = dot_embree(k, r, e1);
    out.edge[0] = compare(out.det, add(k, out.edge[1], out.edge[2]));
    struct bounded inverse = divide(k, exact(1.0f), out.det);
    out.t = mul(k, dot_embree(k, n, c), inverse);
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
    struct bounded chosen = fabsf(ab.v) < fabsf(bc.v) ? first : second;
    chosen.e = fmax(first.e, second.e);
    return chosen;
}

/* Pluecker edge functions of vertices relative to the origin; negative ones within EMBREE_BAND of
 * their sum are accepted. Edge 0 of Embree's is opposite vertex 1 of the triangle, and so on. */
static struct outcome eval_embree_robust(const struct rules *k, const struct input *in)
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
    out.band = (fabs(all.x) + all.e) * EMBREE_BAND * SLACK + k->tiny;
    for (int i = 0; i < 3; i++)
        n[i] = stable_component(k, e, i);
    out.det = twice(dot_embree(k, n, in->d));
    out.t = mul(k, divide(k, exact(1.0f), out.det), twice(dot_embree(k, v[0], n)));
    struct bounded inverse = divide(k, exact(1.0f), all);
    if (fabs(all.x) - all.e < EMBREE_LEAST_SUM)
        inverse.e = INFINITY;
    out.u = mul(k, edge[0], inverse);
    out.v = mul(k, edge[1], inverse);
    return out;
}

/* The sign that the exact value has and that no evaluation can miss, or 0. */
static int sign_of(struct bounded a)
{
    return fabs(a.x) > a.e ? (a.x > 0.0 ? 1 : -1) : 0;
}

enum twin_formula twin_of_tri(uint32_t id)
{
    return id == ABI_TRI_WOOP ? TWIN_WOOP : id == ABI_TRI_MT_RTRS ? TWIN_MT_RTRS : TWIN_MT;
}

static struct outcome evaluate(enum twin_formula formula, const struct rules *k,
                               const struct ray *ray, float v[3][3])
{
    struct input in;
    for (int i = 0; i < 3; i++) {
        in.o[i] = exact(ray->org[i]);
        in.d[i] = exact(ray->dir[i]);
        for (int c = 0; c < 3; c++)
            in.v[c][i] = exact(v[c][i]);
    }
    struct tri_ray r = tri_ray_make(ray);
    switch (formula) {
    case TWIN_MT:
    case TWIN_MT_RTRS:
    case TWIN_UNKNOWN:
        break;
    case TWIN_WOOP:
        return eval_woop(k, &in, &r);
    case TWIN_EMBREE:
        return eval_embree(k, &in);
    case TWIN_EMBREE_ROBUST:
        return eval_embree_robust(k, &in);
    }
    return eval_moeller_trumbore(k, &in);
}

/* Are the signs such that no evaluation accepts them? */
static bool surely_rejected(const struct outcome *out)
{
    bool positive = !out->det_alone && sign_of(out->det) > 0;
    bool negative = !out->det_alone && sign_of(out->det) < 0;
    for (int c = 0; c < 3; c++) {
        struct bounded edge = out->edge[c];
        edge.e += out->band;
        positive |= sign_of(edge) > 0;
        negative |= sign_of(edge) < 0;
    }
    return positive && negative;
}

struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3])
{
    const struct rules rules = rules_of(&rounding);
    struct outcome out = evaluate(formula, &rules, ray, v);
    double threshold = formula == TWIN_MT_RTRS ? (double)TRI_RTRS_EPS : 0.0;
    bool det_known = fabs(out.det.x) - out.det.e > threshold;
    bool det_possible = !(fabs(out.det.x) + out.det.e <= threshold);
    bool in_range = out.t.x - out.t.e > (double)ray->tmin && out.t.x + out.t.e < (double)ray->tmax;
    bool beyond = out.t.x + out.t.e < (double)ray->tmin || out.t.x - out.t.e > (double)ray->tmax;
    struct twin twin = {
        .possible = det_possible && !surely_rejected(&out) && !beyond,
        .beyond = beyond,
        .det = det_known ? sign_of(out.det) : 0,
        .t = out.t.v,
        .u = out.u.v,
        .v = out.v.v,
        .t_err = out.t.e,
        .u_err = out.u.e,
        .v_err = out.v.e,
        .t_near = out.t.x,
        .u_near = out.u.x,
        .v_near = out.v.x,
    };
#if MUTANT == MUTANT_NEAR_ROUNDED
    twin.t_near = (double)out.t.v;
#endif
    int inside = 0;
    for (int c = 0; c < 3; c++) {
        twin.edge[c] = sign_of(out.edge[c]);
        inside += twin.edge[c];
    }
    twin.certain = (inside == 3 || inside == -3) && det_known && in_range;
    return twin;
}

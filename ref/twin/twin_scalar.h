/* Twins of one pair: the steps of ref/twin/twin_steps.h on plain numbers, and what follows from
 * their results. Included by a unit that may define RAY_BOUNDED. */
#ifndef TWIN_SCALAR_H
#define TWIN_SCALAR_H

#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"
#include "ref/twin/twin.h"

#include <math.h>

/* One pair: plain numbers. */
typedef double real;
typedef float single;
typedef bool mask;

#define KERNEL_TARGET
#define ALL(x)               (x)
#define EACH(x)              (x)
#define WIDEN(x)             ((double)(x))
#define SIZE(x)              fabs(x)
#define LESS(a, b)           ((a) < (b))
#define NOT_ABOVE(a, b)      ((a) <= (b))
#define EQUAL(a, b)          ((a) == (b))
#define NOT(m)               (!(m))
#define ANY(m)               (m)
#define SELECT(m, a, b)      ((m) ? (a) : (b))
#define SELECT_EACH(m, a, b) ((m) ? (a) : (b))

#include "ref/twin/twin_steps.h"

/* Share of its running bound by which t's near value may be off, as every near value. */
#define T_OFF 0x1p-28

/* The sign that the exact value has and that no evaluation can miss, or 0. */
static int sign_of(struct bounded a)
{
    return fabs(a.x) > a.e ? (a.x > 0.0 ? 1 : -1) : 0;
}

/* True if no evaluation accepts these signs. */
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

/* The twin of these values. */
static struct twin conclude(enum twin_formula formula, const struct ray *ray, struct outcome out)
{
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
        .t_off = T_OFF * out.t_running,
        .u_near = out.u.x,
        .v_near = out.v.x,
    };
    int inside = 0;
    for (int c = 0; c < 3; c++) {
        twin.edge[c] = sign_of(out.edge[c]);
        inside += twin.edge[c];
    }
    twin.certain = (inside == 3 || inside == -3) && det_known && in_range;
    return twin;
}

#endif

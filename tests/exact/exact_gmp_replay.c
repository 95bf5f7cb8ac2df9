#include "tests/exact/exact_gmp_replay.h"

#include "ref/base/base.h"
#include "ref/primitives/tri.h"

#include <math.h>
#include <string.h>

/* Operations on exact float32 values, kept as doubles; `lost` once one of them is not finite. */
struct exact_gmp_replay_replay {
    mpq_t x, y;
    bool lost;
};

/* The power of two e with 2^e <= |x| < 2^(e+1). */
static long exponent_of(const mpq_t x)
{
    long e = (long)mpz_sizeinbase(mpq_numref(x), 2) - (long)mpz_sizeinbase(mpq_denref(x), 2);
    mpq_t size, power;
    mpq_inits(size, power, NULL);
    mpq_abs(size, x);
    mpq_set_si(power, 1, 1);
    if (e >= 0)
        mpq_mul_2exp(power, power, (mp_bitcnt_t)e);
    else
        mpq_div_2exp(power, power, (mp_bitcnt_t)-e);
    if (mpq_cmp(size, power) < 0)
        e--;
    mpq_clears(size, power, NULL);
    return e;
}

/* |x| / 2^last to the nearest whole number, ties to even. */
static double whole_units(const mpq_t x, long last)
{
    mpq_t scaled;
    mpz_t quotient, rest;
    mpq_init(scaled);
    mpz_inits(quotient, rest, NULL);
    mpq_abs(scaled, x);
    if (last >= 0)
        mpq_div_2exp(scaled, scaled, (mp_bitcnt_t)last);
    else
        mpq_mul_2exp(scaled, scaled, (mp_bitcnt_t)-last);
    mpz_fdiv_qr(quotient, rest, mpq_numref(scaled), mpq_denref(scaled));
    mpz_mul_2exp(rest, rest, 1);
    int half = mpz_cmp(rest, mpq_denref(scaled));
    if (half > 0 || (half == 0 && mpz_odd_p(quotient)))
        mpz_add_ui(quotient, quotient, 1);
    double units = mpz_get_d(quotient); /* at most 2^24: exact */
    mpq_clear(scaled);
    mpz_clears(quotient, rest, NULL);
    return units;
}

float exact_gmp_round(const mpq_t x)
{
    if (mpq_sgn(x) == 0)
        return 0.0f;
    long e = exponent_of(x);
    if (e > 128)
        return mpq_sgn(x) < 0 ? -INFINITY : INFINITY;
    long last = e - 23 > -149 ? e - 23 : -149; /* exponent of the last place */
    double value = ldexp(whole_units(x, last), (int)last);
    if (value >= 0x1p128)
        value = (double)INFINITY;
    return (float)(mpq_sgn(x) < 0 ? -value : value); /* exact: it is a float32 */
}

static double settle(struct exact_gmp_replay_replay *r)
{
    float value = exact_gmp_round(r->x);
    r->lost |= !float_is_finite(value);
    return r->lost ? 0 : (double)value;
}

static double sum(struct exact_gmp_replay_replay *r, double a, double b)
{
    mpq_set_d(r->x, a);
    mpq_set_d(r->y, b);
    mpq_add(r->x, r->x, r->y);
    return settle(r);
}

static double difference(struct exact_gmp_replay_replay *r, double a, double b)
{
    return sum(r, a, -b);
}

static double product(struct exact_gmp_replay_replay *r, double a, double b)
{
    mpq_set_d(r->x, a);
    mpq_set_d(r->y, b);
    mpq_mul(r->x, r->x, r->y);
    return settle(r);
}

static double quotient(struct exact_gmp_replay_replay *r, double a, double b)
{
    if (b == 0) {
        r->lost = true;
        return 0;
    }
    mpq_set_d(r->x, a);
    mpq_set_d(r->y, b);
    mpq_div(r->x, r->x, r->y);
    return settle(r);
}

/* a b - c d */
static double minor_of(struct exact_gmp_replay_replay *r, double a, double b, double c, double d)
{
    double first = product(r, a, b);
    return difference(r, first, product(r, c, d));
}

static void cross(struct exact_gmp_replay_replay *r, const double a[3], const double b[3],
                  double out[3])
{
    out[0] = minor_of(r, a[1], b[2], a[2], b[1]);
    out[1] = minor_of(r, a[2], b[0], a[0], b[2]);
    out[2] = minor_of(r, a[0], b[1], a[1], b[0]);
}

static double dot(struct exact_gmp_replay_replay *r, const double a[3], const double b[3])
{
    double x = product(r, a[0], b[0]), y = product(r, a[1], b[1]), z = product(r, a[2], b[2]);
    return sum(r, sum(r, x, y), z);
}

static void divide(struct exact_gmp_replay_replay *r, double t, double u, double v, double by,
                   struct gmp_replay *out)
{
    out->accepted = true;
    out->t = (float)quotient(r, t, by);
    out->u = (float)quotient(r, u, by);
    out->v = (float)quotient(r, v, by);
}

static void moeller_trumbore(struct exact_gmp_replay_replay *r, const struct ray *ray,
                             float v[3][3], double eps, struct gmp_replay *out)
{
    double d[3], e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->dir[k];
        e1[k] = difference(r, (double)v[1][k], (double)v[0][k]);
        e2[k] = difference(r, (double)v[2][k], (double)v[0][k]);
        s[k] = difference(r, (double)ray->org[k], (double)v[0][k]);
    }
    cross(r, d, e2, p);
    cross(r, s, e1, q);
    double det = dot(r, e1, p), u = dot(r, s, p), w = dot(r, d, q), t = dot(r, e2, q);
    double side = det < 0 ? -1 : 1, size = side * det;
    if (size > eps && side * u >= 0 && side * u <= size && side * w >= 0 &&
        sum(r, side * u, side * w) <= size)
        divide(r, t, u, w, det, out);
}

static void woop(struct exact_gmp_replay_replay *r, const struct ray *ray, float v[3][3],
                 struct gmp_replay *out)
{
    struct tri_ray axes = tri_ray_make(ray); /* for kx, ky and kz alone */
    double d[3], x[3], y[3], z[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)ray->dir[k];
    double sx = quotient(r, d[axes.kx], d[axes.kz]), sy = quotient(r, d[axes.ky], d[axes.kz]);
    double sz = quotient(r, 1, d[axes.kz]);
    for (int c = 0; c < 3; c++) {
        double a[3];
        for (int k = 0; k < 3; k++)
            a[k] = difference(r, (double)v[c][k], (double)ray->org[k]);
        x[c] = difference(r, a[axes.kx], product(r, sx, a[axes.kz]));
        y[c] = difference(r, a[axes.ky], product(r, sy, a[axes.kz]));
        z[c] = product(r, sz, a[axes.kz]);
    }
    double w[3];
    bool positive = false, negative = false;
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        w[c] = minor_of(r, x[a], y[b], y[a], x[b]);
        positive |= w[c] > 0;
        negative |= w[c] < 0;
    }
    double det = sum(r, sum(r, w[0], w[1]), w[2]);
    if (!(positive && negative) && det != 0)
        divide(r, dot(r, w, z), w[1], w[2], det, out);
}

static void pluecker(struct exact_gmp_replay_replay *r, const struct ray *ray, float v[3][3],
                     struct gmp_replay *out)
{
    double a[3][3], e[3][3], w[3], n[3], d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->dir[k];
        for (int c = 0; c < 3; c++)
            a[c][k] = difference(r, (double)v[c][k], (double)ray->org[k]);
    }
    bool positive = false, negative = false;
    for (int c = 0; c < 3; c++) {
        int p = (c + 1) % 3, q = (c + 2) % 3;
        double both[3], side[3];
        for (int k = 0; k < 3; k++) {
            both[k] = sum(r, a[p][k], a[q][k]);
            e[c][k] = difference(r, (double)v[q][k], (double)v[p][k]);
        }
        cross(r, both, e[c], side);
        w[c] = dot(r, d, side);
        positive |= w[c] > 0;
        negative |= w[c] < 0;
    }
    cross(r, e[1], e[2], n);
    double det = dot(r, d, n), all = sum(r, sum(r, w[0], w[1]), w[2]);
    if (!(det > 0 && positive && !negative) && !(det < 0 && negative && !positive))
        return;
    out->accepted = true;
    out->t = (float)quotient(r, dot(r, a[0], n), det);
    out->u = (float)quotient(r, w[1], all);
    out->v = (float)quotient(r, w[2], all);
}

/* m[0] x + m[1] y, then m[2] */
static double row_at(struct exact_gmp_replay_replay *r, const double m[3], double x, double y)
{
    double first = product(r, m[0], x);
    return sum(r, sum(r, first, product(r, m[1], y)), m[2]);
}

/* (z + m[0] x) + m[1] y */
static double climb_of(struct exact_gmp_replay_replay *r, const double m[3], double x, double y,
                       double z)
{
    double first = sum(r, z, product(r, m[0], x));
    return sum(r, first, product(r, m[1], y));
}

static void baldwin_webber(struct exact_gmp_replay_replay *r, const struct ray *ray, float v[3][3],
                           struct gmp_replay *out)
{
    double e1[3], e2[3], n[3], v0[3], o[3], d[3], row[3][3];
    for (int k = 0; k < 3; k++) {
        o[k] = (double)ray->org[k];
        d[k] = (double)ray->dir[k];
        v0[k] = (double)v[0][k];
        e1[k] = difference(r, (double)v[1][k], v0[k]);
        e2[k] = difference(r, (double)v[2][k], v0[k]);
    }
    cross(r, e1, e2, n);
    int c = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    c = fabs(n[2]) > fabs(n[c]) ? 2 : c;
    if (n[c] == 0)
        return; /* no area */
    int a = (c + 1) % 3, b = (c + 2) % 3;
    const double from[3][2] = {{e2[b], -e2[a]}, {-e1[b], e1[a]}, {n[a], n[b]}};
    for (int i = 0; i < 3; i++) {
        row[i][0] = quotient(r, from[i][0], n[c]);
        row[i][1] = quotient(r, from[i][1], n[c]);
        row[i][2] = i < 2 ? -sum(r, product(r, row[i][0], v0[a]), product(r, row[i][1], v0[b]))
                          : -climb_of(r, row[i], v0[a], v0[b], v0[c]);
    }
    double height = sum(r, climb_of(r, row[2], o[a], o[b], o[c]), row[2][2]);
    double climb = climb_of(r, row[2], d[a], d[b], d[c]);
    if (climb == 0)
        return;
    double t = quotient(r, -height, climb);
    double x = sum(r, o[a], product(r, t, d[a])), y = sum(r, o[b], product(r, t, d[b]));
    double u = row_at(r, row[0], x, y), w = row_at(r, row[1], x, y);
    out->accepted = u >= 0 && w >= 0 && sum(r, u, w) <= 1;
    out->t = (float)t;
    out->u = (float)u;
    out->v = (float)w;
}

bool exact_gmp_replay(const struct model *model, const struct ray *ray, float v[3][3],
                      struct gmp_replay *out)
{
    static const struct rounding ieee = ROUNDING_IEEE;
    *out = (struct gmp_replay){0};
    if (!model->bits || memcmp(&model->rounding, &ieee, sizeof ieee) != 0)
        return false;
    if (!twin_is_own(model->formula) || model->formula == TWIN_TRI_ACCEL)
        return false;
    struct exact_gmp_replay_replay r = {.lost = false};
    mpq_inits(r.x, r.y, NULL);
    if (model->formula == TWIN_WOOP)
        woop(&r, ray, v, out);
    else if (model->formula == TWIN_PLUECKER)
        pluecker(&r, ray, v, out);
    else if (model->formula == TWIN_BALDWIN_WEBBER)
        baldwin_webber(&r, ray, v, out);
    else
        moeller_trumbore(&r, ray, v, model->formula == TWIN_MT_RTRS ? (double)TRI_RTRS_EPS : 0.0,
                         out);
    mpq_clears(r.x, r.y, NULL);
    return !r.lost;
}

bool exact_gmp_replay_hits(const struct gmp_replay *replay, const struct ray *ray, bool open)
{
    if (!replay->accepted)
        return false;
    return open ? replay->t > ray->tmin && replay->t < ray->tmax
                : replay->t >= ray->tmin && replay->t <= ray->tmax;
}

#include "ref/twin/replay_inner.h"
#include "ref/twin/twin.h"
#include "ref/primitives/test_run.h"

#include <math.h>

#define UNIT 0x1p-24 /* u */
/* Of bounds that are computed in double. */
#define OUTWARD (1.0 + 0x1p-40)
/* How far a weight that Embree cuts off may lie above 1: its band, and roundings. */
#define ABOVE_ONE 0x1p-19
/* Embree's robust test gives u = v = 0 below this sum of edge functions. */
#define LEAST_SUM 1e-18

void replay_subtract(const struct liberty *k, const struct scatter a[3], const struct scatter b[3],
                     struct scatter out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = scatter_sub(k, &a[i], &b[i]);
}

/* a b - c d */
static struct scatter minor(const struct liberty *k, const struct scatter *a,
                            const struct scatter *b, const struct scatter *c,
                            const struct scatter *d)
{
    struct scatter ab = scatter_mul(k, a, b), cd = scatter_mul(k, c, d);
    return scatter_sub(k, &ab, &cd);
}

void replay_cross(const struct liberty *k, const struct scatter a[3], const struct scatter b[3],
                  struct scatter out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = minor(k, &a[(i + 1) % 3], &b[(i + 2) % 3], &a[(i + 2) % 3], &b[(i + 1) % 3]);
}

/* (x + y) + z, of the axes in this order. */
static struct scatter dot_in_order(const struct liberty *k, const struct scatter a[3],
                                   const struct scatter b[3], int x, int y, int z)
{
    struct scatter px = scatter_mul(k, &a[x], &b[x]), py = scatter_mul(k, &a[y], &b[y]);
    struct scatter pz = scatter_mul(k, &a[z], &b[z]), sum = scatter_add(k, &px, &py);
    return scatter_add(k, &sum, &pz);
}

static struct scatter dot(const struct liberty *k, const struct scatter a[3],
                          const struct scatter b[3])
{
    return dot_in_order(k, a, b, 0, 1, 2);
}

static struct scatter dot_embree(const struct liberty *k, const struct scatter a[3],
                                 const struct scatter b[3])
{
    return dot_in_order(k, a, b, 1, 2, 0);
}

static struct scatter sum_of(const struct liberty *k, const struct scatter w[3])
{
    struct scatter two = scatter_add(k, &w[0], &w[1]);
    return scatter_add(k, &two, &w[2]);
}

struct quotients replay_quotients(const struct replay *w, struct scatter divisor)
{
    const struct rounding *r = &w->k->rounding;
    return (struct quotients){.divisor = divisor,
                              .estimated = r->div > 1.0,
                              /* A quotient, or a product with a reciprocal. */
                              .share = (r->div + r->mul) * UNIT * OUTWARD,
                              .tiny = 2.0 * r->tiny,
                              .mean_lo = -INFINITY,
                              .mean_hi = INFINITY,
                              .pad = INFINITY};
}

void replay_part(const struct replay *w, struct quotients *s, struct scatter number, int which)
{
    s->part[s->parts++] =
        (struct quotients_part){number, w->answer->lo[which], w->answer->hi[which]};
}

bool replay_weights(const struct replay *w, const struct scatter *divisor, double band)
{
    const struct rounding *r = &w->k->rounding;
    double slip = (2.0 * r->add + 2.0 * (r->div + r->mul)) * UNIT * OUTWARD;
    band += 4.0 * r->tiny + 4.0 * r->tiny / scatter_least(divisor);
    slip += band;
    const struct replay_answer *a = w->answer;
    return a->hi[1] >= -band && a->hi[2] >= -band && a->lo[1] + a->lo[2] <= 1.0 + 2.0 * slip;
}

static bool moeller_trumbore(const struct replay *w, double above)
{
    const struct liberty *k = w->k;
    struct scatter e1[3], e2[3], s[3], p[3], q[3];
    replay_subtract(k, w->v[1], w->v[0], e1);
    replay_subtract(k, w->v[2], w->v[0], e2);
    replay_subtract(k, w->o, w->v[0], s);
    replay_cross(k, w->d, e2, p);
    replay_cross(k, s, e1, q);
    struct quotients all = replay_quotients(w, dot(k, e1, p));
    all.above = above;
    if (scatter_is_zero(&all.divisor) || !replay_weights(w, &all.divisor, 0.0))
        return false;
    replay_part(w, &all, dot(k, e2, q), 0);
    replay_part(w, &all, dot(k, s, p), 1);
    replay_part(w, &all, dot(k, w->d, q), 2);
    return quotients_fit_either(&all);
}

/* Embree's default test: the same numbers in another order, and a reciprocal. */
static struct scatter embree_normal(const struct replay *w, struct scatter e1[3],
                                    struct scatter e2[3], struct scatter n[3])
{
    replay_subtract(w->k, w->v[0], w->v[1], e1);
    replay_subtract(w->k, w->v[2], w->v[0], e2);
    replay_cross(w->k, e2, e1, n);
    return dot_embree(w->k, n, w->d);
}

static bool embree(const struct replay *w)
{
    const struct liberty *k = w->k;
    struct scatter e1[3], e2[3], n[3], c[3], r[3];
    struct quotients all = replay_quotients(w, embree_normal(w, e1, e2, n));
    if (scatter_is_zero(&all.divisor) || !replay_weights(w, &all.divisor, 0.0))
        return false;
    replay_subtract(k, w->v[0], w->o, c);
    replay_cross(k, c, w->d, r);
    replay_part(w, &all, dot_embree(k, n, c), 0);
    replay_part(w, &all, dot_embree(k, r, e2), 1);
    replay_part(w, &all, dot_embree(k, r, e1), 2);
    return quotients_fit_either(&all);
}

/* Woop's t is a mean of the vertices' depths, since the weights that it accepts have one sign: with
 * w_c the weights, z_c the depths, Z the largest of them and L_c = |w_c| / sum |w|,
 *   t (1 + r) = sum w z (1 + p) / sum w (1 + q),  |p| <= (k* + 2 k+) u, |q| <= 2 k+ u
 * so |t - sum L z| <= (k* + 4 k+ + k/) u Z, and u and v differ from L_1 and L_2 by (2 k+ + k/) u,
 * 1 - u - v from L_0 by twice that. Each of the 6 sums and 3 products may lose tiny besides. */
static void depths(const struct replay *w, const struct scatter z[3], struct quotients *out)
{
    const struct rounding *r = &w->k->rounding;
    const struct replay_answer *a = w->answer;
    double most = 0.0, lo = INFINITY, hi = -INFINITY, quotient = r->div + r->mul;
    for (int c = 0; c < 3; c++) {
        lo = fmin(lo, z[c].lo);
        hi = fmax(hi, z[c].hi);
        most = fmax(most, fmax(fabs(z[c].lo), fabs(z[c].hi)));
    }
    if (a->lo[1] == a->hi[1] && a->lo[2] == a->hi[2]) {
        double u = a->lo[1], v = a->lo[2], weight[3] = {1.0 - u - v, u, v}, from = 0.0, to = 0.0;
        for (int c = 0; c < 3; c++) {
            from += fmin(weight[c] * z[c].lo, weight[c] * z[c].hi);
            to += fmax(weight[c] * z[c].lo, weight[c] * z[c].hi);
        }
        lo = fmax(lo, from);
        hi = fmin(hi, to);
    }
    double slip = (r->mul + 4.0 * r->add + quotient + 4.0 * (2.0 * r->add + quotient)) * UNIT;
    out->mean_lo = lo - slip * (1.0 + 0x1p-10) * most;
    out->mean_hi = hi + slip * (1.0 + 0x1p-10) * most;
    out->pad = 16.0 * r->tiny * (1.0 + most);
}

/* Axes are in the order of the formula (twin_axes). Edge functions are not contracted
 * (ref/primitives/ tri.h), so that x y - y x of equal vertices is 0. */
static bool woop(const struct replay *w)
{
    const struct liberty *k = w->k, rounded = {k->rounding, false};
    struct scatter x[3], y[3], z[3], weight[3], one = scatter_single(1.0);
    struct scatter sx = scatter_div(k, &w->d[0], &w->d[2]), sy = scatter_div(k, &w->d[1], &w->d[2]);
    struct scatter sz = scatter_div(k, &one, &w->d[2]);
    for (int c = 0; c < 3; c++) {
        struct scatter a[3];
        replay_subtract(k, w->v[c], w->o, a);
        struct scatter far_x = scatter_mul(k, &sx, &a[2]), far_y = scatter_mul(k, &sy, &a[2]);
        x[c] = scatter_sub(k, &a[0], &far_x);
        y[c] = scatter_sub(k, &a[1], &far_y);
        z[c] = scatter_mul(&rounded, &sz, &a[2]); /* added to nothing */
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        weight[c] = w->same[c] ? scatter_single(0.0) : minor(k, &x[a], &y[b], &y[a], &x[b]);
    }
    struct quotients all = replay_quotients(w, sum_of(k, weight));
    if (scatter_is_zero(&all.divisor) || !replay_weights(w, &all.divisor, 0.0))
        return false;
    replay_part(w, &all, dot(k, weight, z), 0);
    replay_part(w, &all, weight[1], 1);
    replay_part(w, &all, weight[2], 2);
    depths(w, z, &all);
    return quotients_fit_either(&all);
}

/* t has a divisor of its own, of the sign of the other. */
static bool pluecker(const struct replay *w)
{
    const struct liberty *k = w->k;
    struct scatter a[3][3], e[3][3], sum[3], side[3], weight[3], n[3];
    for (int c = 0; c < 3; c++)
        replay_subtract(k, w->v[c], w->o, a[c]);
    for (int c = 0; c < 3; c++) {
        int p = (c + 1) % 3, q = (c + 2) % 3;
        replay_subtract(k, w->v[q], w->v[p], e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = scatter_add(k, &a[p][i], &a[q][i]);
        replay_cross(k, sum, e[c], side);
        weight[c] = dot(k, w->d, side);
    }
    replay_cross(k, e[1], e[2], n);
    struct quotients depth = replay_quotients(w, dot(k, w->d, n)),
                     weights = replay_quotients(w, sum_of(k, weight));
    if (scatter_is_zero(&depth.divisor) || !replay_weights(w, &weights.divisor, 0.0))
        return false;
    replay_part(w, &depth, dot(k, a[0], n), 0);
    replay_part(w, &weights, weight[1], 1);
    replay_part(w, &weights, weight[2], 2);
    return (quotients_fit(&depth, false) && quotients_fit(&weights, false)) ||
           (quotients_fit(&depth, true) && quotients_fit(&weights, true));
}

/* A component of Embree's normal: by either pair of edges. */
static struct scatter stable(const struct liberty *k, struct scatter e[3][3], int i)
{
    int j = (i + 1) % 3, l = (i + 2) % 3;
    struct scatter one = minor(k, &e[0][j], &e[1][l], &e[0][l], &e[1][j]);
    struct scatter two = minor(k, &e[1][j], &e[2][l], &e[1][l], &e[2][j]);
    return scatter_either(&one, &two);
}

/* Weights are accepted within a band on the other side, and are 0 where their sum is. */
static bool embree_robust(const struct replay *w)
{
    const struct liberty *k = w->k;
    struct scatter a[3][3], e[3][3], sum[3], side[3], edge[3], n[3];
    for (int c = 0; c < 3; c++)
        replay_subtract(k, w->v[c], w->o, a[c]);
    for (int c = 0; c < 3; c++) {
        int from = (c + 2) % 3;
        replay_subtract(k, a[from], a[c], e[c]);
        if (w->same[(c + 1) % 3])
            e[c][0] = e[c][1] = e[c][2] = scatter_single(0.0);
        for (int i = 0; i < 3; i++)
            sum[i] = scatter_add(k, &a[from][i], &a[c][i]);
        replay_cross(k, e[c], sum, side);
        edge[c] = dot_embree(k, side, w->d);
    }
    for (int i = 0; i < 3; i++)
        n[i] = stable(k, e, i);
    struct quotients depth = replay_quotients(w, dot_embree(k, n, w->d));
    if (scatter_is_zero(&depth.divisor))
        return false;
    replay_part(w, &depth, dot_embree(k, a[0], n), 0);
    if (!quotients_fit_either(&depth))
        return false;
    struct quotients weights = replay_quotients(w, sum_of(k, edge));
    replay_part(w, &weights, edge[0], 1);
    replay_part(w, &weights, edge[1], 2);
    bool none = w->answer->lo[1] <= 0.0 && w->answer->lo[2] <= 0.0 && w->answer->hi[1] >= 0.0 &&
                w->answer->hi[2] >= 0.0 && weights.divisor.lo < LEAST_SUM &&
                weights.divisor.hi > -LEAST_SUM;
    return none || (replay_weights(w, &weights.divisor, 2.0 * EMBREE_BAND) &&
                    quotients_fit_either(&weights));
}

/* --- the entries ------------------------------------------------------------------------------ */

static bool equal(float v[3][3], int a, int b)
{
    return v[a][0] == v[b][0] && v[a][1] == v[b][1] && v[a][2] == v[b][2];
}

void replay_vertices(struct replay *w, const int axis[3], float v[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 3; c++)
            w->v[c][i] = scatter_of(v[c][axis[i]]);
        w->same[i] = equal(v, (i + 1) % 3, (i + 2) % 3);
    }
}

static void fill(struct replay *w, enum twin_formula formula, const struct ray *ray, float v[3][3])
{
    int axis[3];
    twin_axes(formula, ray, axis);
    for (int i = 0; i < 3; i++) {
        w->o[i] = scatter_of(ray->org[axis[i]]);
        w->d[i] = scatter_of(ray->dir[axis[i]]);
    }
    replay_vertices(w, axis, v);
}

bool replay_formula(struct replay *given, enum twin_formula formula)
{
    struct replay_answer kept = *given->answer;
    struct replay w = *given;
    w.answer = &kept;
    switch (formula) {
    case TWIN_MT:
        return moeller_trumbore(&w, 0.0);
    case TWIN_MT_RTRS:
        return moeller_trumbore(&w, (double)TRI_RTRS_EPS);
    case TWIN_WOOP:
        return woop(&w);
    case TWIN_PLUECKER:
        return pluecker(&w);
    case TWIN_BALDWIN_WEBBER:
    case TWIN_TRI_ACCEL:
        return replay_baldwin_webber(&w, formula == TWIN_TRI_ACCEL);
    case TWIN_EMBREE:
    case TWIN_EMBREE_ROBUST:
        for (int i = 1; i < 3; i++) /* it answers no weight above 1; of any answer, its band */
            if (kept.hi[i] == 1.0) {
                kept.lo[i] -= kept.lo[i] == 0.0 ? ABOVE_ONE : 0.0;
                kept.hi[i] += ABOVE_ONE;
            }
        return formula == TWIN_EMBREE ? embree(&w) : embree_robust(&w);
    case TWIN_UNKNOWN:
        break;
    }
    return true;
}

bool replay_can_answer(enum twin_formula formula, const struct liberty *liberty,
                       const struct ray *ray, float v[3][3], const struct replay_answer *answer)
{
    struct replay w = {.k = liberty, .answer = answer};
    fill(&w, formula, ray, v);
    return replay_formula(&w, formula);
}

double replay_least_det(const struct liberty *liberty, const struct ray *ray, float v[3][3])
{
    struct replay w = {.k = liberty};
    struct scatter e1[3], e2[3], n[3];
    fill(&w, TWIN_EMBREE, ray, v);
    struct scatter det = embree_normal(&w, e1, e2, n);
    return scatter_least(&det);
}

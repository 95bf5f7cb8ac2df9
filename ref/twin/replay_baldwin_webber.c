/* The replay of baldwin_webber and tri_accel: t is a quotient, and u and v are those of the point
 * at the very t that is answered. */
#include "ref/twin/replay_inner.h"

#include <math.h>

/* Divisors of the transform that are tried one by one. */
#define AXIS_MOST 256.0

static bool meets(const struct scatter *s, double lo, double hi)
{
    for (int i = 0; i < s->count; i++)
        if (s->value[i] >= lo && s->value[i] <= hi)
            return true;
    return s->count == 0 && s->hi >= lo && s->lo <= hi;
}

/* m[0] p[a] + m[1] p[b] + m[2] of the answered point, m[0] and m[1] being over `divisor`. */
static struct scatter weight_at(const struct replay *w, const struct scatter *by_a,
                                const struct scatter *by_b, const struct scatter *divisor, int a,
                                int b, const struct scatter at[2])
{
    const struct liberty *k = w->k;
    struct scatter m0 = scatter_div(k, by_a, divisor), m1 = scatter_div(k, by_b, divisor);
    struct scatter ra = scatter_mul(k, &m0, &w->v[0][a]), rb = scatter_mul(k, &m1, &w->v[0][b]);
    struct scatter last = scatter_add(k, &ra, &rb);
    struct scatter pa = scatter_mul(k, &m0, &at[0]), pb = scatter_mul(k, &m1, &at[1]);
    struct scatter sum = scatter_add(k, &pa, &pb);
    return scatter_sub(k, &sum, &last);
}

/* (p[c] + h[0] p[a]) + h[1] p[b] */
static struct scatter along_normal(const struct liberty *k, const struct scatter h[2],
                                   const struct scatter p[3], int a, int b, int c)
{
    struct scatter by_a = scatter_mul(k, &h[0], &p[a]), by_b = scatter_mul(k, &h[1], &p[b]);
    struct scatter sum = scatter_add(k, &p[c], &by_a);
    return scatter_add(k, &sum, &by_b);
}

/* The plane's constant less the origin's height, which tri_accel takes off term by term. */
static struct scatter above_origin(const struct replay *w, const struct scatter h[2], int a, int b,
                                   int c, bool accel)
{
    const struct liberty *k = w->k;
    struct scatter of_v = along_normal(k, h, w->v[0], a, b, c);
    if (!accel) {
        struct scatter of_o = along_normal(k, h, w->o, a, b, c);
        return scatter_sub(k, &of_v, &of_o);
    }
    struct scatter by_a = scatter_mul(k, &h[0], &w->o[a]), by_b = scatter_mul(k, &h[1], &w->o[b]);
    struct scatter part = scatter_sub(k, &of_v, &w->o[c]);
    part = scatter_sub(k, &part, &by_a);
    return scatter_sub(k, &part, &by_b);
}

static bool along_axis(const struct replay *w, const struct scatter e1[3],
                       const struct scatter e2[3], const struct scatter n[3], int c,
                       const struct scatter *divisor, bool accel)
{
    const struct liberty *k = w->k;
    const struct replay_answer *answer = w->answer;
    int a = (c + 1) % 3, b = (c + 2) % 3;
    const struct scatter h[2] = {scatter_div(k, &n[a], divisor), scatter_div(k, &n[b], divisor)};
    struct scatter climb = along_normal(k, h, w->d, a, b, c);
    struct quotients depth = replay_quotients(w, climb);
    replay_part(w, &depth, above_origin(w, h, a, b, c, accel), 0);
    if (scatter_is_zero(&climb) || !quotients_fit_either(&depth))
        return false;
    struct scatter t = {.lo = answer->lo[0], .hi = answer->hi[0], .grid = -149}, at[2];
    if (t.lo == t.hi)
        t = scatter_single(t.lo);
    struct scatter ta = scatter_mul(k, &t, &w->d[a]), tb = scatter_mul(k, &t, &w->d[b]);
    at[0] = scatter_add(k, &w->o[a], &ta);
    at[1] = scatter_add(k, &w->o[b], &tb);
    struct scatter less_a = scatter_negate(&e2[a]), less_b = scatter_negate(&e1[b]);
    struct scatter u = weight_at(w, &e2[b], &less_a, divisor, a, b, at);
    struct scatter v = weight_at(w, &less_b, &e1[a], divisor, a, b, at);
    return meets(&u, answer->lo[1], answer->hi[1]) && meets(&v, answer->lo[2], answer->hi[2]);
}

/* All divisors that the component may be, one by one while they are few. */
static bool by_axis(const struct replay *w, const struct scatter e1[3], const struct scatter e2[3],
                    const struct scatter n[3], int c, bool accel)
{
    const struct scatter *all = &n[c];
    for (int i = 0; i < all->count; i++) {
        struct scatter one = scatter_single(all->value[i]);
        if (all->value[i] != 0.0 && along_axis(w, e1, e2, n, c, &one, accel))
            return true;
    }
    if (all->count)
        return false;
    if (all->lo > 0.0 || all->hi < 0.0)
        return along_axis(w, e1, e2, n, c, all, accel);
    double from = ceil(ldexp(all->lo, -all->grid)), to = floor(ldexp(all->hi, -all->grid));
    if (!(to - from <= AXIS_MOST))
        return true;
    for (double i = from; i <= to; i++) {
        struct scatter one = scatter_single(ldexp(i, all->grid));
        if (i != 0.0 && along_axis(w, e1, e2, n, c, &one, accel))
            return true;
    }
    return false;
}

bool replay_baldwin_webber(const struct replay *w, bool accel)
{
    struct scatter e1[3], e2[3], n[3];
    double least = 0.0; /* of the largest component */
    replay_subtract(w->k, w->v[1], w->v[0], e1);
    replay_subtract(w->k, w->v[2], w->v[0], e2);
    replay_cross(w->k, e1, e2, n);
    struct scatter one = scatter_single(1.0);
    if (!replay_weights(w, &one, 0.0))
        return false;
    for (int c = 0; c < 3; c++)
        if (!scatter_has_zero(&n[c]))
            least = fmax(least, scatter_least(&n[c]));
    for (int c = 0; c < 3; c++)
        if (!scatter_is_zero(&n[c]) && fmax(-n[c].lo, n[c].hi) >= least &&
            by_axis(w, e1, e2, n, c, accel))
            return true;
    return false;
}

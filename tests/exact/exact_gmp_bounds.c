#include "tests/exact/exact_gmp_bounds.h"

#include "ref/base/base.h"
#include "ref/primitives/tri.h"
#include "tests/exact/exact_gmp_known.h"

#include <math.h>

/* What the formulas work with. */
struct given {
    struct vec o, d, v[3];
    struct vec a, b, c;  /* differences */
    struct known t;      /* the numerator of t */
    struct known top[2]; /* those of u and v */
    struct known sum;    /* their denominator */
    bool summed;         /* they are not of what t has */
    bool reciprocal;
};

/* edge 0 = det - fl(edge 1 + edge 2), compared, so not rounded itself. */
static void third_edge(const struct unit *unit, struct gmp_bounds *out)
{
    const struct known *one = &out->edge[1], *two = &out->edge[2], *det = &out->det;
    set_zero(&out->edge[0]);
    add_product(unit, &out->edge[0], -1, 1, 1, &one);
    add_product(unit, &out->edge[0], -1, 1, 1, &two);
    add_product(unit, &out->edge[0], 1, 0, 1, &det);
    mpq_add(out->edge[0].e, out->edge[0].e, unit->tiny);
}

static void moeller_trumbore(const struct unit *unit, struct given *in, struct gmp_bounds *out)
{
    struct vec *e1 = &in->a, *e2 = &in->b, *s = &in->c;
    vec_difference(unit, &in->v[1], &in->v[0], e1);
    vec_difference(unit, &in->v[2], &in->v[0], e2);
    vec_difference(unit, &in->o, &in->v[0], s);
    triple(unit, e1, &in->d, e2, &out->det);
    triple(unit, s, &in->d, e2, &out->edge[1]);
    triple(unit, &in->d, s, e1, &out->edge[2]);
    triple(unit, e2, s, e1, &in->t);
    third_edge(unit, out);
}

/* fl(a + b) */
static void vec_sum(const struct unit *unit, const struct vec *a, const struct vec *b,
                    struct vec *out)
{
    for (int i = 0; i < 3; i++) {
        const struct known *x = &a->k[i], *y = &b->k[i];
        set_zero(&out->k[i]);
        add_product(unit, &out->k[i], 1, 1, 1, &x);
        add_product(unit, &out->k[i], 1, 1, 1, &y);
    }
}

/* u and v are divided by the sum of the sides, which must be known to be none of 0 as well. */
static void pluecker(const struct unit *unit, struct given *in, struct gmp_bounds *out)
{
    struct vec *rel[3] = {&in->a, &in->b, &in->c}, edge[3], sum;
    vec_init(&sum);
    for (int c = 0; c < 3; c++)
        vec_difference(unit, &in->v[c], &in->o, rel[c]);
    for (int c = 0; c < 3; c++) {
        int p = (c + 1) % 3, q = (c + 2) % 3;
        vec_init(&edge[c]);
        vec_difference(unit, &in->v[q], &in->v[p], &edge[c]);
        vec_sum(unit, rel[p], rel[q], &sum);
        triple(unit, &in->d, &sum, &edge[c], &out->edge[c]);
    }
    triple(unit, &in->d, &edge[1], &edge[2], &out->det);
    triple(unit, rel[0], &edge[1], &edge[2], &in->t);
    set_zero(&in->sum);
    for (int c = 0; c < 3; c++) {
        const struct known *one = &out->edge[c];
        add_product(unit, &in->sum, 1, 2, 1, &one);
    }
    mpq_add(in->sum.e, in->sum.e, unit->tiny);
    known_copy(&in->top[0], &out->edge[1]);
    known_copy(&in->top[1], &out->edge[2]);
    in->summed = true;
    for (int c = 0; c < 3; c++)
        vec_clear(&edge[c]);
    vec_clear(&sum);
}

static void embree(const struct unit *unit, struct given *in, struct gmp_bounds *out)
{
    struct vec *e1 = &in->a, *e2 = &in->b, *c = &in->c;
    vec_difference(unit, &in->v[0], &in->v[1], e1);
    vec_difference(unit, &in->v[2], &in->v[0], e2);
    vec_difference(unit, &in->v[0], &in->o, c);
    triple(unit, &in->d, e2, e1, &out->det);
    triple(unit, e2, c, &in->d, &out->edge[1]);
    triple(unit, e1, c, &in->d, &out->edge[2]);
    triple(unit, c, e2, e1, &in->t);
    third_edge(unit, out);
    in->reciprocal = true;
}

/* Embree's edge c, from vertex c + 2 to vertex c, is opposite vertex c + 1. Its normal's components
 * are a x b or b x c of the edges; the larger bound covers both. */
static void embree_robust(const struct unit *unit, struct given *in, struct gmp_bounds *out)
{
    struct vec *rel[3] = {&in->a, &in->b, &in->c}, edge[3], sum;
    for (int c = 0; c < 3; c++) {
        vec_init(&edge[c]);
        vec_difference(unit, &in->v[c], &in->o, rel[c]);
    }
    vec_init(&sum);
    for (int c = 0; c < 3; c++) {
        const struct vec *from = rel[(c + 2) % 3];
        vec_difference(unit, from, rel[c], &edge[c]);
        vec_sum(unit, from, rel[c], &sum);
        triple(unit, &in->d, &edge[c], &sum, &out->edge[(c + 1) % 3]);
    }
    set_zero(&in->sum);
    for (int c = 0; c < 3; c++) {
        const struct known *one = &out->edge[c];
        add_product(unit, &in->sum, 1, 2, 1, &one);
    }
    /* 2^-23 of the computed sum, with room for its rounding. */
    mpq_abs(out->band, in->sum.v);
    mpq_add(out->band, out->band, in->sum.e);
    mpq_div_2exp(out->band, out->band, 23);
    mpq_mul(out->band, out->band, unit->step);
    mpq_add(out->band, out->band, unit->tiny);
    struct known det, t;
    known_init(&det);
    known_init(&t);
    triple(unit, &in->d, &edge[0], &edge[1], &out->det);
    triple(unit, &in->d, &edge[1], &edge[2], &det);
    triple(unit, rel[0], &edge[0], &edge[1], &in->t);
    triple(unit, rel[0], &edge[1], &edge[2], &t);
    /* Component by component either: each bound holds for its own terms, the sum of both for any
     * mixture. */
    mpq_add(out->det.e, out->det.e, det.e);
    mpq_add(in->t.e, in->t.e, t.e);
    known_clear(&det);
    known_clear(&t);
    out->det_alone = true;
    in->summed = true;
    in->reciprocal = true;
    known_copy(&in->top[0], &out->edge[1]); /* Embree's edge 0 */
    known_copy(&in->top[1], &out->edge[2]);
    for (int c = 0; c < 3; c++)
        vec_clear(&edge[c]);
    vec_clear(&sum);
}

/* Axes as ref/primitives/tri.h: kz the largest of |d|, kx and ky swapped if d[kz] < 0. */
static void woop(const struct unit *unit, const struct ray *ray, struct given *in,
                 struct gmp_bounds *out)
{
    struct tri_ray r = tri_ray_make(ray);
    struct known shear[3], one, x[3], y[3], z[3];
    const int axis[2] = {r.kx, r.ky};
    known_init(&one);
    mpq_set_si(one.v, 1, 1);
    for (int i = 0; i < 3; i++) {
        known_init(&shear[i]);
        known_init(&x[i]);
        known_init(&y[i]);
        known_init(&z[i]);
        quotient(unit, i < 2 ? &in->d.k[axis[i]] : &one, &in->d.k[r.kz], false, &shear[i]);
    }
    for (int c = 0; c < 3; c++) {
        struct known *moved[2] = {&x[c], &y[c]};
        vec_difference(unit, &in->v[c], &in->o, &in->a);
        const struct known *depth = &in->a.k[r.kz];
        for (int i = 0; i < 2; i++) {
            const struct known *side = &in->a.k[axis[i]];
            const struct known *term[2] = {&shear[i], depth};
            set_zero(moved[i]);
            add_product(unit, moved[i], 1, 1, 1, &side);
            add_product(unit, moved[i], -1, 2, 2, term);
            mpq_add(moved[i]->e, moved[i]->e, unit->tiny);
        }
        const struct known *term[2] = {&shear[2], depth};
        set_zero(&z[c]);
        add_product(unit, &z[c], 1, 1, 2, term);
    }
    set_zero(&out->det);
    set_zero(&in->t);
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        const struct known *plus[3] = {&x[a], &y[b], &z[c]}, *minus[3] = {&y[a], &x[b], &z[c]};
        set_zero(&out->edge[c]);
        add_product(unit, &out->edge[c], 1, 2, 2, plus);
        add_product(unit, &out->edge[c], -1, 2, 2, minus);
        add_product(unit, &out->det, 1, 4, 2, plus);
        add_product(unit, &out->det, -1, 4, 2, minus);
        add_product(unit, &in->t, 1, 5, 3, plus);
        add_product(unit, &in->t, -1, 5, 3, minus);
        mpq_add(out->edge[c].e, out->edge[c].e, unit->tiny);
    }
    mpq_add(out->det.e, out->det.e, unit->tiny);
    mpq_add(in->t.e, in->t.e, unit->tiny);
    known_clear(&one);
    for (int i = 0; i < 3; i++) {
        known_clear(&shear[i]);
        known_clear(&x[i]);
        known_clear(&y[i]);
        known_clear(&z[i]);
    }
}

/* 1 + k * 2^-24 */
static void set_step(mpq_t out, double k)
{
    mpq_set_d(out, 1.0 + k * 0x1p-24); /* exact: k is a small multiple of 1/2 */
}

/* The largest |input| plus 1, and plus 1 / |largest d| where a formula divides by it: then *depth,
 * by which one factor of the numerator of t is larger than the other numbers, else 1. */
static double largest_of(const struct ray *ray, float v[3][3], bool divides, double *depth)
{
    double largest = 0, direction = 0;
    for (int k = 0; k < 3; k++) {
        direction = fmax(direction, fabs((double)ray->dir[k]));
        largest = fmax(largest, fabs((double)ray->org[k]));
        for (int c = 0; c < 3; c++)
            largest = fmax(largest, fabs((double)v[c][k]));
    }
    largest = 2 * largest + 1; /* of differences */
    *depth = divides ? fmax(1 / direction, 1) : 1;
    return fmax(largest, divides ? fmax(1 / direction, direction) : direction) + 1;
}

static bool is_near(const struct known *divisor)
{
    mpq_t least;
    mpq_init(least);
    mpq_abs(least, divisor->v);
    mpq_sub(least, least, divisor->e);
    double x = mpq_get_d(least);
    mpq_clear(least);
    return !(x > 0x1p-120 && x < 0x1p120);
}

void gmp_bounds_init(struct gmp_bounds *bounds)
{
    for (int c = 0; c < 3; c++)
        known_init(&bounds->edge[c]);
    known_init(&bounds->det);
    known_init(&bounds->t);
    known_init(&bounds->u);
    known_init(&bounds->v);
    mpq_init(bounds->band);
}

void gmp_bounds_clear(struct gmp_bounds *bounds)
{
    for (int c = 0; c < 3; c++)
        known_clear(&bounds->edge[c]);
    known_clear(&bounds->det);
    known_clear(&bounds->t);
    known_clear(&bounds->u);
    known_clear(&bounds->v);
    mpq_clear(bounds->band);
}

/* t, u and v, where the divisors are surely not 0 and within what a division promises. */
static void divide_all(const struct unit *unit, struct given *in, struct gmp_bounds *out)
{
    if (!in->summed) {
        known_copy(&in->top[0], &out->edge[1]);
        known_copy(&in->top[1], &out->edge[2]);
        known_copy(&in->sum, &out->det);
    }
    out->divided = !is_near(&out->det) && !is_near(&in->sum);
    if (!out->divided)
        return;
    quotient(unit, &in->t, &out->det, in->reciprocal, &out->t);
    quotient(unit, &in->top[0], &in->sum, in->reciprocal, &out->u);
    quotient(unit, &in->top[1], &in->sum, in->reciprocal, &out->v);
}

static void given_each(struct given *in, void (*vec)(struct vec *), void (*known)(struct known *))
{
    struct vec *const vecs[] = {&in->o,    &in->d, &in->v[0], &in->v[1],
                                &in->v[2], &in->a, &in->b,    &in->c};
    for (size_t i = 0; i < ARRAY_COUNT(vecs); i++)
        vec(vecs[i]);
    known(&in->t);
    known(&in->top[0]);
    known(&in->top[1]);
    known(&in->sum);
}

void gmp_bounds_of(const struct model *model, const struct ray *ray, float v[3][3],
                   struct gmp_bounds *out)
{
    const struct rounding *rounding = &model->rounding;
    bool divides = model->formula == TWIN_WOOP;
    double depth, largest = largest_of(ray, v, divides, &depth);
    bool accel = model->formula == TWIN_TRI_ACCEL;
    bool by_map = accel || model->formula == TWIN_BALDWIN_WEBBER;
    struct unit unit;
    struct given in = {.summed = false, .reciprocal = false};
    out->divided = out->det_alone = false;
    out->threshold = model->formula == TWIN_MT_RTRS ? (double)TRI_RTRS_EPS : 0.0;
    /* Products of three, six of them, and room for doubling. */
    out->none = !(64 * depth * largest * largest * largest < 0x1p126);
    if (out->none)
        return;
    given_each(&in, vec_init, known_init);
    mpq_inits(unit.step, unit.quotient, unit.tiny, NULL);
    set_step(unit.step, fmax(rounding->add, rounding->mul));
    set_step(unit.quotient, rounding->div);
    /* Fewer than 100 operations, each off by at most 3 tiny (two operands, one result), each then
     * multiplied by at most three numbers of size `largest`, in at most 4 terms. */
    mpq_set_d(unit.tiny, 4096 * rounding->tiny * largest * largest * largest);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(in.o.k[k].v, (double)ray->org[k]);
        mpq_set_d(in.d.k[k].v, (double)ray->dir[k]);
        for (int c = 0; c < 3; c++)
            mpq_set_d(in.v[c].k[k].v, (double)v[c][k]);
    }
    mpq_set_si(out->band, 0, 1);
    if (model->formula == TWIN_WOOP)
        woop(&unit, ray, &in, out);
    else if (model->formula == TWIN_PLUECKER)
        pluecker(&unit, &in, out);
    else if (by_map)
        out->none =
            !(out->divided = gmp_bounds_baldwin_webber(&unit, &in.o, &in.d, in.v, accel, out));
    else if (model->formula == TWIN_EMBREE)
        embree(&unit, &in, out);
    else if (model->formula == TWIN_EMBREE_ROBUST)
        embree_robust(&unit, &in, out);
    else
        moeller_trumbore(&unit, &in, out);
    if (!by_map) /* divides first */
        divide_all(&unit, &in, out);
    given_each(&in, vec_clear, known_clear);
    mpq_clears(unit.step, unit.quotient, unit.tiny, NULL);
}

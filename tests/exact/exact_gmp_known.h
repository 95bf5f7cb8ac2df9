/* Exact values with a bound on what a computed one may be off by; the arithmetic of
 * tests/exact/exact_gmp_bounds.c. */
#ifndef EXACT_GMP_KNOWN_H
#define EXACT_GMP_KNOWN_H

#include "tests/exact/exact_gmp_bounds.h"

/* Roundings of one kind, as rationals. */
struct unit {
    mpq_t step;     /* 1 + k u of additions and multiplications, the larger k of both */
    mpq_t quotient; /* 1 + k u of a division or reciprocal */
    mpq_t tiny;     /* what subnormals may lose in a whole formula */
};

struct vec {
    struct known k[3];
};

static inline void known_init(struct known *known)
{
    mpq_inits(known->v, known->e, NULL);
}

static inline void known_clear(struct known *known)
{
    mpq_clears(known->v, known->e, NULL);
}

static inline void vec_init(struct vec *vec)
{
    for (int i = 0; i < 3; i++)
        known_init(&vec->k[i]);
}

static inline void vec_clear(struct vec *vec)
{
    for (int i = 0; i < 3; i++)
        known_clear(&vec->k[i]);
}

/* out *= by^n */
static inline void times_power(mpq_t out, const mpq_t by, int n)
{
    for (int i = 0; i < n; i++)
        mpq_mul(out, out, by);
}

/* Adds sign * product of `count` factors that goes through n more roundings to *sum. */
static inline void add_product(const struct unit *unit, struct known *sum, int sign, int n,
                               int count, const struct known *const *factor)
{
    mpq_t value, size, one;
    mpq_inits(value, size, one, NULL);
    mpq_set_si(value, sign, 1);
    mpq_set_si(size, 1, 1);
    for (int i = 0; i < count; i++) {
        mpq_mul(value, value, factor[i]->v);
        mpq_abs(one, factor[i]->v);
        mpq_add(one, one, factor[i]->e);
        mpq_mul(size, size, one);
    }
    times_power(size, unit->step, n);
    mpq_add(sum->v, sum->v, value);
    mpq_abs(value, value);
    mpq_sub(size, size, value);
    mpq_add(sum->e, sum->e, size);
    mpq_clears(value, size, one, NULL);
}

static inline void set_zero(struct known *known)
{
    mpq_set_si(known->v, 0, 1);
    mpq_set_si(known->e, 0, 1);
}

/* fl(a - b) */
static inline void difference(const struct unit *unit, const struct known *a, const struct known *b,
                              struct known *out)
{
    set_zero(out);
    add_product(unit, out, 1, 1, 1, &a);
    add_product(unit, out, -1, 1, 1, &b);
}

static inline void vec_difference(const struct unit *unit, const struct vec *a, const struct vec *b,
                                  struct vec *out)
{
    for (int i = 0; i < 3; i++)
        difference(unit, &a->k[i], &b->k[i], &out->k[i]);
}

/* x . (y cross z), added up in any order: each term goes through the multiplication and the
 * subtraction of the cross product, the multiplication and at most two additions of the dot. */
static inline void triple(const struct unit *unit, const struct vec *x, const struct vec *y,
                          const struct vec *z, struct known *out)
{
    set_zero(out);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        const struct known *plus[3] = {&x->k[k], &y->k[i], &z->k[j]};
        const struct known *minus[3] = {&x->k[k], &y->k[j], &z->k[i]};
        add_product(unit, out, 1, 5, 3, plus);
        add_product(unit, out, -1, 5, 3, minus);
    }
    mpq_add(out->e, out->e, unit->tiny);
}

/* a / b, the quotient's own error and one multiplication if it goes by a reciprocal. */
static inline void quotient(const struct unit *unit, const struct known *a, const struct known *b,
                            bool reciprocal, struct known *out)
{
    mpq_t least, size;
    mpq_inits(least, size, NULL);
    mpq_div(out->v, a->v, b->v);
    mpq_abs(least, b->v);
    mpq_sub(least, least, b->e);
    /* |a'/b' - a/b| <= (ea + |a/b| eb) / (|b| - eb) */
    mpq_abs(size, out->v);
    mpq_mul(out->e, size, b->e);
    mpq_add(out->e, out->e, a->e);
    mpq_div(out->e, out->e, least);
    /* Then both are rounded: (|a/b| + error)(1 + k u) - |a/b|. */
    mpq_add(out->e, out->e, size);
    mpq_mul(out->e, out->e, unit->quotient);
    if (reciprocal)
        mpq_mul(out->e, out->e, unit->step);
    mpq_sub(out->e, out->e, size);
    mpq_add(out->e, out->e, unit->tiny);
    mpq_clears(least, size, NULL);
}

static inline void known_copy(struct known *to, const struct known *from)
{
    mpq_set(to->v, from->v);
    mpq_set(to->e, from->e);
}

/* Bounds t, u, v, the edges and det of baldwin_webber; false if no bound follows. */
bool gmp_bounds_baldwin_webber(const struct unit *unit, const struct vec *o, const struct vec *d,
                               const struct vec v[3], bool accel, struct gmp_bounds *out);

#endif

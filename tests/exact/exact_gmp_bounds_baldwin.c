/* The bounds of baldwin_webber and of tri_accel: their map, and what is computed by it, step by
 * step; a step's terms are sums of products as elsewhere. */
#include "tests/exact/exact_gmp_known.h"

/* What is larger than 2^80 is not bounded: two such factors could overflow. */
#define LARGEST 0x1p80

static bool is_large(const struct known *known)
{
    mpq_t most;
    mpq_init(most);
    mpq_abs(most, known->v);
    mpq_add(most, most, known->e);
    bool large = !(mpq_get_d(most) < LARGEST);
    mpq_clear(most);
    return large;
}

/* Surely not 0, and within what a division promises. */
static bool divides(const struct known *known)
{
    mpq_t least;
    mpq_init(least);
    mpq_abs(least, known->v);
    mpq_sub(least, least, known->e);
    double x = mpq_get_d(least);
    mpq_clear(least);
    return x > 0x1p-120 && x < 0x1p120;
}

/* The numbers of one evaluation. */
struct map {
    struct known n[3], row[3][3], height, climb, t, p[2], uv[2];
};

#define MAP_KNOWN (sizeof(struct map) / sizeof(struct known))

/* sign * (z + m[0] x + m[1] y + last), in at most `n` roundings a term; z and last may be NULL. */
static void affine(const struct unit *unit, int sign, int n, const struct known m[2],
                   const struct known *const at[2], const struct known *z, const struct known *last,
                   struct known *out)
{
    set_zero(out);
    for (int i = 0; i < 2; i++) {
        const struct known *term[2] = {&m[i], at[i]};
        add_product(unit, out, sign, n, 2, term);
    }
    if (z)
        add_product(unit, out, sign, n, 1, &z);
    if (last)
        add_product(unit, out, sign, n, 1, &last);
    mpq_add(out->e, out->e, unit->tiny);
}

/* By the normal's component c. False if no bound follows. */
static bool along(const struct unit *unit, const struct vec *o, const struct vec *d,
                  const struct vec v[3], const struct vec *e1, const struct vec *e2, int c,
                  bool accel, struct map *map)
{
    const int axis[2] = {(c + 1) % 3, (c + 2) % 3};
    const struct known *at[2] = {&v[0].k[axis[0]], &v[0].k[axis[1]]};
    const struct known *from[3][2] = {{&e2->k[axis[1]], &e2->k[axis[0]]},
                                      {&e1->k[axis[1]], &e1->k[axis[0]]},
                                      {&map->n[axis[0]], &map->n[axis[1]]}};
    if (!divides(&map->n[c]))
        return false;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 2; k++) {
            quotient(unit, from[i][k], &map->n[c], false, &map->row[i][k]);
            if (i + k == 1) /* u's second and v's first are negated */
                mpq_neg(map->row[i][k].v, map->row[i][k].v);
        }
        affine(unit, -1, 3, map->row[i], at, i == 2 ? &v[0].k[c] : NULL, NULL, &map->row[i][2]);
    }
    const struct known *origin[2] = {&o->k[axis[0]], &o->k[axis[1]]};
    const struct known *way[2] = {&d->k[axis[0]], &d->k[axis[1]]};
    affine(unit, -1, 4, map->row[2], origin, &o->k[c], &map->row[2][2], &map->height);
    affine(unit, 1, 3, map->row[2], way, &d->k[c], NULL, &map->climb);
    for (int i = 0; i < 9; i++)
        if (is_large(&map->row[i / 3][i % 3]))
            return false;
    if (!divides(&map->climb))
        return false;
    quotient(unit, &map->height, &map->climb, accel, &map->t);
    for (int k = 0; k < 2; k++) {
        const struct known *term[2] = {&map->t, way[k]};
        set_zero(&map->p[k]);
        add_product(unit, &map->p[k], 1, 1, 1, &origin[k]);
        add_product(unit, &map->p[k], 1, 2, 2, term);
        mpq_add(map->p[k].e, map->p[k].e, unit->tiny);
    }
    const struct known *point[2] = {&map->p[0], &map->p[1]};
    for (int i = 0; i < 2; i++)
        affine(unit, 1, 3, map->row[i], point, NULL, &map->row[i][2], &map->uv[i]);
    return !is_large(&map->t) && !is_large(&map->p[0]) && !is_large(&map->p[1]) &&
           !is_large(&map->uv[0]) && !is_large(&map->uv[1]);
}

/* The wider of what both axes give; the value is the same. */
static void widen(const struct known *one, bool first, struct known *out)
{
    if (first || mpq_cmp(out->e, one->e) < 0)
        known_copy(out, one);
}

/* A component that may be taken for the largest: it reaches what another surely has. */
static bool may_be_largest(const struct known n[3], int c)
{
    mpq_t most, least;
    bool may = true;
    mpq_inits(most, least, NULL);
    mpq_abs(most, n[c].v);
    mpq_add(most, most, n[c].e);
    for (int i = 0; i < 3; i++) {
        mpq_abs(least, n[i].v);
        mpq_sub(least, least, n[i].e);
        may = may && mpq_cmp(most, least) >= 0;
    }
    mpq_clears(most, least, NULL);
    return may;
}

static void each_known(struct map *map, void (*each)(struct known *))
{
    struct known *known = (struct known *)map;
    for (size_t i = 0; i < MAP_KNOWN; i++)
        each(&known[i]);
}

bool gmp_bounds_baldwin_webber(const struct unit *unit, const struct vec *o, const struct vec *d,
                               const struct vec v[3], bool accel, struct gmp_bounds *out)
{
    struct vec e1, e2;
    struct map map;
    bool bounded = true, first = true;
    vec_init(&e1);
    vec_init(&e2);
    each_known(&map, known_init);
    vec_difference(unit, &v[1], &v[0], &e1);
    vec_difference(unit, &v[2], &v[0], &e2);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        const struct known *plus[2] = {&e1.k[i], &e2.k[j]}, *minus[2] = {&e1.k[j], &e2.k[i]};
        set_zero(&map.n[k]);
        add_product(unit, &map.n[k], 1, 2, 2, plus);
        add_product(unit, &map.n[k], -1, 2, 2, minus);
        mpq_add(map.n[k].e, map.n[k].e, unit->tiny);
    }
    for (int c = 0; c < 3 && bounded; c++) {
        if (!may_be_largest(map.n, c))
            continue;
        bounded = along(unit, o, d, v, &e1, &e2, c, accel, &map);
        if (!bounded)
            break;
        widen(&map.t, first, &out->t);
        widen(&map.uv[0], first, &out->u);
        widen(&map.uv[1], first, &out->v);
        first = false;
    }
    if (bounded) {
        const struct known *u = &out->u, *w = &out->v;
        struct known one;
        known_init(&one);
        mpq_set_si(one.v, 1, 1);
        const struct known *whole = &one;
        known_copy(&out->edge[1], u);
        known_copy(&out->edge[2], w);
        set_zero(&out->edge[0]);
        add_product(unit, &out->edge[0], 1, 0, 1, &whole);
        add_product(unit, &out->edge[0], -1, 1, 1, &u);
        add_product(unit, &out->edge[0], -1, 1, 1, &w);
        mpq_add(out->edge[0].e, out->edge[0].e, unit->tiny);
        known_copy(&out->det, &one); /* weights are positive inside, whichever way it faces */
        known_clear(&one);
    }
    each_known(&map, known_clear);
    vec_clear(&e1);
    vec_clear(&e2);
    return bounded;
}

#include "tests/exact/gmp_steady.h"

#include "tests/exact/gmp_object_ray.h"

#include <math.h>

#define UNIT 0x1p-24

void gmp_steady_init(struct gmp_steady *s)
{
    mpq_inits(s->det, s->normal, s->reach, NULL);
    for (int c = 0; c < 3; c++)
        mpq_inits(s->along[c], s->distance[c], NULL);
}

void gmp_steady_clear(struct gmp_steady *s)
{
    mpq_clears(s->det, s->normal, s->reach, NULL);
    for (int c = 0; c < 3; c++)
        mpq_clears(s->along[c], s->distance[c], NULL);
}

struct vectors {
    mpq_t v[3][3]; /* vertices, relative to the origin of the ray */
    mpq_t e[3], d[3], x[3], term;
};

static void all_of(struct vectors *w, bool init)
{
    mpq_t *three[] = {w->v[0], w->v[1], w->v[2], w->e, w->d, w->x};
    for (size_t i = 0; i < ARRAY_COUNT(three); i++)
        for (int k = 0; k < 3; k++) {
            if (init)
                mpq_init(three[i][k]);
            else
                mpq_clear(three[i][k]);
        }
    if (init)
        mpq_init(w->term);
    else
        mpq_clear(w->term);
}

static void cross(struct vectors *w, mpq_t a[3], mpq_t b[3], mpq_t out[3])
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        mpq_mul(out[k], a[i], b[j]);
        mpq_mul(w->term, a[j], b[i]);
        mpq_sub(out[k], out[k], w->term);
    }
}

static void dot(struct vectors *w, mpq_t a[3], mpq_t b[3], mpq_t out)
{
    mpq_set_si(out, 0, 1);
    for (int k = 0; k < 3; k++) {
        mpq_mul(w->term, a[k], b[k]);
        mpq_add(out, out, w->term);
    }
}

static void subtract(mpq_t a[3], mpq_t b[3], mpq_t out[3])
{
    for (int k = 0; k < 3; k++)
        mpq_sub(out[k], a[k], b[k]);
}

static double largest(mpq_t v[3])
{
    return fmax(fabs(mpq_get_d(v[0])), fmax(fabs(mpq_get_d(v[1])), fabs(mpq_get_d(v[2]))));
}

static double reach_of(const struct world *world, const struct ray *ray, uint32_t prim,
                       const struct gmp_pair *pair, struct vectors *w)
{
    struct place place = gmp_world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    double vertex = 0, o = 0, t = 0, hit = 0;
    double at = pair->point ? mpq_get_d(pair->t) : 0;
    for (int c = 0; c < 3; c++)
        vertex = fmax(vertex, largest(w->v[c]));
    for (int k = 0; k < 3; k++) {
        o = fmax(o, fabs((double)ray->org[k]));
        t = fmax(t, fabs((double)instance->m[k][3]));
        hit = fmax(hit, fabs((double)ray->org[k] + at * (double)ray->dir[k]));
    }
    double way = instance_is_identity(instance) ? 0 : 64 * gmp_kappa(instance) * (o + t + hit);
    return UNIT * (1 + 0x1p-20) * (32 * vertex + way);
}

void gmp_steady_load(const struct world *world, const struct ray *ray, uint32_t prim,
                     const struct gmp_pair *pair, struct gmp_steady *out)
{
    struct vectors w;
    all_of(&w, true);
    gmp_world_vertices(world, prim, w.v);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(w.d[k], (double)ray->dir[k]);
        mpq_set_d(w.term, (double)ray->org[k]);
        for (int c = 0; c < 3; c++)
            mpq_sub(w.v[c][k], w.v[c][k], w.term);
    }
    mpq_set_d(out->reach, reach_of(world, ray, prim, pair, &w));
    mpq_mul(out->reach, out->reach, out->reach);
    for (int c = 0; c < 3; c++) {
        subtract(w.v[(c + 1) % 3], w.v[c], w.e);
        cross(&w, w.d, w.e, w.x);
        dot(&w, w.x, w.x, out->along[c]);
        dot(&w, w.v[c], w.x, out->distance[c]);
        mpq_mul(out->distance[c], out->distance[c], out->distance[c]);
    }
    mpq_t second[3];
    mpq_inits(second[0], second[1], second[2], NULL);
    subtract(w.v[1], w.v[0], w.e);
    subtract(w.v[2], w.v[0], second);
    cross(&w, w.e, second, w.x);
    dot(&w, w.x, w.x, out->normal);
    dot(&w, w.d, w.x, out->det);
    mpq_mul(out->det, out->det, out->det);
    mpq_clears(second[0], second[1], second[2], NULL);
    all_of(&w, false);
}

/* Whether `size` is above 2^doublings times the reach, along edge c; all are squares. */
static bool is_above(const struct gmp_steady *s, const mpq_t size, int c, mp_bitcnt_t doublings)
{
    mpq_t limit;
    mpq_init(limit);
    mpq_mul(limit, s->reach, s->along[c]);
    mpq_mul_2exp(limit, limit, 2 * doublings);
    bool above = mpq_cmp(size, limit) > 0;
    mpq_clear(limit);
    return above;
}

bool gmp_steady_hit(const struct gmp_steady *s)
{
    return is_above(s, s->distance[0], 0, 0) && is_above(s, s->distance[1], 1, 0) &&
           is_above(s, s->distance[2], 2, 0);
}

bool gmp_steady_side(const struct gmp_steady *s)
{
    return is_above(s, s->det, 0, 1) && is_above(s, s->det, 1, 1) && is_above(s, s->det, 2, 1);
}

int gmp_steady_t(const struct gmp_steady *s, const mpq_t t, double x)
{
    if (isinf(x))
        return x > 0 ? -1 : 1;
    mpq_t apart, limit;
    mpq_inits(apart, limit, NULL);
    mpq_set_d(apart, x);
    mpq_sub(apart, t, apart);
    int side = mpq_sgn(apart);
    mpq_mul(apart, apart, apart);
    mpq_mul(apart, apart, s->det);
    mpq_mul(limit, s->normal, s->reach);
    if (mpq_cmp(apart, limit) <= 0)
        side = 0;
    mpq_clears(apart, limit, NULL);
    return side;
}

bool gmp_steady_beside(const struct world *world, const struct ray *ray, uint32_t prim,
                       const struct gmp_steady *s, float u, float v)
{
    struct vectors w;
    mpq_t part, limit;
    all_of(&w, true);
    mpq_inits(part, limit, NULL);
    gmp_world_vertices(world, prim, w.v);
    for (int k = 0; k < 3; k++) { /* x = v0 + u (v1 - v0) + v (v2 - v0) - o */
        mpq_set_d(w.d[k], (double)ray->dir[k]);
        mpq_set_d(w.term, (double)ray->org[k]);
        mpq_sub(w.x[k], w.v[0][k], w.term);
        for (int c = 1; c < 3; c++) {
            mpq_sub(part, w.v[c][k], w.v[0][k]);
            mpq_set_d(w.term, (double)(c == 1 ? u : v));
            mpq_mul(part, part, w.term);
            mpq_add(w.x[k], w.x[k], part);
        }
    }
    cross(&w, w.x, w.d, w.e);
    dot(&w, w.e, w.e, part);
    dot(&w, w.d, w.d, limit);
    mpq_mul(limit, limit, s->reach);
    mpq_set_si(w.term, 9, 4);
    mpq_mul(limit, limit, w.term);
    bool beside = mpq_cmp(part, limit) > 0;
    mpq_clears(part, limit, NULL);
    all_of(&w, false);
    return beside;
}

double gmp_steady_weight(const struct gmp_steady *s)
{
    double most = 0, det = sqrt(mpq_get_d(s->det)), reach = sqrt(mpq_get_d(s->reach));
    for (int c = 0; c < 3; c++) {
        double height = det / sqrt(mpq_get_d(s->along[c]));
        if (!(height > 4 * reach))
            return (double)INFINITY;
        /* A distance to an edge changes by `reach`, and so does a height, twice. */
        most = fmax(most, 4 * reach / (height - 2 * reach));
    }
    return most;
}

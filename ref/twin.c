#include "ref/twin.h"

#include "ref/base.h"
#include "ref/mutant.h"

#include <math.h>

#define UNIT 0x1p-24
/* Covers the rounding of the bounds themselves, which are computed in double. */
#define SLACK (1.0 + 1e-12)

/* A float32 as computed, and a bound on its distance to the exact value. */
struct bounded {
    float v;
    double e;
};

static struct bounded exact(float v)
{
    return (struct bounded){v, 0.0};
}

static struct bounded add(const struct rounding *k, struct bounded a, struct bounded b)
{
    float v = a.v + b.v;
#if MUTANT == MUTANT_BAD_TWIN
    return (struct bounded){v, 1e-4 * (a.e + b.e + k->add * UNIT * fabs((double)v))};
#else
    return (struct bounded){v, (a.e + b.e + k->add * UNIT * fabs((double)v)) * SLACK};
#endif
}

static struct bounded negate(struct bounded a)
{
    return (struct bounded){-a.v, a.e};
}

static struct bounded sub(const struct rounding *k, struct bounded a, struct bounded b)
{
    return add(k, a, negate(b));
}

static struct bounded mul(const struct rounding *k, struct bounded a, struct bounded b)
{
    float v = a.v * b.v;
    double x = fabs((double)a.v), y = fabs((double)b.v);
    double e = x * b.e + y * a.e + a.e * b.e + k->mul * UNIT * fabs((double)v) + k->tiny;
    return (struct bounded){v, e * SLACK};
}

static struct bounded divide(const struct rounding *k, struct bounded a, struct bounded b)
{
    float v = a.v / b.v;
    double y = fabs((double)b.v);
    if (!(y > b.e) || !float_is_finite(v))
        return (struct bounded){v, INFINITY};
    double q = fabs((double)a.v) / y;
    double e = (a.e + q * b.e) / (y - b.e) + k->div * UNIT * fabs((double)v) + k->tiny;
    return (struct bounded){v, e * SLACK};
}

static void subtract(const struct rounding *k, const struct bounded a[3], const struct bounded b[3],
                     struct bounded out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = sub(k, a[i], b[i]);
}

static void cross(const struct rounding *k, const struct bounded a[3], const struct bounded b[3],
                  struct bounded out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        out[i] = sub(k, mul(k, a[j], b[l]), mul(k, a[l], b[j]));
    }
}

static struct bounded dot(const struct rounding *k, const struct bounded a[3],
                          const struct bounded b[3])
{
    struct bounded sum = add(k, mul(k, a[0], b[0]), mul(k, a[1], b[1]));
    return add(k, sum, mul(k, a[2], b[2]));
}

/* What every formula ends in: three edge functions of equal sign inside, their sum, and t. */
struct outcome {
    struct bounded edge[3];
    struct bounded det;
    struct bounded t;
    double band; /* by how much an edge function may be negative and still be accepted */
};

struct input {
    struct bounded o[3], d[3], v[3][3];
};

static struct outcome eval_moeller_trumbore(const struct rounding *k, const struct input *in)
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
    out.edge[0] = sub(k, out.det, add(k, out.edge[1], out.edge[2]));
    out.t = divide(k, dot(k, e2, q), out.det);
    return out;
}

static struct outcome eval_woop(const struct rounding *k, const struct input *in,
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
    return out;
}

static struct outcome eval_embree(const struct rounding *k, const struct input *in)
{
    struct bounded e1[3], e2[3], n[3], c[3], r[3];
    struct outcome out = {.band = 0.0};
    subtract(k, in->v[0], in->v[1], e1);
    subtract(k, in->v[2], in->v[0], e2);
    subtract(k, in->v[0], in->o, c);
    cross(k, e2, e1, n);
    cross(k, c, in->d, r);
    out.det = dot(k, n, in->d);
    out.edge[1] = dot(k, r, e2);
    out.edge[2] = dot(k, r, e1);
    out.edge[0] = sub(k, out.det, add(k, out.edge[1], out.edge[2]));
    out.t = divide(k, dot(k, n, c), out.det);
    return out;
}

/* Pluecker edge functions of vertices relative to the origin; negative ones within 2^-23 of their
 * sum are accepted. */
static struct outcome eval_embree_robust(const struct rounding *k, const struct input *in)
{
    struct bounded v[3][3], e[3][3], sum[3], side[3], n[3];
    struct outcome out;
    for (int c = 0; c < 3; c++)
        subtract(k, in->v[c], in->o, v[c]);
    for (int c = 0; c < 3; c++) { /* e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2 */
        int from = (c + 2) % 3;
        subtract(k, v[from], v[c], e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = add(k, v[from][i], v[c][i]);
        cross(k, e[c], sum, side);
        out.edge[c] = dot(k, side, in->d);
    }
    struct bounded all = add(k, add(k, out.edge[0], out.edge[1]), out.edge[2]);
    out.band = (fabs((double)all.v) + all.e) * 0x1p-22;
    cross(k, e[0], e[1], n);
    out.det = dot(k, n, in->d);
    out.t = divide(k, dot(k, n, v[0]), out.det);
    return out;
}

static int sign_of(struct bounded a)
{
    return fabs((double)a.v) > a.e ? (a.v > 0.0f ? 1 : -1) : 0;
}

enum twin_formula twin_of_tri(uint32_t id)
{
    return id == ABI_TRI_WOOP ? TWIN_WOOP : id == ABI_TRI_MT_RTRS ? TWIN_MT_RTRS : TWIN_MT;
}

static struct outcome evaluate(enum twin_formula formula, const struct rounding *k,
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

struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3])
{
    struct outcome out = evaluate(formula, &rounding, ray, v);
    bool positive = false, negative = false; /* beyond the formula's own band */
    int inside = 0;
    for (int c = 0; c < 3; c++) {
        struct bounded slack = {out.edge[c].v, out.edge[c].e + out.band};
        positive |= sign_of(slack) > 0;
        negative |= sign_of(slack) < 0;
        inside += sign_of(out.edge[c]);
    }
    double t = (double)out.t.v, e = out.t.e;
    bool det_known = sign_of(out.det) != 0;
    if (formula == TWIN_MT_RTRS)
        det_known = fabs((double)out.det.v) - out.det.e > (double)TRI_RTRS_EPS;
    bool in_range = t - e > (double)ray->tmin && t + e < (double)ray->tmax;
    bool beyond = t + e < (double)ray->tmin || t - e > (double)ray->tmax;
    struct bounded u = divide(&rounding, out.edge[1], out.det);
    struct bounded w = divide(&rounding, out.edge[2], out.det);
    struct twin twin = {
        .possible = !(positive && negative) && !beyond,
        .certain = (inside == 3 || inside == -3) && det_known && in_range,
        .beyond = beyond,
        .det = det_known ? sign_of(out.det) : 0,
        .t = out.t.v,
        .u = u.v,
        .v = w.v,
        .t_err = isnan(e) ? INFINITY : e,
        .u_err = isnan(u.e) ? INFINITY : u.e,
        .v_err = isnan(w.e) ? INFINITY : w.e,
    };
    for (int c = 0; c < 3; c++)
        twin.edge[c] = sign_of(out.edge[c]);
    return twin;
}

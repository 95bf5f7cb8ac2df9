/* Every formula of a triangle test, by operations whose rounding is chosen. */
#include "tests/exact/legal_operations.h"
#include "ref/primitives/test_run.h"

#include <math.h>

static struct evaluation moeller_trumbore(struct legal *l, const struct ray *ray, float v[3][3],
                                          bool rtrs)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    struct evaluation out;
    legal_subtract(l, v[1], v[0], e1);
    legal_subtract(l, v[2], v[0], e2);
    legal_subtract(l, ray->org, v[0], s);
    legal_cross(l, ray->dir, e2, p);
    legal_cross(l, s, e1, q);
    float det = legal_dot(l, e1, p), u = legal_dot(l, s, p), w = legal_dot(l, ray->dir, q),
          t = legal_dot(l, e2, q);
    float sign = det < 0 ? -1.0f : 1.0f, us = sign * u, ws = sign * w;
    out.t = legal_div(l, t, det);
    out.u = legal_div(l, u, det);
    out.v = legal_div(l, w, det);
    out.edge[0] = 0; /* never computed */
    out.edge[1] = u;
    out.edge[2] = w;
    float size = legal_seen(l, fabsf(det));
    out.accepted =
        size > (rtrs ? TRI_RTRS_EPS : 0.0f) && legal_seen(l, us) >= 0 && us <= size &&
        legal_seen(l, ws) >= 0 && legal_add(l, us, ws) <= size &&
        (rtrs ? out.t > ray->tmin && out.t < ray->tmax : out.t >= ray->tmin && out.t <= ray->tmax);
    return out;
}

void legal_woop_shear(struct legal *l, const struct tri_ray *r, float v[3][3], float x[3],
                      float y[3], float z[3])
{
    float sx = legal_div(l, r->d[r->kx], r->d[r->kz]);
    float sy = legal_div(l, r->d[r->ky], r->d[r->kz]);
    float sz = legal_div(l, 1, r->d[r->kz]);
    for (int c = 0; c < 3; c++) {
        float az = legal_sub(l, v[c][r->kz], r->o[r->kz]);
        x[c] = legal_sub(l, legal_sub(l, v[c][r->kx], r->o[r->kx]), legal_mul(l, sx, az));
        y[c] = legal_sub(l, legal_sub(l, v[c][r->ky], r->o[r->ky]), legal_mul(l, sy, az));
        z[c] = legal_mul(l, sz, az);
    }
}

static struct evaluation woop(struct legal *l, const struct ray *ray, float v[3][3])
{
    struct tri_ray r = tri_ray_make(ray); /* for its axes */
    float x[3], y[3], z[3];
    struct evaluation out;
    legal_woop_shear(l, &r, v, x, y, z);
    bool negative = false, positive = false;
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        out.edge[c] = legal_sub(l, legal_mul(l, x[a], y[b]), legal_mul(l, y[a], x[b]));
        float sign = legal_seen(l, out.edge[c]);
        negative |= sign < 0;
        positive |= sign > 0;
    }
    float det = legal_add(l, legal_add(l, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = legal_div(l, legal_dot(l, out.edge, z), det);
    out.u = legal_div(l, out.edge[1], det);
    out.v = legal_div(l, out.edge[2], det);
    float sign = legal_seen(l, det);
    out.accepted = !(negative && positive) && (sign > 0 || sign < 0) && out.t >= ray->tmin &&
                   out.t <= ray->tmax;
    return out;
}

/* Signed volumes: of the ray's direction, an edge and the sum of its ends seen from the origin. */
static struct evaluation pluecker(struct legal *l, const struct ray *ray, float v[3][3])
{
    float a[3][3], e[3][3], n[3];
    struct evaluation out;
    for (int c = 0; c < 3; c++)
        legal_subtract(l, v[c], ray->org, a[c]);
    for (int c = 0; c < 3; c++) {
        const int from = (c + 1) % 3, to = (c + 2) % 3;
        float sum[3], side[3];
        for (int i = 0; i < 3; i++)
            sum[i] = legal_add(l, a[from][i], a[to][i]);
        legal_subtract(l, v[to], v[from], e[c]);
        legal_cross(l, sum, e[c], side);
        out.edge[c] = legal_dot(l, ray->dir, side);
    }
    legal_cross(l, e[1], e[2], n);
    float det = legal_dot(l, ray->dir, n);
    float all = legal_add(l, legal_add(l, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = legal_div(l, legal_dot(l, a[0], n), det);
    out.u = legal_div(l, out.edge[1], all);
    out.v = legal_div(l, out.edge[2], all);
    float way = legal_seen(l, det), sum = legal_seen(l, all);
    bool inside = (way > 0 && sum > 0) || (way < 0 && sum < 0);
    for (int c = 0; c < 3; c++) {
        float side = legal_seen(l, out.edge[c]);
        inside = inside && (way > 0 ? side >= 0 : side <= 0);
    }
    out.accepted = inside && out.t >= ray->tmin && out.t <= ray->tmax;
    return out;
}

/* t of a plane p[c] + h[0] p[a] + h[1] p[b] = -h[2], as the published code of TriAccel has it: each
 * term is taken off the constant, and a reciprocal multiplies what is left. */
static float accel_t(struct legal *l, const struct ray *ray, const float h[3], float climb, int c)
{
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    float left = legal_sub(l, -h[2], ray->org[c]);
    left = legal_multiply_add(l, -h[0], ray->org[a], left);
    left = legal_multiply_add(l, -h[1], ray->org[b], left);
    return legal_mul(l, left, legal_div(l, 1, climb));
}

/* Its normal decides which axis to project along, so that a rounding may decide otherwise. */
static struct evaluation baldwin_webber(struct legal *l, const struct ray *ray, float v[3][3],
                                        bool accel)
{
    float e1[3], e2[3], n[3], row[3][3];
    struct evaluation out = {{0, -1, -1}, 0, 0, 0, false};
    legal_subtract(l, v[1], v[0], e1);
    legal_subtract(l, v[2], v[0], e2);
    legal_cross(l, e1, e2, n);
    int c = 0;
    for (int i = 1; i < 3; i++)
        c = fabsf(legal_seen(l, n[i])) > fabsf(legal_seen(l, n[c])) ? i : c;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const float by_a[3] = {e2[b], -e1[b], n[a]}, by_b[3] = {-e2[a], e1[a], n[b]};
    float area = legal_seen(l, n[c]);
    for (int i = 0; i < 3; i++) {
        row[i][0] = legal_div(l, by_a[i], n[c]);
        row[i][1] = legal_div(l, by_b[i], n[c]);
        float first = i < 2 ? legal_mul(l, row[i][0], v[0][a])
                            : legal_multiply_add(l, row[i][0], v[0][a], v[0][c]);
        row[i][2] = -legal_multiply_add(l, row[i][1], v[0][b], first);
    }
    float climb = legal_multiply_add(l, row[2][1], ray->dir[b],
                                     legal_multiply_add(l, row[2][0], ray->dir[a], ray->dir[c]));
    float height =
        legal_add(l,
                  legal_multiply_add(l, row[2][1], ray->org[b],
                                     legal_multiply_add(l, row[2][0], ray->org[a], ray->org[c])),
                  row[2][2]);
    out.t = accel ? accel_t(l, ray, row[2], climb, c) : legal_div(l, -height, climb);
    float pa = legal_multiply_add(l, out.t, ray->dir[a], ray->org[a]);
    float pb = legal_multiply_add(l, out.t, ray->dir[b], ray->org[b]);
    for (int i = 0; i < 2; i++)
        out.edge[1 + i] = legal_add(
            l, legal_multiply_add(l, row[i][1], pb, legal_mul(l, row[i][0], pa)), row[i][2]);
    out.edge[0] = 0; /* never computed */
    out.u = out.edge[1];
    out.v = out.edge[2];
    float change = legal_seen(l, climb);
    out.accepted = (area < 0 || area > 0) && (change < 0 || change > 0) &&
                   legal_seen(l, out.u) >= 0 && legal_seen(l, out.v) >= 0 &&
                   legal_add(l, out.u, out.v) <= 1 && out.t >= ray->tmin && out.t <= ray->tmax;
    return out;
}

/* Embree reports no weight above 1. */
static struct evaluation cut_off(struct evaluation hit)
{
    if (hit.accepted) {
        hit.u = fminf(hit.u, 1);
        hit.v = fminf(hit.v, 1);
    }
    return hit;
}

static struct evaluation embree(struct legal *l, const struct ray *ray, float v[3][3])
{
    float e1[3], e2[3], n[3], c[3], r[3];
    struct evaluation out;
    legal_subtract(l, v[0], v[1], e1);
    legal_subtract(l, v[2], v[0], e2);
    legal_cross(l, e2, e1, n);
    legal_subtract(l, v[0], ray->org, c);
    legal_cross(l, c, ray->dir, r);
    float den = legal_dot_back(l, n, ray->dir), sign = signbit(den) ? -1.0f : 1.0f;
    float u = sign * legal_dot_back(l, r, e2), w = sign * legal_dot_back(l, r, e1);
    float t = sign * legal_dot_back(l, n, c), size = fabsf(den);
    float inverse = legal_div(l, 1, size);
    out.t = legal_mul(l, t, inverse);
    out.u = legal_mul(l, u, inverse);
    out.v = legal_mul(l, w, inverse);
    out.edge[0] = 0;
    out.edge[1] = sign * u;
    out.edge[2] = sign * w;
    bool inside = legal_seen(l, den) != 0 && legal_seen(l, u) >= 0 && legal_seen(l, w) >= 0 &&
                  legal_add(l, u, w) <= legal_seen(l, size);
    out.accepted = inside && legal_mul(l, size, ray->tmin) < legal_seen(l, t) &&
                   legal_seen(l, t) <= legal_mul(l, size, ray->tmax);
    return cut_off(out);
}

/* Component i of the normal from edges a and b; *first is the product that decides which edges. */
static float normal_part(struct legal *l, const float a[3], const float b[3], int i, float *first)
{
    int j = (i + 1) % 3, k = (i + 2) % 3;
    *first = legal_mul(l, a[k], b[j]);
    return legal_multiply_add(l, a[j], b[k], -*first);
}

static struct evaluation embree_robust(struct legal *l, const struct ray *ray, float v[3][3])
{
    float a[3][3], e[3][3], uvw[3], n[3];
    struct evaluation out;
    for (int c = 0; c < 3; c++)
        legal_subtract(l, v[c], ray->org, a[c]);
    for (int c = 0; c < 3; c++) {
        const float *from = a[(c + 2) % 3], *to = a[c];
        float sum[3], side[3];
        legal_subtract(l, from, to, e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = legal_add(l, from[i], to[i]);
        legal_cross(l, e[c], sum, side);
        uvw[c] = legal_dot_back(l, side, ray->dir);
        out.edge[(c + 1) % 3] = uvw[c];
    }
    float all = legal_add(l, legal_add(l, uvw[0], uvw[1]), uvw[2]);
    float eps = legal_mul(l, 0x1p-23f, fabsf(all));
    float least = fminf(fminf(legal_seen(l, uvw[0]), legal_seen(l, uvw[1])), legal_seen(l, uvw[2]));
    float most = fmaxf(fmaxf(legal_seen(l, uvw[0]), legal_seen(l, uvw[1])), legal_seen(l, uvw[2]));
    for (int i = 0; i < 3; i++) {
        float ab, bc;
        float from_ab = normal_part(l, e[0], e[1], i, &ab);
        float from_bc = normal_part(l, e[1], e[2], i, &bc);
        n[i] = fabsf(ab) < fabsf(bc) ? from_ab : from_bc;
    }
    float den = 2 * legal_dot_back(l, n, ray->dir), t = 2 * legal_dot_back(l, a[0], n);
    out.t = legal_mul(l, legal_div(l, 1, den), t);
    float inverse = fabsf(all) < 1e-18f ? 0 : legal_div(l, 1, all);
    out.u = legal_mul(l, uvw[0], inverse);
    out.v = legal_mul(l, uvw[1], inverse);
    out.accepted = (least >= -eps || most <= eps) && ray->tmin <= out.t && out.t <= ray->tmax &&
                   legal_seen(l, den) != 0;
    return cut_off(out);
}

static struct evaluation evaluate(struct legal *l, enum twin_formula formula, const struct ray *ray,
                                  float v[3][3])
{
    switch (formula) {
    case TWIN_WOOP:
        return woop(l, ray, v);
    case TWIN_PLUECKER:
        return pluecker(l, ray, v);
    case TWIN_BALDWIN_WEBBER:
    case TWIN_TRI_ACCEL:
        return baldwin_webber(l, ray, v, formula == TWIN_TRI_ACCEL);
    case TWIN_EMBREE:
        return embree(l, ray, v);
    case TWIN_EMBREE_ROBUST:
        return embree_robust(l, ray, v);
    case TWIN_MT_RTRS:
        return moeller_trumbore(l, ray, v, true);
    case TWIN_MT:
    case TWIN_UNKNOWN:
        break;
    }
    return moeller_trumbore(l, ray, v, false);
}

struct evaluation legal_evaluate(struct legal *l, enum twin_formula formula, const struct ray *ray,
                                 float v[3][3])
{
    l->count = 0;
    return evaluate(l, formula, ray, v);
}

struct ray legal_transform(struct legal *l, const struct twin_place *place, const struct ray *ray)
{
    struct ray out = *ray;
    float x[3];
    if (place->identity)
        return out;
    legal_subtract(l, ray->org, place->t, x);
    for (int k = 0; k < 3; k++) {
        out.org[k] = legal_dot(l, place->w + 3 * k, x);
        out.dir[k] = legal_dot(l, place->w + 3 * k, ray->dir);
    }
    return out;
}

struct evaluation legal_evaluate_placed(struct legal *l, enum twin_formula formula,
                                        const struct twin_place *place, const struct ray *ray,
                                        float v[3][3])
{
    l->count = 0;
    struct ray placed = place ? legal_transform(l, place, ray) : *ray;
    return evaluate(l, formula, &placed, v);
}

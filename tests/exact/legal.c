#include "tests/exact/legal.h"

#include "ref/base/base.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define UNIT 0x1p-24

/* The choices of an operation of `kind` on a and b, the same each time. */
static uint32_t choice_of(const struct legal *l, uint32_t kind, float a, float b)
{
    uint32_t bits[2];
    memcpy(&bits[a > b], &a, sizeof a); /* a + b is b + a */
    memcpy(&bits[!(a > b)], &b, sizeof b);
    struct rng rng = rng_make(l->seed + kind, ((uint64_t)bits[0] << 32) | bits[1]);
    return (uint32_t)rng_u64(&rng) & 63u;
}

static uint32_t next_choice(struct legal *l, uint32_t kind, float a, float b)
{
    uint32_t choice = 0, at = l->count++ % LEGAL_MOST;
    switch (l->style) {
    case LEGAL_ALIKE:
        choice = choice_of(l, kind, a, b);
        break;
    case LEGAL_ALL_NEAREST:
        break;
    case LEGAL_ALL_LOW:
        choice = LEGAL_LOW;
        break;
    case LEGAL_ALL_HIGH:
        choice = LEGAL_HIGH | LEGAL_FUSE | LEGAL_FLUSH;
        break;
    case LEGAL_RANDOM:
        choice = (uint32_t)rng_u64(&l->rng) & 63u;
        break;
    case LEGAL_CHOSEN:
        choice = l->choice[at];
        break;
    }
    l->choice[at] = (uint8_t)choice;
    return choice;
}

static bool flushes(const struct legal *l)
{
    return l->rounding.tiny > 0x1p-149;
}

static float flushed(const struct legal *l, float x, bool wanted)
{
    return wanted && flushes(l) && fabsf(x) < FLT_MIN ? copysignf(0, x) : x;
}

/* The float32 next to head + tail, |tail| far below head's last place, on the side chosen. */
static float neighbour(double head, double tail, float nearest, uint32_t choice)
{
    float f = (float)head;
    bool below = (double)f < head || ((double)f == head && tail > 0);
    bool above = (double)f > head || ((double)f == head && tail < 0);
    if (choice & LEGAL_LOW)
        return above ? nextafterf(f, -INFINITY) : f;
    if (choice & LEGAL_HIGH)
        return below ? nextafterf(f, INFINITY) : f;
    return nearest;
}

static float rounded(const struct legal *l, double k, double head, double tail, float nearest,
                     uint32_t choice)
{
    float f = nearest;
    if (k >= 2.0 && isfinite(head)) {
        f = neighbour(head, tail, nearest, choice);
        /* Below the normal range one float32 step may be more than tiny only if nothing flushes. */
    }
    return flushed(l, f, (choice & LEGAL_FLUSH) != 0);
}

enum { OF_SUM, OF_PRODUCT, OF_QUOTIENT, OF_BOTH, OF_LOOK };

float legal_add(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_SUM, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    double x = (double)a, y = (double)b, sum = x + y, back = sum - x;
    double tail = (x - (sum - back)) + (y - back); /* Knuth: exactly what the sum lost */
    return rounded(l, l->rounding.add, sum, tail, a + b, choice);
}

static float legal_sub(struct legal *l, float a, float b)
{
    return legal_add(l, a, -b);
}

float legal_mul(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_PRODUCT, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    return rounded(l, l->rounding.mul, (double)a * (double)b, 0, a * b, choice);
}

/* Any float32 within div u of the quotient: the farthest one on the side chosen. */
float legal_div(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_QUOTIENT, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    double q = (double)a / (double)b, k = l->rounding.div;
    float f = a / b;
    if (k > 1.0 && isfinite(q) && (choice & (LEGAL_LOW | LEGAL_HIGH))) {
        /* A little inside, so that the double's own rounding does not lead outside. */
        double reach = fabs(q) * k * UNIT * (1 - 1e-9) + (flushes(l) ? 0 : 0x1p-149);
        bool low = choice & LEGAL_LOW;
        double end = low ? q - reach : q + reach;
        f = neighbour(end, 0, (float)end, low ? LEGAL_HIGH : LEGAL_LOW);
    }
    return flushed(l, f, (choice & LEGAL_FLUSH) != 0);
}

/* In one rounding or two. */
float legal_multiply_add(struct legal *l, float a, float b, float c)
{
    uint32_t at = l->count;
    uint32_t choice = next_choice(l, OF_BOTH, a, b);
    if (!l->fuses || !(choice & LEGAL_FUSE)) {
        l->count = at + 1;
        return legal_add(l, legal_mul(l, a, b), c);
    }
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    return flushed(l, fmaf(a, b, c), (choice & LEGAL_FLUSH) != 0);
}

static float seen(struct legal *l, float x)
{
    return flushed(l, x, (next_choice(l, OF_LOOK, x, 0) & LEGAL_FLUSH_A) != 0);
}

static void subtract(struct legal *l, const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = legal_sub(l, a[i], b[i]);
}

static void cross(struct legal *l, const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = legal_multiply_add(l, a[j], b[k], -legal_mul(l, a[k], b[j]));
    }
}

/* Ours add from the front, Embree from the back. */
static float dot(struct legal *l, const float a[3], const float b[3])
{
    return legal_multiply_add(l, a[2], b[2],
                              legal_multiply_add(l, a[1], b[1], legal_mul(l, a[0], b[0])));
}

static float dot_back(struct legal *l, const float a[3], const float b[3])
{
    return legal_multiply_add(l, a[0], b[0],
                              legal_multiply_add(l, a[1], b[1], legal_mul(l, a[2], b[2])));
}

static struct evaluation moeller_trumbore(struct legal *l, const struct ray *ray, float v[3][3],
                                          bool rtrs)
{
    float e1[3], e2[3], s[3], p[3], q[3];
    struct evaluation out;
    subtract(l, v[1], v[0], e1);
    subtract(l, v[2], v[0], e2);
    subtract(l, ray->org, v[0], s);
    cross(l, ray->dir, e2, p);
    cross(l, s, e1, q);
    float det = dot(l, e1, p), u = dot(l, s, p), w = dot(l, ray->dir, q), t = dot(l, e2, q);
    float sign = det < 0 ? -1.0f : 1.0f, us = sign * u, ws = sign * w;
    out.t = legal_div(l, t, det);
    out.u = legal_div(l, u, det);
    out.v = legal_div(l, w, det);
    out.edge[0] = 0; /* never computed */
    out.edge[1] = u;
    out.edge[2] = w;
    float size = seen(l, fabsf(det));
    out.accepted =
        size > (rtrs ? TRI_RTRS_EPS : 0.0f) && seen(l, us) >= 0 && us <= size && seen(l, ws) >= 0 &&
        legal_add(l, us, ws) <= size &&
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
        float sign = seen(l, out.edge[c]);
        negative |= sign < 0;
        positive |= sign > 0;
    }
    float det = legal_add(l, legal_add(l, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = legal_div(l, dot(l, out.edge, z), det);
    out.u = legal_div(l, out.edge[1], det);
    out.v = legal_div(l, out.edge[2], det);
    float sign = seen(l, det);
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
        subtract(l, v[c], ray->org, a[c]);
    for (int c = 0; c < 3; c++) {
        const int from = (c + 1) % 3, to = (c + 2) % 3;
        float sum[3], side[3];
        for (int i = 0; i < 3; i++)
            sum[i] = legal_add(l, a[from][i], a[to][i]);
        subtract(l, v[to], v[from], e[c]);
        cross(l, sum, e[c], side);
        out.edge[c] = dot(l, ray->dir, side);
    }
    cross(l, e[1], e[2], n);
    float det = dot(l, ray->dir, n);
    float all = legal_add(l, legal_add(l, out.edge[0], out.edge[1]), out.edge[2]);
    out.t = legal_div(l, dot(l, a[0], n), det);
    out.u = legal_div(l, out.edge[1], all);
    out.v = legal_div(l, out.edge[2], all);
    float way = seen(l, det), sum = seen(l, all);
    bool inside = (way > 0 && sum > 0) || (way < 0 && sum < 0);
    for (int c = 0; c < 3; c++) {
        float side = seen(l, out.edge[c]);
        inside = inside && (way > 0 ? side >= 0 : side <= 0);
    }
    out.accepted = inside && out.t >= ray->tmin && out.t <= ray->tmax;
    return out;
}

/* Its normal decides which axis to project along, so that a rounding may decide otherwise. */
static struct evaluation baldwin_webber(struct legal *l, const struct ray *ray, float v[3][3])
{
    float e1[3], e2[3], n[3], row[3][3];
    struct evaluation out = {{0, -1, -1}, 0, 0, 0, false};
    subtract(l, v[1], v[0], e1);
    subtract(l, v[2], v[0], e2);
    cross(l, e1, e2, n);
    int c = 0;
    for (int i = 1; i < 3; i++)
        c = fabsf(seen(l, n[i])) > fabsf(seen(l, n[c])) ? i : c;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const float by_a[3] = {e2[b], -e1[b], n[a]}, by_b[3] = {-e2[a], e1[a], n[b]};
    float area = seen(l, n[c]);
    for (int i = 0; i < 3; i++) {
        row[i][0] = legal_div(l, by_a[i], n[c]);
        row[i][1] = legal_div(l, by_b[i], n[c]);
        float first = i < 2 ? legal_mul(l, row[i][0], v[0][a])
                            : legal_multiply_add(l, row[i][0], v[0][a], v[0][c]);
        row[i][2] = -legal_multiply_add(l, row[i][1], v[0][b], first);
    }
    float height =
        legal_add(l,
                  legal_multiply_add(l, row[2][1], ray->org[b],
                                     legal_multiply_add(l, row[2][0], ray->org[a], ray->org[c])),
                  row[2][2]);
    float climb = legal_multiply_add(l, row[2][1], ray->dir[b],
                                     legal_multiply_add(l, row[2][0], ray->dir[a], ray->dir[c]));
    out.t = legal_div(l, -height, climb);
    float pa = legal_multiply_add(l, out.t, ray->dir[a], ray->org[a]);
    float pb = legal_multiply_add(l, out.t, ray->dir[b], ray->org[b]);
    for (int i = 0; i < 2; i++)
        out.edge[1 + i] = legal_add(
            l, legal_multiply_add(l, row[i][1], pb, legal_mul(l, row[i][0], pa)), row[i][2]);
    out.edge[0] = 0; /* never computed */
    out.u = out.edge[1];
    out.v = out.edge[2];
    float change = seen(l, climb);
    out.accepted = (area < 0 || area > 0) && (change < 0 || change > 0) && seen(l, out.u) >= 0 &&
                   seen(l, out.v) >= 0 && legal_add(l, out.u, out.v) <= 1 && out.t >= ray->tmin &&
                   out.t <= ray->tmax;
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
    subtract(l, v[0], v[1], e1);
    subtract(l, v[2], v[0], e2);
    cross(l, e2, e1, n);
    subtract(l, v[0], ray->org, c);
    cross(l, c, ray->dir, r);
    float den = dot_back(l, n, ray->dir), sign = signbit(den) ? -1.0f : 1.0f;
    float u = sign * dot_back(l, r, e2), w = sign * dot_back(l, r, e1);
    float t = sign * dot_back(l, n, c), size = fabsf(den);
    float inverse = legal_div(l, 1, size);
    out.t = legal_mul(l, t, inverse);
    out.u = legal_mul(l, u, inverse);
    out.v = legal_mul(l, w, inverse);
    out.edge[0] = 0;
    out.edge[1] = sign * u;
    out.edge[2] = sign * w;
    bool inside = seen(l, den) != 0 && seen(l, u) >= 0 && seen(l, w) >= 0 &&
                  legal_add(l, u, w) <= seen(l, size);
    out.accepted = inside && legal_mul(l, size, ray->tmin) < seen(l, t) &&
                   seen(l, t) <= legal_mul(l, size, ray->tmax);
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
        subtract(l, v[c], ray->org, a[c]);
    for (int c = 0; c < 3; c++) {
        const float *from = a[(c + 2) % 3], *to = a[c];
        float sum[3], side[3];
        subtract(l, from, to, e[c]);
        for (int i = 0; i < 3; i++)
            sum[i] = legal_add(l, from[i], to[i]);
        cross(l, e[c], sum, side);
        uvw[c] = dot_back(l, side, ray->dir);
        out.edge[(c + 1) % 3] = uvw[c];
    }
    float all = legal_add(l, legal_add(l, uvw[0], uvw[1]), uvw[2]);
    float eps = legal_mul(l, 0x1p-23f, fabsf(all));
    float least = fminf(fminf(seen(l, uvw[0]), seen(l, uvw[1])), seen(l, uvw[2]));
    float most = fmaxf(fmaxf(seen(l, uvw[0]), seen(l, uvw[1])), seen(l, uvw[2]));
    for (int i = 0; i < 3; i++) {
        float ab, bc;
        float from_ab = normal_part(l, e[0], e[1], i, &ab);
        float from_bc = normal_part(l, e[1], e[2], i, &bc);
        n[i] = fabsf(ab) < fabsf(bc) ? from_ab : from_bc;
    }
    float den = 2 * dot_back(l, n, ray->dir), t = 2 * dot_back(l, a[0], n);
    out.t = legal_mul(l, legal_div(l, 1, den), t);
    float inverse = fabsf(all) < 1e-18f ? 0 : legal_div(l, 1, all);
    out.u = legal_mul(l, uvw[0], inverse);
    out.v = legal_mul(l, uvw[1], inverse);
    out.accepted = (least >= -eps || most <= eps) && ray->tmin <= out.t && out.t <= ray->tmax &&
                   seen(l, den) != 0;
    return cut_off(out);
}

struct evaluation legal_evaluate(struct legal *l, enum twin_formula formula, const struct ray *ray,
                                 float v[3][3])
{
    l->count = 0;
    switch (formula) {
    case TWIN_WOOP:
        return woop(l, ray, v);
    case TWIN_PLUECKER:
        return pluecker(l, ray, v);
    case TWIN_BALDWIN_WEBBER:
        return baldwin_webber(l, ray, v);
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

/* What a black box may do: as much as the worst published test in float32, and no more.
 *
 * That is Moeller and Trumbore's (1997): not backward stable, so that its error as a displacement
 * of vertices grows with the shape of the triangle. In exact arithmetic, with s from the origin to
 * one vertex, e1 and e2 from there to the others and [a, b, c] = a . (b x c),
 *   U = [s, d, e2]   V = [d, s, e1]   W = D - U - V   D = [e1, d, e2]   T = [e2, s, e1]
 * decide the hit, t = T / D, u = U / D, v = V / D. Each of the first 12 products of a determinant
 * passes at most 8 roundings: 2 differences of coordinates, 2 products, 3 sums, and one more in T.
 * So with k u a rounding and perm the same sum with every term positive
 *   |U^ - U| <= 8 k u perm(U)
 * up to second order, in whatever order sums are taken, fused or not (Higham 2002, section 3.3).
 * STEPS is 16: k = 2, either neighbour, as Vulkan allows, flushed or not. W^ has the errors of the
 * three; a test that multiplies by a reciprocal compares u + v with 1: DIVIDED u |D| more, of an
 * estimated reciprocal (5.5), two products by it (2) and a sum (2). Which vertex is the base is for
 * the tracer to choose: of each bound the largest of the three counts.
 *
 * As displacements: the edge function of an edge e is |d x e| times the distance of ray and edge
 * across the ray, so its error is worth |U^ - U| / |d x e|. Of an answered t, t^ D^ = T^ (1 + h),
 * so that |t^ D - T| <= |T^ - T| + |t^| (|D^ - D| + h |D|); that over |N| is the distance of the
 * ray's point at t^ to the triangle's plane, whatever angle they meet at and though D may be 0.
 * Likewise |u^ D - U| bounds u^. */
#include "ref/judge/judge_inner.h"

#include <math.h>

#define STEPS   16.0
#define DIVIDED 10.0
#ifndef TRANSFORM /* a test turns it */
/* Of kappa u (|o| + |T| + |hit|): what the transform of an engine may move. */
#define TRANSFORM 64.0
#endif
/* A product, sum or operand that is subnormal may be flushed. */
#define FLUSHED 0x1p-126
/* Products of three such, less 2^-24 of each on the way, are normal numbers. */
#define SAFE 0x1p-60

/* fmax and fmin, of which these are most of the calls in a judgement, without a call. */
static inline double larger(double a, double b)
{
    return a > b || isnan(b) ? a : b;
}

static inline double lesser(double a, double b)
{
    return a < b || isnan(b) ? a : b;
}

static double largest(const double a[3])
{
    return larger(fabs(a[0]), larger(fabs(a[1]), fabs(a[2])));
}

/* The bound of [a, b, c]: relative parts, and what is lost where numbers are flushed: of b x c
 * three operations and two operands a component, of its product with a five more and both. Where
 * every product is 0 or above SAFE nothing is: differences of such are 0 or 2^-24 of them. */
static double bound_of(const double a[3], const double b[3], const double c[3])
{
    double perm = 0.0, x = largest(a), y = largest(b), z = largest(c), least = INFINITY;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double pair[2] = {fabs(b[i] * c[j]), fabs(b[j] * c[i])};
        perm += fabs(a[k]) * (pair[0] + pair[1]);
        for (int p = 0; p < 2; p++) {
            if (pair[p] > 0.0)
                least = lesser(least, pair[p]);
            if (pair[p] > 0.0 && a[k] != 0.0)
                least = lesser(least, fabs(a[k]) * lesser(pair[p], 1.0));
        }
    }
    double tiny = least > SAFE ? 0.0 : 5.0 + 9.0 * x + 6.0 * x * (y + z) + 6.0 * y * z;
    return STEPS * JUDGE_UNIT * perm + FLUSHED * tiny;
}

/* The bounds with vertex `base` as the base. No bound depends on the sign of e2. */
static void widen(int base, struct judge_rounding *out)
{
    const struct ray_triangle *tri = &out->tri;
    int next = (base + 1) % 3, last = (base + 2) % 3;
    const double *s = tri->v[base], *d = tri->d, *e1 = tri->side[base], *e2 = tri->side[last];
    double u = bound_of(s, d, e2), w = bound_of(d, s, e1), det = bound_of(e1, d, e2);
    double third = u + w + det + DIVIDED * JUDGE_UNIT * fabs(out->det);
    out->edge_most[next] = larger(out->edge_most[next], u);
    out->edge_most[last] = larger(out->edge_most[last], w);
    out->edge_most[base] = larger(out->edge_most[base], third);
    out->det_most = larger(out->det_most, det);
    out->t_most = larger(out->t_most, bound_of(e2, s, e1));
}

/* The rest of a judge_rounding whose triangle is set. */
static void complete(struct judge_rounding *out)
{
    const struct ray_triangle *tri = &out->tri;
    out->det = judge_dot(tri->d, tri->n);
    out->t = judge_dot(tri->v[0], tri->n);
    for (int c = 0; c < 3; c++) {
        const double *side = tri->side[(c + 1) % 3];
        double beside[3], across[3];
        judge_cross(tri->v[(c + 1) % 3], side, beside);
        judge_cross(tri->d, side, across);
        out->edge[c] = judge_dot(tri->d, beside);
        out->across[c] = sqrt(judge_dot(across, across));
    }
    for (int base = 0; base < 3; base++)
        widen(base, out);
}

struct judge_rounding judge_rounding_of(const struct ray *ray, float v[3][3])
{
    struct judge_rounding out = {.tri = ray_triangle_of(ray, v)};
    complete(&out);
    return out;
}

/* An engine's ray in the space of a mesh may be off by TRANSFORM u kappa of the sizes that cancel
 * there, as a displacement in the world: docs/numerics.md, "Closed fans, and unpublished formulas".
 * The determinant is a sum of edge functions, each of which two vertices move. */
static void allow_transform(const struct judge *judge, const struct ray *ray,
                            const struct judge_at *at, struct judge_rounding *out)
{
    const struct instance *instance = &judge->world->instance[at->instance];
    double far = 0.0, across = 0.0;
    for (int k = 0; k < 3; k++) {
        double o = (double)ray->org[k], hit = 0.0;
        for (int c = 0; c < 3; c++)
            hit = fmax(hit, fabs(out->tri.v[c][k] + o));
        far = fmax(far, fabs(o) + fabs((double)instance->m[k][3]) + hit);
        across += out->across[k];
    }
    double moved = TRANSFORM * judge->place[at->instance].kappa * JUDGE_UNIT * far;
    out->extra = out->tri.unit > 0.0 ? moved / out->tri.unit : 0.0;
    out->det_most += 2.0 * moved * across;
}

static void through(const double w[9], double a[3])
{
    const double from[3] = {a[0], a[1], a[2]};
    for (int k = 0; k < 3; k++)
        a[k] = w[3 * k] * from[0] + w[3 * k + 1] * from[1] + w[3 * k + 2] * from[2];
}

/* The test runs in the space of the mesh, where other products cancel, and others are flushed, than
 * in the world. With M^-1 of the vectors every determinant is that of the world over det M, and so
 * are its bounds. */
static void allow_mesh(const struct judge *judge, const struct judge_at *at,
                       struct judge_rounding *out)
{
    const double *w = judge->place[at->instance].near;
    struct judge_rounding mesh = {.tri = out->tri};
    double inverse[3];
    judge_cross(w + 3, w + 6, inverse);
    const double size = fabs(1.0 / judge_dot(w, inverse)); /* |det M| */
    for (int c = 0; c < 3; c++) {
        through(w, mesh.tri.v[c]);
        through(w, mesh.tri.side[c]);
    }
    through(w, mesh.tri.d);
    mesh.det = out->det / size;
    for (int base = 0; base < 3; base++)
        widen(base, &mesh);
    for (int c = 0; c < 3; c++)
        out->edge_most[c] = fmax(out->edge_most[c], size * mesh.edge_most[c]);
    out->det_most = fmax(out->det_most, size * mesh.det_most);
    out->t_most = fmax(out->t_most, size * mesh.t_most);
}

struct judge_rounding judge_rounding_at(const struct judge *judge, const struct ray *ray,
                                        uint32_t prim)
{
    float v[3][3];
    judge_tri(judge, prim, v);
    if (!judge->world)
        return judge_rounding_of(ray, v);
    struct judge_at at = judge_locate(judge, prim);
    if (judge->place[at.instance].identity)
        return judge_rounding_of(ray, v);
    struct judge_rounding out = {
        .tri = ray_triangle_placed(ray, judge->world->instance[at.instance].m, v)};
    complete(&out);
    allow_mesh(judge, &at, &out);
    allow_transform(judge, ray, &at, &out);
    return out;
}

double judge_edge_distance(const struct judge_rounding *r, int c)
{
    return r->across[c] > 0.0 ? r->edge[c] / r->across[c] / r->tri.unit : 0.0;
}

double judge_unit_of_t(const struct judge_rounding *r)
{
    return r->tri.unit * r->tri.area / fabs(r->det);
}

double judge_edge_allowed(const struct judge *judge, const struct judge_rounding *r, int c)
{
    double scale = r->across[c] * r->tri.unit;
    return fmax(judge->displacement, scale > 0.0 ? r->edge_most[c] / scale : 0.0) + r->extra;
}

double judge_plane_allowed(const struct judge *judge, const struct judge_rounding *r, double t)
{
    double det = r->det_most + DIVIDED * JUDGE_UNIT * fabs(r->det);
    double scale = r->tri.area * r->tri.unit;
    double most = r->t_most + fabs(t) * det + FLUSHED * fabs(r->det);
    return fmax(judge->displacement, scale > 0.0 ? most / scale : 0.0) + r->extra;
}

bool judge_weight_allowed(const struct judge_rounding *r, int c, double weight)
{
    double det = r->det_most + DIVIDED * JUDGE_UNIT * fabs(r->det);
    double off = fabs(weight * r->det - r->edge[c]);
    double moved = 2.0 * r->extra * r->tri.unit * r->across[c];
    return off <= r->edge_most[c] + fabs(weight) * det + FLUSHED * fabs(r->det) + moved;
}

bool judge_det_is_open(const struct judge_rounding *r)
{
    return fabs(r->det) <= r->det_most;
}

bool judge_side_is_open(const struct judge *judge, const struct judge_rounding *r)
{
    double widest = fmax(r->across[0], fmax(r->across[1], r->across[2]));
    double moved = 2.0 * (judge->displacement + r->extra) * r->tri.unit;
    return judge_det_is_open(r) || fabs(r->det) <= moved * widest;
}

double judge_margin(const struct judge_rounding *r)
{
    double least = INFINITY;
    for (int c = 0; c < 3; c++)
        if (r->edge_most[c] > 0.0)
            least = fmin(least, fabs(r->edge[c]) / r->edge_most[c]);
    return least;
}

/* True if the determinant may have the sign `side` and every edge function with it. */
static bool may_have_sign(const struct judge *judge, const struct judge_rounding *r, double side)
{
    bool may = side * r->det >= -r->det_most;
    for (int c = 0; c < 3; c++) {
        double most = judge_edge_allowed(judge, r, c) * r->across[c] * r->tri.unit;
        may = may && side * r->edge[c] >= -most;
    }
    return may;
}

bool judge_may_accept(const struct judge *judge, const struct judge_rounding *r)
{
    /* Else the determinant is 0 in every evaluation, as of three equal vertices. That of two equal
     * ones, or of three in a line, may get any sign by rounding. */
    bool det = fabs(r->det) + r->det_most > 0.0;
    return det && (may_have_sign(judge, r, 1.0) || may_have_sign(judge, r, -1.0));
}

/* True if the allowance moves the plane to a point of the ray between these two: an end, or the
 * one nearest to the plane. The determinant is not 0: of an endless range the quotient is NaN. */
static bool may_reach(const struct judge *judge, const struct judge_rounding *r, double from,
                      double to)
{
    double least = INFINITY, at[3] = {from, to, fmin(fmax(r->t / r->det, from), to)};
    for (int i = 0; i < 3; i++) {
        double off = fabs(at[i] * r->det - r->t) / (r->tri.area * r->tri.unit);
        least = fmin(least, off / judge_plane_allowed(judge, r, at[i]));
    }
    return least <= 1.0;
}

bool judge_may_be_hit(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    struct judge_rounding r = judge_rounding_at(judge, ray, prim);
    return judge_may_accept(judge, &r) &&
           (judge_det_is_open(&r) || may_reach(judge, &r, (double)ray->tmin, (double)ray->tmax));
}

#include "ref/oracle/pair.h"

#include "ref/oracle/internal.h"
#include "ref/oracle/placed_filter.h"

#include <math.h>
#include <string.h>

/* Relative width of an enclosure of a t in range, at most; wider ones are computed again from
 * integers. The tree relies on it (ref/oracle/oracle_tree.h). */
#define NARROW 0x1p-40
/* So that the margin of a hit is known to about 2^-18 of itself, its w and D are known better. */
#define KNOWN 0x1p-20

/* Widening of an end of an enclosure: a sum, a difference and a quotient are rounded. */
#define ENCLOSE_PAD 0x1p-50

/* Encloses num / den; the sign of den is proven. */
static void enclose_ratio(double num, double num_err, double den, double den_err, double *lo,
                          double *hi)
{
    double t = fabs(num), d = fabs(den);
    double most = (t + num_err) / (d - den_err) * (1 + ENCLOSE_PAD);
    double least = t < num_err ? -most : (t - num_err) / (d + den_err) * (1 - ENCLOSE_PAD);
    bool positive = !signbit(num) == !signbit(den);
    *lo = positive ? least : -most;
    *hi = positive ? most : -least;
}

static void enclose(const struct filter *f, double *lo, double *hi)
{
    enclose_ratio(f->t, f->t_err, f->det, f->det_err, lo, hi);
}

/* Fills in what the filter proves; false if that is not everything. */
static bool by_filter(const struct ray *ray, const struct filter *f, struct oracle_pair *pair)
{
    double share = INFINITY;
    pair->det = filter_sign(f->det, f->det_err);
    bool certain = pair->det != 0, inside = true, known = f->det_err <= KNOWN * fabs(f->det);
    for (int c = 0; c < 3; c++) {
        pair->edge[c] = filter_sign(f->w[c], f->w_err[c]);
        certain = certain && pair->edge[c] != 0;
        inside = inside && pair->edge[c] == pair->det;
        known = known && f->w_err[c] <= KNOWN * fabs(f->w[c]);
        share = fmin(share, f->w[c] / f->det);
    }
    if (!certain)
        return false;
    pair->margin = share;
    pair->by_filter = true;
    pair->class = inside ? ORACLE_INSIDE : ORACLE_MISS;
    if (!inside)
        return true;
    if (!known || filter_sign(f->t, f->t_err) == 0)
        return false;
    double lo, hi, tmin = (double)ray->tmin, tmax = (double)ray->tmax;
    enclose(f, &lo, &hi);
    pair->t_lo = lo;
    pair->t_hi = hi;
    pair->range = hi < tmin ? ORACLE_BELOW : lo > tmax ? ORACLE_ABOVE : ORACLE_WITHIN;
    if (pair->range != ORACLE_WITHIN)
        return true;
    return lo > tmin && hi < tmax && hi - lo <= NARROW * fmin(fabs(lo), fabs(hi));
}

/* Where t in [lo, hi] lies; its fraction is compared only if the enclosure leaves it open. */
static enum oracle_range range_of(const struct fraction *t, double lo, double hi,
                                  const struct ray *ray)
{
    double tmin = (double)ray->tmin, tmax = (double)ray->tmax;
    if (hi < tmin)
        return ORACLE_BELOW;
    if (lo > tmin && (hi < tmax || lo > tmax))
        return hi < tmax ? ORACLE_WITHIN : ORACLE_ABOVE;
    int low = fraction_compare_double(t, tmin);
    if (low < 0)
        return ORACLE_BELOW;
    if (low == 0 && ray->tmin <= ray->tmax)
        return ORACLE_AT_TMIN;
    int high = fraction_compare_double(t, tmax);
    return high < 0 ? ORACLE_WITHIN : high == 0 ? ORACLE_AT_TMAX : ORACLE_ABOVE;
}

static void in_plane(const struct ray *ray, float v[3][3], const struct instance *at,
                     struct oracle_pair *pair)
{
    struct fraction in, out;
    double tmin = (double)ray->tmin, tmax = (double)ray->tmax, in_hi, out_lo;
    if (!exact_in_plane(ray, v, at, &in, &out))
        return;
    pair->class = ORACLE_IN_PLANE;
    pair->margin = 0;
    fraction_enclose(&in, &pair->t_lo, &in_hi);
    fraction_enclose(&out, &out_lo, &pair->t_hi);
    if (!(out_lo >= tmin) && fraction_compare_double(&out, tmin) < 0)
        return; /* it is below, as before anything was known */
    if (!(in_hi <= tmax) && fraction_compare_double(&in, tmax) > 0) {
        pair->range = ORACLE_ABOVE;
    } else {
        pair->range = ORACLE_WITHIN;
        pair->t_lo = fmax(pair->t_lo, tmin);
        pair->t_hi = fmin(pair->t_hi, tmax);
    }
}

static void by_integers(const struct ray *ray, float v[3][3], bool flat, bool hits,
                        struct decided *out)
{
    struct oracle_pair *pair = &out->pair;
    const struct exact *exact = &out->exact;
    int positive = 0, negative = 0;
    exact_pair(ray, v, out->at.instance, hits, &out->exact);
    out->have_exact = true;
    pair->by_filter = false;
    pair->det = exact->det;
    pair->margin = exact->edge_share;
    for (int c = 0; c < 3; c++) {
        pair->edge[c] = exact->edge[c];
        positive += exact->edge[c] > 0;
        negative += exact->edge[c] < 0;
    }
    if (flat) {
        pair->class = ORACLE_ZERO_AREA;
    } else if (exact->in_plane) {
        in_plane(ray, v, out->at.instance, pair);
    } else if (exact->det != 0 && (positive == 0 || negative == 0)) {
        static const enum oracle_class by_sides[] = {
            [1] = ORACLE_VERTEX, [2] = ORACLE_EDGE, [3] = ORACLE_INSIDE};
        pair->class = by_sides[positive + negative];
        fraction_enclose(&exact->t, &pair->t_lo, &pair->t_hi);
        pair->range = range_of(&exact->t, pair->t_lo, pair->t_hi, ray);
    }
}

/* True if t is certainly out of the range of the ray, whatever the signs of the edges are. */
static bool out_of_range(const struct ray *ray, const struct filter *f)
{
    double lo, hi;
    if (filter_sign(f->det, f->det_err) == 0 || filter_sign(f->t, f->t_err) == 0)
        return false;
    enclose(f, &lo, &hi);
    return hi < (double)ray->tmin || lo > (double)ray->tmax;
}

/* Before anything is known. */
static void start(enum oracle_class class, struct oracle_pair *pair)
{
    pair->class = class;
    pair->range = ORACLE_BELOW;
    pair->t_lo = -INFINITY;
    pair->t_hi = INFINITY;
}

struct located pair_locate(const struct oracle *oracle, uint32_t prim)
{
    const struct placing *placing = oracle->placing;
    if (!placing)
        return (struct located){oracle, NULL, prim};
    return placing_locate(placing, world_instance_of(placing->world, prim), prim);
}

/* The rest of pair_decide, for one kind of filter or the other. */
static inline void decide(const struct ray *ray, float v[3][3], enum pair_depth depth,
                          struct decided *out, struct oracle_stats *stats)
{
    struct placed_filter placed;
    struct filter *filter = &placed.filter;
    const struct instance *at = out->at.instance;
    bool flat = out->pair.class == ORACLE_ZERO_AREA, positive = false, negative = false;
    if (at)
        placed_edges(ray, v, at, &placed);
    else
        filter_edges(ray, v, filter);
    for (int c = 0; c < 3; c++) {
        positive |= filter_sign(filter->w[c], filter->w_err[c]) > 0;
        negative |= filter_sign(filter->w[c], filter->w_err[c]) < 0;
    }
    if (depth == PAIR_HITS && positive && negative)
        return;
    if (at)
        placed_plane(&placed);
    else
        filter_plane(filter);
    bool known = !flat && (!at || placed_is_moderate(&placed));
    if (known && by_filter(ray, filter, &out->pair))
        return;
    if (known && depth == PAIR_HITS && out_of_range(ray, filter)) {
        out->pair.class = ORACLE_MISS;
        return;
    }
    start(ORACLE_MISS, &out->pair);
    by_integers(ray, v, flat, depth == PAIR_HITS, out);
    if (stats) {
        stats->undecided++;
        stats->wide += out->exact.wide;
    }
}

void pair_decide(const struct located *at, const struct ray *ray, uint32_t prim,
                 enum pair_depth depth, struct decided *out, struct oracle_stats *stats)
{
    float v[3][3];
    bool flat = at->mesh->flat[at->tri];
    out->prim = prim;
    out->at = *at;
    out->have_exact = false;
    start(flat ? ORACLE_ZERO_AREA : ORACLE_MISS, &out->pair);
    out->pair.margin = -INFINITY;
    if (flat && depth == PAIR_HITS)
        return;
    scene_tri(at->mesh->scene, at->tri, v);
    decide(ray, v, depth, out, stats);
}

const struct fraction *pair_t(const struct ray *ray, struct decided *hit)
{
    if (!hit->have_exact) {
        float v[3][3];
        scene_tri(hit->at.mesh->scene, hit->at.tri, v);
        exact_pair(ray, v, hit->at.instance, true, &hit->exact);
        hit->have_exact = true;
    }
    return &hit->exact.t;
}

bool pair_weights(const struct ray *ray, const struct located *at, struct enclosure *u,
                  struct enclosure *v)
{
    struct placed_filter placed;
    struct filter *f = &placed.filter;
    float vertex[3][3];
    scene_tri(at->mesh->scene, at->tri, vertex);
    if (at->instance) {
        placed_edges(ray, vertex, at->instance, &placed);
        placed_plane(&placed);
        if (!placed_is_moderate(&placed))
            return false;
    } else {
        filter_edges(ray, vertex, f);
        filter_plane(f);
    }
    if (filter_sign(f->det, f->det_err) == 0)
        return false;
    enclose_ratio(f->w[1], f->w_err[1], f->det, f->det_err, &u->lo, &u->hi);
    enclose_ratio(f->w[2], f->w_err[2], f->det, f->det_err, &v->lo, &v->hi);
    return true;
}

/* Whether all six vertices of two triangles have coordinate k in common. */
static bool share_coordinate(float v[2][3][3], int k)
{
    bool same = true;
    for (int n = 0; n < 2; n++)
        for (int c = 0; c < 3; c++)
            same = same && v[n][c][k] == v[0][0][k];
    return same;
}

/* Whether two triangles are in one space: a scene's, or placed by one instance or by two of the
 * same transform. */
static bool same_space(const struct instance *a, const struct instance *b)
{
    return a == b || (a && b && memcmp(a->m, b->m, sizeof a->m) == 0);
}

/* Whether two hits are in one place by their triangles alone, and so have the same t: in a plane
 * across an axis that holds both; or inside the same face, the triangle, edge or vertex that they
 * share, which is given by the vertices whose w is not 0. The line meets each of these in one
 * point, since no D is 0. What is one place in the space of a mesh is one where it is placed. False
 * proves nothing. */
static bool same_place(const struct decided *a, const struct decided *b)
{
    float v[2][3][3];
    if (!same_space(a->at.instance, b->at.instance))
        return false;
    scene_tri(b->at.mesh->scene, b->at.tri, v[0]);
    scene_tri(a->at.mesh->scene, a->at.tri, v[1]);
    if (share_coordinate(v, 0) || share_coordinate(v, 1) || share_coordinate(v, 2))
        return true;
    if (a->pair.class != b->pair.class)
        return false;
    for (int i = 0; i < 3; i++) {
        bool shared = a->pair.edge[i] == 0;
        for (int j = 0; j < 3 && !shared; j++)
            shared = b->pair.edge[j] != 0 && v[1][i][0] == v[0][j][0] && v[1][i][1] == v[0][j][1] &&
                     v[1][i][2] == v[0][j][2];
        if (!shared)
            return false;
    }
    return true;
}

int pair_order(const struct ray *ray, struct decided *a, struct decided *b)
{
    if (a->pair.t_lo > b->pair.t_hi)
        return 1;
    if (a->pair.t_hi < b->pair.t_lo)
        return -1;
    if (same_place(a, b))
        return 0;
    return fraction_compare(pair_t(ray, a), pair_t(ray, b));
}

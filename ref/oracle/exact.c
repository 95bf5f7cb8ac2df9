#include "ref/oracle/exact.h"

#include "ref/integers/oracle_grid.h"
#include "ref/oracle/medium.h"
#include "ref/oracle/small.h"

#include <math.h>

/* Units as in ref/oracle/small.h. */
struct exact_input {
    struct oracle_grid place, way;
    struct odd o[3], d[3], v[3][3];
};

static void read_input(const struct ray *ray, float v[3][3], struct exact_input *in)
{
    struct odd all[12];
    for (int k = 0; k < 3; k++) {
        in->o[k] = all[k] = odd_of(ray->org[k]);
        in->d[k] = odd_of(ray->dir[k]);
        for (int c = 0; c < 3; c++)
            in->v[c][k] = all[3 + 3 * c + k] = odd_of(v[c][k]);
    }
    in->place = grid_of(all, 12);
    in->way = grid_of(in->d, 3);
}

/* The products, by either kind of integer. */
struct products {
    struct oracle_wide w[3], det, t;
    int scale;
};

/* --- wide --------------------------------------------------------------------------------------
 */

/* x * y - z * u */
static void cross_term(const struct oracle_wide *x, const struct oracle_wide *y,
                       const struct oracle_wide *z, const struct oracle_wide *u,
                       struct oracle_wide *out)
{
    struct oracle_wide left, right;
    wide_mul(x, y, &left);
    wide_mul(z, u, &right);
    wide_sub(&left, &right, out);
}

static void wide_triple(const struct oracle_wide x[3], const struct oracle_wide y[3],
                        const struct oracle_wide z[3], struct oracle_wide *out)
{
    wide_set(0, out);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        struct oracle_wide minor, term;
        cross_term(&y[i], &z[j], &y[j], &z[i], &minor);
        wide_mul(&x[k], &minor, &term);
        wide_add(out, &term, out);
    }
}

static int bits_of(unsigned __int128 x)
{
    uint64_t above = (uint64_t)(x >> 64), below = (uint64_t)x;
    return above ? 128 - __builtin_clzll(above) : below ? 64 - __builtin_clzll(below) : 0;
}

/* The same numbers for ref/oracle/medium.h; returns false if they take too many bits. */
static bool medium_input(const struct exact_input *in, struct medium_input *out)
{
    unsigned __int128 place = 0, way = 0;
    if (in->place.bits > 120 || in->way.bits > 120)
        return false;
    for (int k = 0; k < 3; k++) {
        __int128 o = grid_int(in->place, in->o[k]), d = grid_int(in->way, in->d[k]);
        out->d[k] = d;
        way |= (unsigned __int128)(d < 0 ? -d : d);
        for (int c = 0; c < 3; c++) {
            __int128 a = grid_int(in->place, in->v[c][k]) - o;
            out->a[c][k] = a;
            place |= (unsigned __int128)(a < 0 ? -a : a);
        }
    }
    out->place_bits = bits_of(place);
    out->way_bits = bits_of(way);
    return true;
}

/* Vertices relative to the origin, and the direction, all as wide. */
static void wide_input(const struct exact_input *in, struct oracle_wide a[3][3],
                       struct oracle_wide d[3])
{
    for (int k = 0; k < 3; k++) {
        struct oracle_wide o;
        grid_wide(in->place, in->o[k], &o);
        grid_wide(in->way, in->d[k], &d[k]);
        for (int c = 0; c < 3; c++) {
            grid_wide(in->place, in->v[c][k], &a[c][k]);
            wide_sub(&a[c][k], &o, &a[c][k]);
        }
    }
}

static void wide_products(const struct ray *ray, float v[3][3], struct products *out)
{
    struct exact_input in;
    struct oracle_wide a[3][3], d[3];
    struct medium_input medium;
    struct medium_products product;
    read_input(ray, v, &in);
    out->scale = in.place.exponent - in.way.exponent;
    if (medium_input(&in, &medium) && medium_multiply(&medium, &product)) {
        for (int c = 0; c < 3; c++)
            medium_wide(&product.w[c], &out->w[c]);
        medium_wide(&product.det, &out->det);
        medium_wide(&product.t, &out->t);
        return;
    }
    wide_input(&in, a, d);
    wide_set(0, &out->det);
    for (int c = 0; c < 3; c++) {
        wide_triple(d, a[(c + 1) % 3], a[(c + 2) % 3], &out->w[c]);
        wide_add(&out->det, &out->w[c], &out->det);
    }
    wide_triple(a[0], a[1], a[2], &out->t);
}

/* --- a pair ------------------------------------------------------------------------------------
 */

static double share(const struct oracle_wide *w, const struct oracle_wide *det)
{
    uint64_t w_top, det_top;
    int w_exponent, det_exponent;
    if (w->sign == 0)
        return 0;
    wide_top(w, &w_top, &w_exponent);
    wide_top(det, &det_top, &det_exponent);
    double size = times_power((double)w_top / (double)det_top, w_exponent - det_exponent);
    return w->sign == det->sign ? size : -size;
}

/* Signs of w and D; returns whether two w have opposite ones: a miss, since in the plane of an area
 * all are 0. */
static bool take_signs(const int edge[3], int det, struct exact *out)
{
    bool positive = false, negative = false;
    out->det = det;
    out->edge_share = det ? INFINITY : -INFINITY;
    out->in_plane = false;
    for (int c = 0; c < 3; c++) {
        out->edge[c] = edge[c];
        positive |= edge[c] > 0;
        negative |= edge[c] < 0;
    }
    return positive && negative;
}

/* Of a hit: whether it is on an edge or a vertex. */
static bool on_border(const struct exact *pair)
{
    return pair->edge[0] == 0 || pair->edge[1] == 0 || pair->edge[2] == 0;
}

static int sign_of(__int128 x)
{
    return (x > 0) - (x < 0);
}

/* Returns whether more than the signs is needed. */
static bool multiply(const struct ray *ray, float v[3][3], bool hits, struct exact *out,
                     struct products *value)
{
    struct small small;
    struct small_products product;
    out->wide = !small_make(ray, v, &small) || !small_multiply(&small, &product);
    if (out->wide) {
        wide_products(ray, v, value);
        const int edge[3] = {value->w[0].sign, value->w[1].sign, value->w[2].sign};
        return !take_signs(edge, value->det.sign, out) || !hits;
    }
    const int edge[3] = {sign_of(product.w[0]), sign_of(product.w[1]), sign_of(product.w[2])};
    if (take_signs(edge, sign_of(product.det), out) && hits)
        return false;
    for (int c = 0; c < 3 && !(hits && on_border(out)); c++)
        wide_set(product.w[c], &value->w[c]);
    wide_set(product.det, &value->det);
    wide_set(product.t, &value->t);
    value->scale = small.scale;
    return true;
}

void exact_pair(const struct ray *ray, float v[3][3], bool hits, struct exact *out)
{
    struct products value;
    if (!multiply(ray, v, hits, out, &value))
        return;
    if (out->det && hits && on_border(out)) /* the others are positive */
        out->edge_share = 0;
    else if (out->det)
        for (int c = 0; c < 3; c++)
            out->edge_share = fmin(out->edge_share, share(&value.w[c], &value.det));
    out->in_plane = out->det == 0 && value.t.sign == 0 && !ray_is_still(ray);
    if (out->det) {
        wide_copy(&value.t, &out->t.num);
        wide_copy(&value.det, &out->t.den);
        out->t.scale = value.scale;
    }
}

/* --- in the plane ------------------------------------------------------------------------------
 */

static void normal_of(const struct oracle_wide a[3][3], struct oracle_wide n[3])
{
    struct oracle_wide e1[3], e2[3];
    for (int k = 0; k < 3; k++) {
        wide_sub(&a[1][k], &a[0][k], &e1[k]);
        wide_sub(&a[2][k], &a[0][k], &e2[k]);
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        cross_term(&e1[i], &e2[j], &e1[j], &e2[i], &n[k]);
    }
}

/* Widens [in, out] by one point of the overlap. */
static void include(const struct fraction *t, bool *any, struct fraction *in, struct fraction *out)
{
    if (!*any || fraction_compare(t, in) < 0)
        *in = *t;
    if (!*any || fraction_compare(t, out) > 0)
        *out = *t;
    *any = true;
}

bool exact_in_plane(const struct ray *ray, float v[3][3], struct fraction *in, struct fraction *out)
{
    struct exact_input input;
    struct small small;
    struct oracle_wide a[3][3], d[3], n[3], side[3];
    bool any = false;
    if (small_make(ray, v, &small) && small_in_plane(&small, &any, in, out))
        return any;
    read_input(ray, v, &input);
    wide_input(&input, a, d);
    normal_of(a, n);
    /* Drop an axis along which the plane is not seen edge-on: the projection is one to one, so the
     * direction stays nonzero, and one of the two axes can measure t. */
    int drop = n[0].sign ? 0 : n[1].sign ? 1 : 2;
    int i = (drop + 1) % 3, j = (drop + 2) % 3, measure = d[i].sign ? i : j;
    for (int c = 0; c < 3; c++)
        cross_term(&d[i], &a[c][j], &d[j], &a[c][i], &side[c]);
    struct fraction t = {.scale = input.place.exponent - input.way.exponent};
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3;
        if (side[c].sign == 0) { /* the vertex is on the line */
            t.num = a[c][measure];
            t.den = d[measure];
            include(&t, &any, in, out);
        } else if (side[c].sign == -side[e].sign) {
            /* The edge crosses it, where a_c + (a_e - a_c) * side_c / (side_c - side_e) is. */
            struct oracle_wide span;
            cross_term(&a[e][measure], &side[c], &a[c][measure], &side[e], &t.num);
            wide_sub(&side[c], &side[e], &span);
            wide_mul(&span, &d[measure], &t.den);
            include(&t, &any, in, out);
        }
    }
    return any;
}

bool exact_no_area(float v[3][3])
{
    struct ray at_origin = {.tmax = 0};
    struct exact_input in;
    struct oracle_wide a[3][3], d[3], n[3];
    read_input(&at_origin, v, &in);
    wide_input(&in, a, d);
    normal_of(a, n);
    return n[0].sign == 0 && n[1].sign == 0 && n[2].sign == 0;
}

#include "ref/oracle/exact.h"

#include "ref/integers/oracle_grid.h"
#include "ref/oracle/exact_input.h"

#include <float.h>
#include <math.h>

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

static void wide_products(const struct ray *ray, float v[3][3], const struct instance *at,
                          struct products *out)
{
    struct wide_input in;
    struct medium_input medium;
    struct medium_products product;
    if (input_medium(ray, v, at, &medium, &out->scale) && medium_multiply(&medium, &product)) {
        for (int c = 0; c < 3; c++)
            medium_wide(&product.w[c], &out->w[c]);
        medium_wide(&product.det, &out->det);
        medium_wide(&product.t, &out->t);
        return;
    }
    input_wide(ray, v, at, &in, &out->scale);
    wide_set(0, &out->det);
    for (int c = 0; c < 3; c++) {
        wide_triple(in.d, in.a[(c + 1) % 3], in.a[(c + 2) % 3], &out->w[c]);
        wide_add(&out->det, &out->w[c], &out->det);
    }
    wide_triple(in.a[0], in.a[1], in.a[2], &out->t);
}

/* --- a pair ------------------------------------------------------------------------------------
 */

/* w / D; what no double holds comes as the double next to it. */
static double share(const struct oracle_wide *w, const struct oracle_wide *det)
{
    uint64_t w_top, det_top;
    int w_exponent, det_exponent;
    if (w->sign == 0)
        return 0;
    wide_top(w, &w_top, &w_exponent);
    wide_top(det, &det_top, &det_exponent);
    double size = times_power((double)w_top / (double)det_top, w_exponent - det_exponent);
    size = fmin(fmax(size, DBL_TRUE_MIN), DBL_MAX);
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

/* Returns whether more than the signs is needed. */
static bool multiply(const struct ray *ray, float v[3][3], const struct instance *at, bool hits,
                     struct exact *out, struct products *value)
{
    struct small small;
    struct small_products product;
    out->wide =
        !input_small(ray, v, at, &small, &value->scale) || !small_multiply(&small, &product);
    if (out->wide) {
        wide_products(ray, v, at, value);
        const int edge[3] = {value->w[0].sign, value->w[1].sign, value->w[2].sign};
        return !take_signs(edge, value->det.sign, out) || !hits;
    }
    const int edge[3] = {sign_of(product.w[0]), sign_of(product.w[1]), sign_of(product.w[2])};
    if (take_signs(edge, sign_of(product.det), out) && hits)
        return false;
    for (int c = 0; c < 3; c++)
        wide_set(product.w[c], &value->w[c]);
    wide_set(product.det, &value->det);
    wide_set(product.t, &value->t);
    return true;
}

void exact_pair(const struct ray *ray, float v[3][3], const struct instance *at, bool hits,
                struct exact *out)
{
    struct products value;
    if (!multiply(ray, v, at, hits, out, &value))
        return;
    if (out->det)
        for (int c = 0; c < 3; c++)
            out->edge_share = fmin(out->edge_share, share(&value.w[c], &value.det));
    out->in_plane = out->det == 0 && value.t.sign == 0 && !ray_is_still(ray);
    if (out->det) {
        wide_copy(&value.t, &out->t.num);
        wide_copy(&value.det, &out->t.den);
        out->t.scale = value.scale;
    }
}

void exact_weights(const struct ray *ray, float v[3][3], const struct instance *at,
                   struct fraction out[2])
{
    struct exact exact;
    struct products value;
    multiply(ray, v, at, false, &exact, &value);
    for (int i = 0; i < 2; i++) {
        wide_copy(&value.w[i + 1], &out[i].num);
        wide_copy(&value.det, &out[i].den);
        out[i].scale = 0;
    }
}

/* --- in the plane ------------------------------------------------------------------------------
 */

static void normal_of(struct oracle_wide a[3][3], struct oracle_wide n[3])
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

bool exact_in_plane(const struct ray *ray, float v[3][3], const struct instance *at,
                    struct fraction *in, struct fraction *out)
{
    struct wide_input input;
    struct small small;
    struct oracle_wide n[3], side[3], (*a)[3] = input.a, *d = input.d;
    struct fraction t;
    bool any = false;
    if (input_small(ray, v, at, &small, &t.scale) && small_in_plane(&small, &any, in, out))
        return any;
    input_wide(ray, v, at, &input, &t.scale);
    normal_of(a, n);
    /* Drop an axis along which the plane is not seen edge-on: the projection is one to one, so the
     * direction stays nonzero, and one of the two axes can measure t. */
    int drop = n[0].sign ? 0 : n[1].sign ? 1 : 2;
    int i = (drop + 1) % 3, j = (drop + 2) % 3, measure = d[i].sign ? i : j;
    for (int c = 0; c < 3; c++)
        cross_term(&d[i], &a[c][j], &d[j], &a[c][i], &side[c]);
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3;
        if (side[c].sign == 0) { /* the vertex is on the line */
            t.num = a[c][measure];
            t.den = d[measure];
            overlap_add(&t, &any, in, out);
        } else if (side[c].sign == -side[e].sign) {
            /* The edge crosses it, where a_c + (a_e - a_c) * side_c / (side_c - side_e) is. */
            struct oracle_wide span;
            cross_term(&a[e][measure], &side[c], &a[c][measure], &side[e], &t.num);
            wide_sub(&side[c], &side[e], &span);
            wide_mul(&span, &d[measure], &t.den);
            overlap_add(&t, &any, in, out);
        }
    }
    return any;
}

bool exact_no_area(float v[3][3])
{
    struct ray at_origin = {.tmax = 0};
    struct wide_input in;
    struct oracle_wide n[3];
    int scale;
    input_wide(&at_origin, v, NULL, &in, &scale);
    normal_of(in.a, n);
    return n[0].sign == 0 && n[1].sign == 0 && n[2].sign == 0;
}

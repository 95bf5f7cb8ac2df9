#include "ref/oracle/exact.h"

#include "ref/oracle/grid.h"

#include <math.h>

/* Vertices and origin share one grid, the direction has its own: with P the coordinates' unit and
 * Q the direction's, w and D come in units of P^2 Q, T in units of P^3, so that t = T / D * P / Q.
 */
struct input {
    struct grid place, way;
    struct odd o[3], d[3], v[3][3];
};

static void read_input(const struct ray *ray, float v[3][3], struct input *in)
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

/* --- __int128 --------------------------------------------------------------------------------- */

static int bits_of(int64_t x)
{
    return x ? 64 - __builtin_clzll((unsigned long long)(x < 0 ? -x : x)) : 0;
}

static __int128 triple(const int64_t x[3], const int64_t y[3], const int64_t z[3])
{
    __int128 sum = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sum += x[k] * ((__int128)y[i] * z[j] - (__int128)y[j] * z[i]);
    }
    return sum;
}

/* Values that both kinds of integer end in. */
struct products {
    struct wide w[3], det, t;
};

/* Vertices relative to the origin, and the direction, in their units; how many bits they take. */
struct small_input {
    int64_t a[3][3], d[3];
    int place_bits, way_bits;
};

/* Returns false if the exponents lie too far apart. */
static bool small_input(const struct input *in, struct small_input *out)
{
    *out = (struct small_input){.place_bits = 0};
    if (in->place.bits > 60 || in->way.bits > 60)
        return false;
    for (int k = 0; k < 3; k++) {
        int64_t o = grid_int(in->place, in->o[k]);
        out->d[k] = grid_int(in->way, in->d[k]);
        out->way_bits = bits_of(out->d[k]) > out->way_bits ? bits_of(out->d[k]) : out->way_bits;
        for (int c = 0; c < 3; c++) {
            int64_t a = grid_int(in->place, in->v[c][k]) - o;
            out->a[c][k] = a;
            out->place_bits = bits_of(a) > out->place_bits ? bits_of(a) : out->place_bits;
        }
    }
    return true;
}

/* Sums: |w| <= 6 * 2^(b_d + 2 b_p), |D| <= 18 * the same, |T| <= 6 * 2^(3 b_p); all below 2^127
 * under the conditions tested here. Returns false if they do not hold. */
static bool small_products(const struct input *in, struct products *out)
{
    struct small_input s;
    if (!small_input(in, &s) || s.way_bits + 2 * s.place_bits > 122 || 3 * s.place_bits > 124)
        return false;
    __int128 det = 0;
    for (int c = 0; c < 3; c++) {
        __int128 w = triple(s.d, s.a[(c + 1) % 3], s.a[(c + 2) % 3]);
        wide_set(w, &out->w[c]);
        det += w;
    }
    wide_set(det, &out->det);
    wide_set(triple(s.a[0], s.a[1], s.a[2]), &out->t);
    return true;
}

/* --- wide --------------------------------------------------------------------------------------
 */

/* x * y - z * u */
static void cross_term(const struct wide *x, const struct wide *y, const struct wide *z,
                       const struct wide *u, struct wide *out)
{
    struct wide left, right;
    wide_mul(x, y, &left);
    wide_mul(z, u, &right);
    wide_sub(&left, &right, out);
}

static void wide_triple(const struct wide x[3], const struct wide y[3], const struct wide z[3],
                        struct wide *out)
{
    wide_set(0, out);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        struct wide minor, term;
        cross_term(&y[i], &z[j], &y[j], &z[i], &minor);
        wide_mul(&x[k], &minor, &term);
        wide_add(out, &term, out);
    }
}

/* Vertices relative to the origin, and the direction, all as wide. */
static void wide_input(const struct input *in, struct wide a[3][3], struct wide d[3])
{
    for (int k = 0; k < 3; k++) {
        struct wide o;
        grid_wide(in->place, in->o[k], &o);
        grid_wide(in->way, in->d[k], &d[k]);
        for (int c = 0; c < 3; c++) {
            grid_wide(in->place, in->v[c][k], &a[c][k]);
            wide_sub(&a[c][k], &o, &a[c][k]);
        }
    }
}

static void wide_products(const struct input *in, struct products *out)
{
    struct wide a[3][3], d[3];
    wide_input(in, a, d);
    wide_set(0, &out->det);
    for (int c = 0; c < 3; c++) {
        wide_triple(d, a[(c + 1) % 3], a[(c + 2) % 3], &out->w[c]);
        wide_add(&out->det, &out->w[c], &out->det);
    }
    wide_triple(a[0], a[1], a[2], &out->t);
}

/* --- a pair ------------------------------------------------------------------------------------
 */

static double share(const struct wide *w, const struct wide *det)
{
    uint64_t w_top, det_top;
    int w_exponent, det_exponent;
    if (w->sign == 0)
        return 0;
    wide_top(w, &w_top, &w_exponent);
    wide_top(det, &det_top, &det_exponent);
    double size = ldexp((double)w_top / (double)det_top, w_exponent - det_exponent);
    return w->sign == det->sign ? size : -size;
}

void exact_pair(const struct ray *ray, float v[3][3], bool hits, struct exact *out)
{
    struct input in;
    struct products value;
    int positive = 0, negative = 0;
    read_input(ray, v, &in);
    out->wide = !small_products(&in, &value);
    if (out->wide)
        wide_products(&in, &value);
    out->det = value.det.sign;
    out->edge_share = out->det ? INFINITY : -INFINITY;
    for (int c = 0; c < 3; c++) {
        out->edge[c] = value.w[c].sign;
        positive += value.w[c].sign > 0;
        negative += value.w[c].sign < 0;
    }
    out->in_plane = false;
    if (hits && positive && negative) /* a miss; in the plane of an area all w are 0 */
        return;
    for (int c = 0; c < 3 && out->det; c++)
        out->edge_share = fmin(out->edge_share, share(&value.w[c], &value.det));
    out->in_plane = out->det == 0 && value.t.sign == 0 && in.way.bits > 0;
    if (out->det) {
        out->t.num = value.t;
        out->t.den = value.det;
        out->t.scale = in.place.exponent - in.way.exponent;
    }
}

/* --- in the plane ------------------------------------------------------------------------------
 */

static void normal_of(const struct wide a[3][3], struct wide n[3])
{
    struct wide e1[3], e2[3];
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

/* exact_in_plane in __int128. |d| < 2^60 and |a| < 2^61, so that sides and normals stay below
 * 2^126; the ends of the overlap are made of products of three. Returns false if they do not fit;
 * else *any says whether there is an overlap. */
static bool small_in_plane(const struct input *input, bool *any, struct fraction *in,
                           struct fraction *out)
{
    struct small_input s;
    __int128 n[3], side[3];
    int positive = 0, negative = 0;
    if (!small_input(input, &s))
        return false;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (__int128)(s.a[1][i] - s.a[0][i]) * (s.a[2][j] - s.a[0][j]) -
               (__int128)(s.a[1][j] - s.a[0][j]) * (s.a[2][i] - s.a[0][i]);
    }
    int drop = n[0] ? 0 : n[1] ? 1 : 2, i = (drop + 1) % 3, j = (drop + 2) % 3;
    for (int c = 0; c < 3; c++) {
        side[c] = (__int128)s.d[i] * s.a[c][j] - (__int128)s.d[j] * s.a[c][i];
        positive += side[c] > 0;
        negative += side[c] < 0;
    }
    *any = false;
    if (positive == 3 || negative == 3)
        return true;
    if (2 * s.place_bits + s.way_bits > 122 || s.place_bits + 2 * s.way_bits > 122)
        return false;
    int measure = s.d[i] ? i : j;
    struct fraction t = {.scale = input->place.exponent - input->way.exponent};
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3;
        bool on = side[c] == 0,
             crosses = (side[c] < 0 && side[e] > 0) || (side[c] > 0 && side[e] < 0);
        if (!on && !crosses)
            continue;
        wide_set(on ? s.a[c][measure] : s.a[e][measure] * side[c] - s.a[c][measure] * side[e],
                 &t.num);
        wide_set(on ? s.d[measure] : (side[c] - side[e]) * s.d[measure], &t.den);
        include(&t, any, in, out);
    }
    return true;
}

bool exact_in_plane(const struct ray *ray, float v[3][3], struct fraction *in, struct fraction *out)
{
    struct input input;
    struct wide a[3][3], d[3], n[3], side[3];
    bool any = false;
    read_input(ray, v, &input);
    if (small_in_plane(&input, &any, in, out))
        return any;
    wide_input(&input, a, d);
    normal_of(a, n);
    /* Drop an axis along which the plane is not seen edge-on: what is left is one to one, so the
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
            struct wide span;
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
    struct input in;
    struct wide a[3][3], d[3], n[3];
    read_input(&at_origin, v, &in);
    wide_input(&in, a, d);
    normal_of(a, n);
    return n[0].sign == 0 && n[1].sign == 0 && n[2].sign == 0;
}

#include "tests/exact/exact_gmp.h"

#include <math.h>

/* --- the linear system ------------------------------------------------------------------------ */

/* Rows of A | b with `unknowns` columns, brought to reduced row echelon form. */
struct system {
    mpq_t cell[3][4];
};

static void system_init(struct system *s)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            mpq_init(s->cell[r][c]);
}

static void system_clear(struct system *s)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            mpq_clear(s->cell[r][c]);
}

/* Eliminates column by column; returns the rank of the first `unknowns` columns. pivot[c] is the
 * row whose leading 1 is in column c, or -1. */
static int reduce(struct system *s, int unknowns, int pivot[3])
{
    mpq_t factor, term;
    int rank = 0;
    mpq_inits(factor, term, NULL);
    for (int c = 0; c < unknowns; c++) {
        int row = rank;
        while (row < 3 && mpq_sgn(s->cell[row][c]) == 0)
            row++;
        pivot[c] = -1;
        if (row == 3)
            continue;
        for (int k = 0; k < 4; k++)
            mpq_swap(s->cell[row][k], s->cell[rank][k]);
        mpq_set(factor, s->cell[rank][c]);
        for (int k = 0; k < 4; k++)
            mpq_div(s->cell[rank][k], s->cell[rank][k], factor);
        for (int r = 0; r < 3; r++) {
            if (r == rank || mpq_sgn(s->cell[r][c]) == 0)
                continue;
            mpq_set(factor, s->cell[r][c]);
            for (int k = 0; k < 4; k++) {
                mpq_mul(term, factor, s->cell[rank][k]);
                mpq_sub(s->cell[r][k], s->cell[r][k], term);
            }
        }
        pivot[c] = rank++;
    }
    mpq_clears(factor, term, NULL);
    return rank;
}

/* out = x - v */
static void set_from(mpq_t out, float x, const mpq_t v)
{
    mpq_set_d(out, (double)x);
    mpq_sub(out, out, v);
}

/* --- ranges ------------------------------------------------------------------------------------
 */

int exact_gmp_compare(const mpq_t a, double x)
{
    if (isinf(x))
        return x > 0 ? -1 : 1;
    mpq_t b;
    mpq_init(b);
    mpq_set_d(b, x);
    int sign = mpq_cmp(a, b);
    mpq_clear(b);
    return (sign > 0) - (sign < 0);
}

static enum oracle_range range_of_hit(const struct ray *ray, const mpq_t t)
{
    int low = exact_gmp_compare(t, (double)ray->tmin),
        high = exact_gmp_compare(t, (double)ray->tmax);
    if (low < 0)
        return ORACLE_BELOW;
    if (high > 0)
        return ORACLE_ABOVE;
    return low == 0 ? ORACLE_AT_TMIN : high == 0 ? ORACLE_AT_TMAX : ORACLE_WITHIN;
}

static enum oracle_range range_of_interval(const struct ray *ray, const mpq_t in, const mpq_t out)
{
    if (exact_gmp_compare(out, (double)ray->tmin) < 0)
        return ORACLE_BELOW;
    return exact_gmp_compare(in, (double)ray->tmax) > 0 ? ORACLE_ABOVE : ORACLE_WITHIN;
}

bool exact_gmp_hits(const struct gmp_pair *pair, enum oracle_ends ends)
{
    if (pair->class != ORACLE_INSIDE && pair->class != ORACLE_EDGE && pair->class != ORACLE_VERTEX)
        return false;
    return pair->range == ORACLE_WITHIN ||
           (ends == ORACLE_CLOSED &&
            (pair->range == ORACLE_AT_TMIN || pair->range == ORACLE_AT_TMAX));
}

/* --- in the plane ------------------------------------------------------------------------------
 */

/* Barycentric weights of the plane's point o + t d as a function of t are linear; cuts [in, out] to
 * where weight `at0 + t slope` is not negative. Returns false if nothing is left. */
static bool cut(const mpq_t at0, const mpq_t slope, bool *low, mpq_t in, bool *high, mpq_t out)
{
    if (mpq_sgn(slope) == 0)
        return mpq_sgn(at0) >= 0;
    mpq_t root;
    mpq_init(root);
    mpq_div(root, at0, slope);
    mpq_neg(root, root);
    if (mpq_sgn(slope) > 0 && (!*low || mpq_cmp(root, in) > 0)) {
        mpq_set(in, root);
        *low = true;
    }
    if (mpq_sgn(slope) < 0 && (!*high || mpq_cmp(root, out) < 0)) {
        mpq_set(out, root);
        *high = true;
    }
    mpq_clear(root);
    return !(*low && *high) || mpq_cmp(in, out) <= 0;
}

/* The reduced system of two unknowns u, v with right side o - v0 (t = 0) or d (the slope). */
static void weights(mpq_t v[3][3], const struct ray *ray, bool slope, mpq_t weight[3])
{
    struct system s;
    int pivot[3];
    system_init(&s);
    for (int k = 0; k < 3; k++) {
        mpq_sub(s.cell[k][0], v[1][k], v[0][k]);
        mpq_sub(s.cell[k][1], v[2][k], v[0][k]);
        if (slope)
            mpq_set_d(s.cell[k][3], (double)ray->dir[k]);
        else
            set_from(s.cell[k][3], ray->org[k], v[0][k]);
    }
    reduce(&s, 2, pivot);
    mpq_set(weight[1], s.cell[pivot[0]][3]);
    mpq_set(weight[2], s.cell[pivot[1]][3]);
    mpq_set_si(weight[0], slope ? 0 : 1, 1);
    mpq_sub(weight[0], weight[0], weight[1]);
    mpq_sub(weight[0], weight[0], weight[2]);
    system_clear(&s);
}

static void in_plane(const struct ray *ray, mpq_t v[3][3], struct gmp_pair *pair)
{
    mpq_t at0[3], slope[3];
    bool low = false, high = false, left = true;
    for (int c = 0; c < 3; c++)
        mpq_inits(at0[c], slope[c], NULL);
    weights(v, ray, false, at0);
    weights(v, ray, true, slope);
    for (int c = 0; c < 3 && left; c++)
        left = cut(at0[c], slope[c], &low, pair->t, &high, pair->t_out);
    if (left) { /* a triangle is bounded: both ends were set */
        pair->class = ORACLE_IN_PLANE;
        pair->range = range_of_interval(ray, pair->t, pair->t_out);
    }
    for (int c = 0; c < 3; c++)
        mpq_clears(at0[c], slope[c], NULL);
}

/* --- one pair ----------------------------------------------------------------------------------
 */

void exact_gmp_init(struct gmp_pair *pair)
{
    mpq_inits(pair->t, pair->t_out, NULL);
    for (int c = 0; c < 3; c++)
        mpq_init(pair->weight[c]);
}

void exact_gmp_clear(struct gmp_pair *pair)
{
    mpq_clears(pair->t, pair->t_out, NULL);
    for (int c = 0; c < 3; c++)
        mpq_clear(pair->weight[c]);
}

/* Rank 3: one point, whose weights say where it lies. */
static void one_point(const struct ray *ray, const struct system *s, const int pivot[3],
                      struct gmp_pair *pair)
{
    int zeros = 0;
    bool outside = false;
    mpq_set(pair->weight[1], s->cell[pivot[0]][3]);
    mpq_set(pair->weight[2], s->cell[pivot[1]][3]);
    mpq_set(pair->t, s->cell[pivot[2]][3]);
    mpq_set_si(pair->weight[0], 1, 1);
    mpq_sub(pair->weight[0], pair->weight[0], pair->weight[1]);
    mpq_sub(pair->weight[0], pair->weight[0], pair->weight[2]);
    for (int c = 0; c < 3; c++) {
        pair->side[c] = mpq_sgn(pair->weight[c]);
        outside |= pair->side[c] < 0;
        zeros += pair->side[c] == 0;
    }
    pair->point = true;
    if (!outside) {
        pair->class = zeros == 2 ? ORACLE_VERTEX : zeros == 1 ? ORACLE_EDGE : ORACLE_INSIDE;
        pair->range = range_of_hit(ray, pair->t);
    }
}

void exact_gmp_pair_at(const struct ray *ray, mpq_t v[3][3], struct gmp_pair *pair)
{
    struct system s;
    int pivot[3];
    bool still = true;
    system_init(&s);
    for (int k = 0; k < 3; k++) { /* unknowns u, v, t */
        mpq_sub(s.cell[k][0], v[1][k], v[0][k]);
        mpq_sub(s.cell[k][1], v[2][k], v[0][k]);
        mpq_set_d(s.cell[k][2], -(double)ray->dir[k]);
        set_from(s.cell[k][3], ray->org[k], v[0][k]);
        still = still && ray->dir[k] == 0;
    }
    int rank = reduce(&s, 3, pivot);
    pair->class = ORACLE_MISS;
    pair->range = ORACLE_BELOW;
    pair->point = false;
    if (pivot[0] < 0 || pivot[1] < 0)
        pair->class = ORACLE_ZERO_AREA;
    else if (rank == 3)
        one_point(ray, &s, pivot, pair);
    else if (!still && mpq_sgn(s.cell[2][3]) == 0) /* the third equation is 0 = 0 */
        in_plane(ray, v, pair);
    system_clear(&s);
}

void exact_gmp_pair(const struct ray *ray, float v[3][3], struct gmp_pair *pair)
{
    mpq_t exact[3][3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            mpq_init(exact[c][k]);
            mpq_set_d(exact[c][k], (double)v[c][k]);
        }
    exact_gmp_pair_at(ray, exact, pair);
    for (int c = 0; c < 3; c++)
        mpq_clears(exact[c][0], exact[c][1], exact[c][2], NULL);
}

/* --- a scene -----------------------------------------------------------------------------------
 */

void exact_gmp_nearest_init(struct gmp_nearest *nearest)
{
    mpq_inits(nearest->t, nearest->next, NULL);
}

void exact_gmp_nearest_clear(struct gmp_nearest *nearest)
{
    mpq_clears(nearest->t, nearest->next, NULL);
}

void exact_gmp_take(struct gmp_nearest *out, uint32_t prim, const mpq_t t)
{
    int sign = out->count ? mpq_cmp(t, out->t) : -1;
    if (sign == 0) {
        out->count++;
    } else if (sign < 0) {
        if (out->count) {
            mpq_set(out->next, out->t); /* nearer than any next so far */
            out->has_next = true;
        }
        mpq_set(out->t, t);
        out->prim = prim;
        out->count = 1;
    } else if (!out->has_next || mpq_cmp(t, out->next) < 0) {
        mpq_set(out->next, t);
        out->has_next = true;
    }
}

void exact_gmp_nearest(const struct scene *scene, const struct ray *ray, enum oracle_ends ends,
                       struct gmp_nearest *out)
{
    struct gmp_pair pair;
    mpq_t plane;
    bool any_plane = false;
    exact_gmp_init(&pair);
    mpq_init(plane);
    out->prim = ABI_NO_PRIM;
    out->count = 0;
    out->has_next = false;
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        scene_tri(scene, prim, v);
        exact_gmp_pair(ray, v, &pair);
        if (exact_gmp_hits(&pair, ends))
            exact_gmp_take(out, prim, pair.t);
        if (pair.class == ORACLE_IN_PLANE && pair.range == ORACLE_WITHIN &&
            (!any_plane || mpq_cmp(pair.t, plane) < 0)) {
            mpq_set(plane, pair.t);
            any_plane = true;
        }
    }
    if (any_plane && exact_gmp_compare(plane, (double)ray->tmin) < 0)
        mpq_set_d(plane, (double)ray->tmin);
    out->in_plane = any_plane && (out->count == 0 || mpq_cmp(plane, out->t) <= 0);
    out->in_plane_close =
        any_plane &&
        (out->count == 0 ||
         mpq_get_d(plane) <= mpq_get_d(out->t) * (1 + copysign(0x1p-38, mpq_get_d(out->t))));
    exact_gmp_clear(&pair);
    mpq_clear(plane);
}

bool exact_gmp_far_off(const struct ray *ray, long double a[3][3], long double slack)
{
    long double length[3] = {0, 0, 0}, d_length = 0;
    bool positive = false, negative = false;
    for (int k = 0; k < 3; k++) {
        d_length += fabsl((long double)ray->dir[k]);
        for (int c = 0; c < 3; c++)
            length[c] += fabsl(a[c][k]);
    }
    for (int c = 0; c < 3; c++) {
        int one = (c + 1) % 3, two = (c + 2) % 3;
        long double sum = 0, size = (length[one] + slack) * (length[two] + slack);
        long double limit = d_length * (0x1p-16L * size + slack * (length[one] + length[two]));
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            sum += (long double)ray->dir[k] * (a[one][i] * a[two][j] - a[one][j] * a[two][i]);
        }
        positive |= sum > limit;
        negative |= sum < -limit;
    }
    return positive && negative;
}

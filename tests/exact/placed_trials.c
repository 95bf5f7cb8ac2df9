#include "tests/exact/placed_trials.h"

#include "ref/base/base.h"

#include <math.h>

/* --- transforms -------------------------------------------------------------------------------
 */

struct exact_linear {
    double a[3][3];
};

static struct exact_linear times(const struct exact_linear *x, const struct exact_linear *y)
{
    struct exact_linear out = {{{0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                out.a[i][j] += x->a[i][k] * y->a[k][j];
    return out;
}

static struct exact_linear diagonal(double x, double y, double z)
{
    return (struct exact_linear){{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
}

/* By random angles about all three axes. */
static struct exact_linear rotation(struct rng *rng)
{
    struct exact_linear out = diagonal(1, 1, 1);
    for (int k = 0; k < 3; k++) {
        double angle = 6.283185307179586 * (double)rng_float(rng), c = cos(angle), s = sin(angle);
        int i = (k + 1) % 3, j = (k + 2) % 3;
        struct exact_linear turn = diagonal(1, 1, 1);
        turn.a[i][i] = turn.a[j][j] = c;
        turn.a[i][j] = -s;
        turn.a[j][i] = s;
        out = times(&turn, &out);
    }
    return out;
}

static void put(const struct exact_linear *m, struct instance *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->m[i][j] = (float)m->a[i][j];
}

static void put_translation(struct rng *rng, float size, struct instance *out)
{
    for (int i = 0; i < 3; i++)
        out->m[i][3] = size * rng_range(rng, -1, 1);
}

/* Up to 2^power. */
static double number(struct rng *rng, int power)
{
    return (double)ldexpf(rng_range(rng, -1, 1), power);
}

static void make_identity(struct rng *rng, struct instance *out)
{
    struct exact_linear m = diagonal(1, 1, 1);
    (void)rng;
    put(&m, out);
}

static void make_translated(struct rng *rng, struct instance *out)
{
    make_identity(rng, out);
    put_translation(rng, ldexpf(1, (int)rng_below(rng, 24)), out);
}

static void make_rotated(struct rng *rng, struct instance *out)
{
    struct exact_linear m = rotation(rng);
    put(&m, out);
    if (rng_below(rng, 2))
        put_translation(rng, 4, out);
}

static void make_rotated_far(struct rng *rng, struct instance *out)
{
    struct exact_linear m = rotation(rng);
    put(&m, out);
    put_translation(rng, 1e6f, out);
}

/* Powers of two, permuted, mirrored: nothing is rounded. */
static void make_exact(struct rng *rng, struct instance *out)
{
    uint32_t order = rng_below(rng, 6);
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t j = order < 3 ? (i + order) % 3 : (order - i) % 3;
        int power = (int)rng_below(rng, 9) - 4;
        float size = ldexpf(1, power);
        out->m[i][j] = rng_below(rng, 2) ? size : -size;
        out->m[i][3] = (float)(int)rng_below(rng, 17) - 8;
    }
}

static void make_scaled_small(struct rng *rng, struct instance *out)
{
    struct exact_linear turn = rotation(rng), scale = diagonal(1e-6, 1e-6, 1e-6);
    struct exact_linear m = times(&turn, &scale);
    put(&m, out);
    float far = rng_below(rng, 2) ? 1.0f : 1e-6f;
    put_translation(rng, far, out);
}

/* 1e6 : 1 along the axes of the mesh, which costs nothing, or along others, which costs kappa. */
static void make_uneven(struct rng *rng, struct instance *out)
{
    struct exact_linear turn = rotation(rng), back = rotation(rng);
    struct exact_linear scale = diagonal(1e3, 1, 1e-3), m = times(&turn, &scale);
    if (rng_below(rng, 2))
        m = times(&m, &back);
    put(&m, out);
    put_translation(rng, 2, out);
}

static void make_mirrored(struct rng *rng, struct instance *out)
{
    struct exact_linear turn = rotation(rng), mirror = diagonal(-1, 1, 1);
    struct exact_linear m = times(&turn, &mirror);
    put(&m, out);
    put_translation(rng, 1, out);
}

static void make_nearly_singular(struct rng *rng, struct instance *out)
{
    struct exact_linear turn = rotation(rng), back = rotation(rng);
    double thin = ldexp(1, -(int)rng_below(rng, 21));
    struct exact_linear flat = diagonal(1, 1, thin), m = times(&turn, &flat);
    m = times(&m, &back);
    put(&m, out);
    put_translation(rng, 2, out);
}

static void make_sheared(struct rng *rng, struct instance *out)
{
    struct exact_linear m = diagonal(1, 1, 1);
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            m.a[i][j] = number(rng, (int)rng_below(rng, 10));
    put(&m, out);
    put_translation(rng, 2, out);
}

/* Off the diagonal numbers whose inverse is subnormal, or next to it. */
static void make_subnormal(struct rng *rng, struct instance *out)
{
    struct exact_linear m = diagonal(1, 1, 1);
    if (rng_below(rng, 2))
        m.a[0][0] = (double)rng_range(rng, 1, 2);
    if (rng_below(rng, 2))
        m.a[1][1] = (double)rng_range(rng, 1, 2);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i != j && rng_below(rng, 2))
                m.a[i][j] = number(rng, -110 - (int)rng_below(rng, 41));
    put(&m, out);
    put_translation(rng, ldexpf(1, -(int)rng_below(rng, 130)), out);
}

static void make_at_ends(struct rng *rng, struct instance *out)
{
    struct exact_linear turn = rotation(rng);
    double size = ldexp(1, 60 - (int)rng_below(rng, 120));
    struct exact_linear scale = diagonal(size, size, size), m = times(&turn, &scale);
    put(&m, out);
    put_translation(rng, (float)size, out);
}

/* Rows of small whole numbers, so that products cancel exactly and components become 0. */
static void make_whole(struct rng *rng, struct instance *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out->m[i][j] = (float)(int)rng_below(rng, 7) - 3;
}

static const struct {
    const char *name;
    void (*make)(struct rng *rng, struct instance *out);
} kinds[] = {
    {"identity", make_identity},
    {"translated", make_translated},
    {"rotated", make_rotated},
    {"rotated_far", make_rotated_far},
    {"exact", make_exact},
    {"scaled_small", make_scaled_small},
    {"uneven", make_uneven},
    {"mirrored", make_mirrored},
    {"nearly_singular", make_nearly_singular},
    {"sheared", make_sheared},
    {"subnormal", make_subnormal},
    {"at_ends", make_at_ends},
    {"whole", make_whole},
};
_Static_assert(PLACED_KINDS == ARRAY_COUNT(kinds), "PLACED_KINDS");

const char *placed_kind(int kind)
{
    return kinds[kind].name;
}

void placed_transform(int kind, struct rng *rng, struct instance *out)
{
    do {
        *out = (struct instance){.mask = 0xFF};
        kinds[kind].make(rng, out);
    } while (instance_det_sign((const float(*)[4])out->m) == 0);
}

/* --- truth ------------------------------------------------------------------------------------ */

void placed_init(struct exact_placed *placed)
{
    for (int k = 0; k < 3; k++)
        mpq_inits(placed->org[k], placed->dir[k], NULL);
    for (int i = 0; i < 9; i++)
        mpq_init(placed->inverse[i]);
}

void placed_clear(struct exact_placed *placed)
{
    for (int k = 0; k < 3; k++)
        mpq_clears(placed->org[k], placed->dir[k], NULL);
    for (int i = 0; i < 9; i++)
        mpq_clear(placed->inverse[i]);
}

typedef mpq_t rational[3];

/* out += sign a b */
static void add_product(mpq_t out, int sign, const mpq_t a, const mpq_t b)
{
    mpq_t product;
    mpq_init(product);
    mpq_mul(product, a, b);
    if (sign < 0)
        mpq_sub(out, out, product);
    else
        mpq_add(out, out, product);
    mpq_clear(product);
}

static void dot(mpq_t out, mpq_t a[3], mpq_t b[3])
{
    mpq_set_si(out, 0, 1);
    for (int k = 0; k < 3; k++)
        add_product(out, 1, a[k], b[k]);
}

static void cross(mpq_t out[3], mpq_t a[3], mpq_t b[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_set_si(out[i], 0, 1);
        add_product(out[i], 1, a[j], b[k]);
        add_product(out[i], -1, a[k], b[j]);
    }
}

static void set_vector(mpq_t out[3], const float x[3])
{
    for (int k = 0; k < 3; k++)
        mpq_set_d(out[k], (double)x[k]);
}

/* By the rows of the adjugate: r1 x r2 and so on, over the determinant, are its columns. */
static void invert(struct exact_placed *placed)
{
    rational row[3], column;
    mpq_t det;
    mpq_inits(det, column[0], column[1], column[2], NULL);
    for (int i = 0; i < 3; i++) {
        mpq_inits(row[i][0], row[i][1], row[i][2], NULL);
        set_vector(row[i], placed->instance.m[i]);
    }
    for (int j = 0; j < 3; j++) {
        cross(column, row[(j + 1) % 3], row[(j + 2) % 3]);
        dot(det, row[j], column);
        for (int i = 0; i < 3; i++)
            mpq_div(placed->inverse[3 * i + j], column[i], det);
    }
    mpq_clears(det, column[0], column[1], column[2], NULL);
    for (int i = 0; i < 3; i++)
        mpq_clears(row[i][0], row[i][1], row[i][2], NULL);
}

/* The ray in the space of the mesh. */
static void take_along(struct exact_placed *placed)
{
    const struct ray *ray = &placed->trial.ray;
    rational x, d;
    mpq_t part;
    mpq_inits(part, x[0], x[1], x[2], d[0], d[1], d[2], NULL);
    set_vector(x, ray->org);
    set_vector(d, ray->dir);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(part, (double)placed->instance.m[k][3]);
        mpq_sub(x[k], x[k], part);
    }
    for (int i = 0; i < 3; i++) {
        dot(placed->org[i], placed->inverse + 3 * i, x);
        dot(placed->dir[i], placed->inverse + 3 * i, d);
    }
    mpq_clears(part, x[0], x[1], x[2], d[0], d[1], d[2], NULL);
}

/* o + t d = v0 + u e1 + v e2 by determinants. */
static void solve(struct exact_placed *placed)
{
    struct truth *truth = &placed->trial.truth;
    rational v[3], n, s, q, weight;
    mpq_t det;
    mpq_inits(det, n[0], n[1], n[2], s[0], s[1], s[2], q[0], q[1], q[2], NULL);
    mpq_inits(weight[0], weight[1], weight[2], NULL);
    for (int c = 0; c < 3; c++) {
        mpq_inits(v[c][0], v[c][1], v[c][2], NULL);
        set_vector(v[c], placed->trial.v[c]);
    }
    for (int k = 0; k < 3; k++) {
        mpq_sub(v[1][k], v[1][k], v[0][k]);
        mpq_sub(v[2][k], v[2][k], v[0][k]);
        mpq_sub(s[k], v[0][k], placed->org[k]);
    }
    cross(n, v[1], v[2]);
    dot(det, placed->dir, n);
    placed->side = mpq_sgn(det);
    *truth = (struct truth){.point = mpq_sgn(det) != 0};
    if (truth->point) {
        dot(weight[0], s, n); /* t */
        mpq_div(weight[0], weight[0], det);
        truth->t = trial_sum(weight[0]);
        truth->from_tmin = exact_gmp_compare(weight[0], (double)placed->trial.ray.tmin);
        truth->to_tmax = exact_gmp_compare(weight[0], (double)placed->trial.ray.tmax);
        cross(q, placed->dir, s); /* v = e1 . (d x s) / det, u = -e2 . (d x s) / det */
        dot(weight[1], v[2], q);
        mpq_neg(weight[1], weight[1]);
        dot(weight[2], v[1], q);
        mpq_set_si(weight[0], 1, 1);
        for (int c = 1; c < 3; c++) {
            mpq_div(weight[c], weight[c], det);
            mpq_sub(weight[0], weight[0], weight[c]);
        }
        for (int c = 0; c < 3; c++) {
            truth->weight[c] = trial_sum(weight[c]);
            truth->side[c] = mpq_sgn(weight[c]);
        }
    }
    mpq_clears(det, n[0], n[1], n[2], s[0], s[1], s[2], q[0], q[1], q[2], NULL);
    mpq_clears(weight[0], weight[1], weight[2], NULL);
    for (int c = 0; c < 3; c++)
        mpq_clears(v[c][0], v[c][1], v[c][2], NULL);
}

bool placed_truth(struct exact_placed *placed)
{
    const struct ray *ray = &placed->trial.ray;
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(ray->org[k]) || !float_is_finite(ray->dir[k]))
            return false;
    if (twin_place_of(&placed->instance, &placed->place, NULL))
        return false;
    placed->trial.place = &placed->place;
    invert(placed);
    take_along(placed);
    solve(placed);
    return true;
}

bool placed_make(int kind, int pair_kind, uint64_t index, struct gmp_pair *pair,
                 struct exact_placed *out)
{
    struct rng rng = rng_make(index, 1000 + (uint64_t)kind);
    trial_make(pair_kind, index, pair, &out->trial);
    placed_transform(kind, &rng, &out->instance);
    struct ray *ray = &out->trial.ray;
    double org[3], dir[3];
    for (int i = 0; i < 3; i++) {
        org[i] = (double)out->instance.m[i][3];
        dir[i] = 0;
        for (int j = 0; j < 3; j++) {
            org[i] += (double)out->instance.m[i][j] * (double)ray->org[j];
            dir[i] += (double)out->instance.m[i][j] * (double)ray->dir[j];
        }
    }
    for (int i = 0; i < 3; i++) {
        ray->org[i] = (float)org[i];
        ray->dir[i] = (float)dir[i];
    }
    return placed_truth(out);
}

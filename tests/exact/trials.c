#include "tests/exact/trials.h"

#include "tests/exact/oracle_cases.h"

#include <math.h>

/* --- pairs ----------------------------------------------------------------------------------- */

static void weighted(float v[3][3], const double weight[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] =
            weight[0] * (double)v[0][k] + weight[1] * (double)v[1][k] + weight[2] * (double)v[2][k];
}

static void aim(struct ray *ray, const double target[3])
{
    for (int k = 0; k < 3; k++)
        ray->dir[k] = (float)(target[k] - (double)ray->org[k]);
}

/* Past an edge or a vertex, inside or outside by 2^-30 to 2^-12 of the triangle. */
static void make_beside(struct rng *rng, struct ray *ray, float v[3][3])
{
    float offset = rng_below(rng, 2) ? 0.0f : 100.0f, size = ldexpf(1, -(int)rng_below(rng, 8));
    double by = ldexp(1, -12 - (int)rng_below(rng, 18));
    double a = (double)rng_float(rng), weight[3] = {0, 0, 0}, target[3];
    uint32_t first = rng_below(rng, 3);
    by = rng_below(rng, 2) ? by : -by;
    for (int k = 0; k < 3; k++) {
        float base = offset + rng_range(rng, -1, 1);
        ray->org[k] = offset + rng_range(rng, -4, 4);
        for (int c = 0; c < 3; c++)
            v[c][k] = base + size * rng_range(rng, -1, 1);
    }
    weight[first] = by;
    weight[(first + 1) % 3] = rng_below(rng, 4) ? a * (1 - by) : by;
    weight[(first + 2) % 3] = 1 - weight[first] - weight[(first + 1) % 3];
    weighted(v, weight, target);
    aim(ray, target);
}

/* Nearly parallel to the plane. */
static void make_grazing(struct rng *rng, struct ray *ray, float v[3][3])
{
    double weight[3] = {0.25, 0.5, 0.25}, target[3];
    double lift = ldexp(1, -(int)rng_below(rng, 24));
    int flat = (int)rng_below(rng, 3);
    for (int k = 0; k < 3; k++) {
        ray->org[k] = rng_range(rng, -4, 4);
        for (int c = 0; c < 3; c++)
            v[c][k] = rng_range(rng, -1, 1) * (k == flat ? (float)lift : 1);
    }
    ray->org[flat] *= (float)lift;
    weighted(v, weight, target);
    aim(ray, target);
}

/* Origins much nearer to the plane than the triangle is wide, or the other way around. */
static void make_near_or_far(struct rng *rng, struct ray *ray, float v[3][3])
{
    double distance = ldexp(1, 16 - (int)rng_below(rng, 32)), target[3];
    double a = (double)rng_float(rng), b = (double)rng_float(rng) * (1 - a);
    double weight[3] = {a, b, 1 - a - b};
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = rng_range(rng, -1, 1);
    weighted(v, weight, target);
    for (int k = 0; k < 3; k++)
        ray->org[k] = (float)(target[k] + distance * (double)rng_range(rng, -1, 1));
    aim(ray, target);
}

/* Any of these and of the features, times a power of two that brings products to either end of
 * float32. */
static void make_scaled(struct rng *rng, struct ray *ray, float v[3][3])
{
    int size = (int)rng_below(rng, 120) - 75, speed = (int)rng_below(rng, 80) - 40;
    make_beside(rng, ray, v);
    for (int k = 0; k < 3; k++) {
        ray->org[k] = ldexpf(ray->org[k], size);
        ray->dir[k] = ldexpf(ray->dir[k], speed);
        for (int c = 0; c < 3; c++)
            v[c][k] = ldexpf(v[c][k], size);
    }
}

static const struct {
    const char *name;
    void (*make)(struct rng *rng, struct ray *ray, float v[3][3]);
} own_kinds[] = {
    {"beside", make_beside},
    {"grazing", make_grazing},
    {"near_or_far", make_near_or_far},
    {"scaled", make_scaled},
};
_Static_assert(TRIAL_KINDS == ORACLE_CASES + ARRAY_COUNT(own_kinds), "TRIAL_KINDS");

const char *trial_kind(int kind)
{
    return kind < ORACLE_CASES ? oracle_cases[kind].name : own_kinds[kind - ORACLE_CASES].name;
}

/* --- truth ----------------------------------------------------------------------------------- */

struct sum trial_sum(const mpq_t x)
{
    struct sum sum = {mpq_get_d(x), 0};
    mpq_t rest;
    mpq_init(rest);
    mpq_set_d(rest, sum.head);
    mpq_sub(rest, x, rest);
    sum.tail = mpq_get_d(rest);
    mpq_clear(rest);
    return sum;
}

static struct truth truth_of(const struct ray *ray, const struct gmp_pair *pair)
{
    struct truth truth = {.point = pair->point};
    if (!truth.point)
        return truth;
    truth.t = trial_sum(pair->t);
    truth.from_tmin = exact_gmp_compare(pair->t, (double)ray->tmin);
    truth.to_tmax = exact_gmp_compare(pair->t, (double)ray->tmax);
    for (int c = 0; c < 3; c++) {
        truth.weight[c] = trial_sum(pair->weight[c]);
        truth.side[c] = pair->side[c];
    }
    return truth;
}

void trial_truth(struct gmp_pair *pair, struct trials_trial *trial)
{
    trial->place = NULL;
    exact_gmp_pair(&trial->ray, trial->v, pair);
    trial->truth = truth_of(&trial->ray, pair);
}

void trial_make(int kind, uint64_t index, struct gmp_pair *pair, struct trials_trial *out)
{
    struct rng rng = rng_make(index, (uint64_t)kind + 1);
    if (kind < ORACLE_CASES) {
        oracle_cases[kind].make(&rng, index / 16, &out->ray, out->v);
    } else {
        own_kinds[kind - ORACLE_CASES].make(&rng, &out->ray, out->v);
        out->ray.tmin = 0;
        out->ray.tmax = rng_below(&rng, 2) ? INFINITY : rng_range(&rng, 0, 2);
    }
    trial_truth(pair, out);
}

/* --- claims ---------------------------------------------------------------------------------- */

/* Error over bound; the tail matters where value and head agree to the last bit. */
static double ratio(float value, struct sum exact, double bound)
{
    if (!isfinite(bound))
        return 0;
    double off = fabs(((double)value - exact.head) - exact.tail);
    return off == 0 ? 0 : off / bound; /* NaN for a value that is none: broken */
}

static int sign(float x)
{
    return (x > 0) - (x < 0);
}

/* The formulas of Moeller and Trumbore, and of Baldwin and Webber, compute no third edge function.
 */
static bool has_edge(enum twin_formula formula, int c)
{
    return c > 0 || formula == TWIN_WOOP || formula == TWIN_PLUECKER ||
           formula == TWIN_EMBREE_ROBUST;
}

static const char *signs_broken(const struct trials_trial *trial, enum twin_formula formula,
                                const struct twin *twin, const struct evaluation *evaluation)
{
    const struct truth *truth = &trial->truth;
    for (int c = 0; c < 3; c++) {
        if (twin->edge[c] == 0)
            continue;
        if (truth->point && twin->det && twin->edge[c] * twin->det != truth->side[c])
            return "exact sign of an edge";
        if (has_edge(formula, c) && sign(evaluation->edge[c]) != twin->edge[c])
            return "sign of an edge";
    }
    return NULL;
}

const char *trial_broken(const struct trials_trial *trial, enum twin_formula formula,
                         const struct twin *twin, const struct evaluation *evaluation,
                         struct nearness *near)
{
    const struct truth *truth = &trial->truth;
    *near = (struct nearness){0, 0, 0};
    if (isnan(twin->t_err) || isnan(twin->u_err) || isnan(twin->v_err))
        return "a bound that is NaN";
    const char *signs = signs_broken(trial, formula, twin, evaluation);
    if (signs)
        return signs;
    if (!twin->possible && evaluation->accepted)
        return "an impossible hit";
    if (twin->certain && !evaluation->accepted)
        return "a certain hit";
    if (!truth->point)
        return isfinite(twin->t_err) || twin->det || twin->certain ? "a point in a plane" : NULL;
    near->t = ratio(evaluation->t, truth->t, twin->t_err);
    near->u = ratio(evaluation->u, truth->weight[1], twin->u_err);
    near->v = ratio(evaluation->v, truth->weight[2], twin->v_err);
    if (!(near->t <= 1))
        return "t";
    if (!(near->u <= 1) || !(near->v <= 1))
        return "u or v";
    if (twin->beyond && truth->from_tmin >= 0 && truth->to_tmax <= 0)
        return "beyond the range";
    if (twin->certain && (truth->side[0] <= 0 || truth->side[1] <= 0 || truth->side[2] <= 0 ||
                          truth->from_tmin <= 0 || truth->to_tmax >= 0))
        return "a hit that is none";
    return NULL;
}

static double worst(const struct nearness *near)
{
    return fmax(near->t, fmax(near->u, near->v));
}

const char *trial_worsen(const struct trials_trial *trial, enum twin_formula formula,
                         const struct twin *twin, struct legal *legal, struct nearness *near)
{
    static const uint8_t other[] = {LEGAL_LOW, LEGAL_HIGH, LEGAL_LOW | LEGAL_FUSE, LEGAL_FLUSH};
    uint32_t count = legal->count < LEGAL_MOST ? legal->count : LEGAL_MOST;
    legal->style = LEGAL_CHOSEN;
    struct evaluation evaluation =
        legal_evaluate_placed(legal, formula, trial->place, &trial->ray, (float(*)[3])trial->v);
    const char *broken = trial_broken(trial, formula, twin, &evaluation, near);
    for (uint32_t i = 0; i < count && !broken; i++)
        for (size_t n = 0; n < ARRAY_COUNT(other) && !broken; n++) {
            struct nearness now;
            uint8_t before = legal->choice[i];
            legal->choice[i] = other[n];
            evaluation = legal_evaluate_placed(legal, formula, trial->place, &trial->ray,
                                               (float(*)[3])trial->v);
            broken = trial_broken(trial, formula, twin, &evaluation, &now);
            if (broken || worst(&now) > worst(near))
                *near = now;
            else
                legal->choice[i] = before;
        }
    return broken;
}

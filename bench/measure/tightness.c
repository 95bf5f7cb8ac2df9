#include "bench/measure/tightness.h"

#include "ref/oracle/oracle.h"
#include "ref/twin/twin.h"
#include "ref/base/base.h"

#include <math.h>
#include <stdlib.h>

/* Largest number of steps from the end of a bound to the first rejected float. */
#define STEPS 64

bool tightness_draw(const struct oracle *oracle, const struct scene *scene,
                    const struct box *bounds, struct rng *rng, struct tightness_pair *out)
{
    float v[3][3], weight[3];
    struct oracle_pair pair;
    out->prim = rng_below(rng, scene->tri_count);
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
    scene_tri(scene, out->prim, v);
    weight[1] = rng_float(rng);
    weight[2] = (1 - weight[1]) * rng_float(rng);
    weight[0] = 1 - weight[1] - weight[2];
    for (int k = 0; k < 3; k++) {
        float middle = 0.5f * bounds->lo[k] + 0.5f * bounds->hi[k];
        float extent = bounds->hi[k] - bounds->lo[k];
        float at = weight[0] * v[0][k] + weight[1] * v[1][k] + weight[2] * v[2][k];
        out->ray.org[k] = middle + extent * rng_range(rng, -2, 2);
        out->ray.dir[k] = at - out->ray.org[k];
    }
    if (!ray_in_contract(&out->ray))
        return false;
    oracle_pair(oracle, &out->ray, out->prim, &pair);
    out->t = 0.5 * (pair.t_lo + pair.t_hi);
    return pair.class == ORACLE_INSIDE && pair.range == ORACLE_WITHIN && pair.t_lo > 0;
}

static bool rejects(const struct judge *judge, const struct ray *ray, struct hit answer)
{
    const struct oracle_answer nothing = {.prim = ABI_NO_PRIM}; /* the answer is judged by itself */
    struct judgement judgement;
    return judge_answer(judge, ray, &nothing, &answer, &judgement) == STATUS_OK &&
           judgement.verdict == VERDICT_WRONG;
}

/* The error of the first rejected float, searched from `end` in the direction `away` from
 * `from`. */
static double first_rejected(const struct judge *judge, const struct ray *ray, struct hit answer,
                             double from, double end, float away)
{
    float inner = (float)end, f;
    for (int i = 0; i < 2; i++)
        inner = nextafterf(inner, -away);
    f = away > 0 ? fmaxf(inner, (float)from) : fminf(inner, (float)from);
    for (int i = 0; i < STEPS; i++, f = nextafterf(f, away)) {
        answer.t = f;
        if (rejects(judge, ray, answer))
            return fabs((double)f - from);
    }
    return INFINITY;
}

struct tightness_one tightness_measure(const struct judge *judge, const struct scene *scene,
                                       const struct model *model, const struct tightness_pair *pair)
{
    float v[3][3];
    scene_tri(scene, pair->prim, v);
    struct twin twin = twin_eval(model->formula, model->rounding, &pair->ray, v);
    double ulp = ldexp(1, ilogb((double)(float)pair->t) - 23), t = pair->t;
    struct hit computed = {twin.t, twin.u, twin.v, pair->prim};
    struct hit exact = {(float)t, (float)twin.u_near, (float)twin.v_near, pair->prim};
    struct tightness_one one = {.real = fabs((double)twin.t - t) / ulp, .rejected = INFINITY};
    if (!twin.possible && model->formula == TWIN_MT_RTRS)
        return one;
    one.alarm =
        (twin.certain && rejects(judge, &pair->ray, computed)) || rejects(judge, &pair->ray, exact);
    if (isfinite(twin.t_err)) {
        double above = first_rejected(judge, &pair->ray, exact, t, t + twin.t_err, (float)INFINITY);
        double below =
            first_rejected(judge, &pair->ray, exact, t, t - twin.t_err, -(float)INFINITY);
        one.rejected = fmin(above, below) / ulp;
    }
    return one;
}

static int by_rejected(const void *left, const void *right)
{
    double a = ((const struct tightness_one *)left)->rejected;
    double b = ((const struct tightness_one *)right)->rejected;
    return order_doubles(a, b);
}

/* Copies the real errors of pairs [first, end) to `real` and sorts them. */
static void sort_real(const struct tightness_one *one, size_t first, size_t end, double *real)
{
    for (size_t i = first; i < end; i++)
        real[i - first] = one[i].real;
    sort_doubles(real, end - first);
}

/* `real` and `group` are scratch space for one value per pair. */
static void sum_groups(const struct tightness_one *one, size_t bounded, double *real, double *group,
                       struct tightness *out)
{
    size_t groups = bounded / TIGHTNESS_GROUP;
    groups = bounded > 0 && groups == 0 ? 1 : groups;
    for (size_t g = 0; g < groups; g++) {
        size_t first = g * TIGHTNESS_GROUP;
        size_t end = g + 1 == groups ? bounded : first + TIGHTNESS_GROUP;
        sort_real(one, first, end, real);
        group[g] =
            one[first + rank_of(end - first, 500)].rejected / real[rank_of(end - first, 999)];
    }
    sort_doubles(group, groups);
    out->group_p50 = groups ? group[rank_of(groups, 500)] : NAN;
    out->group_most = groups ? group[groups - 1] : NAN;
}

enum status tightness_sum(struct tightness_one *one, size_t count, struct tightness *out,
                          struct reason *reason)
{
    double *real = malloc(2 * count * sizeof *real);
    *out = (struct tightness){.count = count};
    if (!real)
        return fail(reason, STATUS_MEMORY, "no memory to sort %zu errors", count);
    qsort(one, count, sizeof *one, by_rejected);
    for (size_t i = 0; i < count; i++) {
        out->alarms += one[i].alarm;
        out->unbounded += isinf(one[i].rejected) ? 1 : 0;
    }
    sort_real(one, 0, count, real);
    out->real_p50 = real[rank_of(count, 500)];
    out->real_p999 = real[rank_of(count, 999)];
    out->real_most = real[count - 1];
    out->rejected_p50 = one[rank_of(count, 500)].rejected;
    out->rejected_p999 = one[rank_of(count, 999)].rejected;
    out->medians = out->rejected_p50 / out->real_p50;
    out->times = out->rejected_p50 / out->real_p999;
    sum_groups(one, count - out->unbounded, real, real + count, out);
    free(real);
    return STATUS_OK;
}

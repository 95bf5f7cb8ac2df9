/* Hits that an answer left out: which of them no engine of this formula can miss, and what excuses
 * the others. */
#include "ref/judge/judge_inner.h"

#include <math.h>
#include <stdlib.h>

/* The error of b / d - o / d does not shrink with the distance to the box, so no factor of the far
 * plane makes up for it. */
#define SLAB_ERROR (EMBREE_SLAB_ERROR * JUDGE_UNIT)
/* Below this t the products of a box test may be subnormal, where factors do not cover rounding. */
#define LEAST_T 0x1p-100

/* True if Embree's default box test may miss the hit at `t` in triangle `prim`. In exact arithmetic
 * the slabs of every box around the triangle overlap at t. Computed ones can come apart only where
 * the gap between leaving one axis and entering another is within both errors; slabs of one axis
 * are rounded alike and stay in order. A box around more triangles has wider gaps and the errors of
 * at most the largest coordinate. `reach` and the end of the range cut the boxes behind them, so
 * they have the same error. */
static bool slab_may_miss(const struct judge *judge, const struct ray *ray, uint32_t prim,
                          double reach)
{
    struct box box = scene_tri_bounds(judge->scene, prim);
    double enter[3], leave[3], error[3];
    reach = fmin(reach, (double)ray->tmax);
    for (int k = 0; k < 3; k++) {
        double d = (double)ray->dir[k], o = (double)ray->org[k];
        if (fabs(d) < EMBREE_LEAST_DIR)
            d = EMBREE_LEAST_DIR;
        double a = ((double)box.lo[k] - o) / d, b = ((double)box.hi[k] - o) / d;
        enter[k] = fmin(a, b);
        leave[k] = fmax(a, b);
        error[k] = SLAB_ERROR * ((double)judge->largest[k] + fabs(o)) / fabs(d);
    }
    for (int i = 0; i < 3; i++) {
        if (leave[i] - (double)ray->tmin <= error[i] || reach - enter[i] <= error[i])
            return true;
        for (int j = 0; j < 3; j++)
            if (i != j && leave[j] - enter[i] <= error[i] + error[j])
                return true;
    }
    return false;
}

const struct judge_slot *judge_find(const struct judge_found *found, uint32_t prim)
{
    size_t from = 0, to = found ? found->count : 0;
    while (from < to) {
        size_t middle = from + (to - from) / 2;
        if (found->slot[middle].prim < prim)
            from = middle + 1;
        else
            to = middle;
    }
    return found && from < found->count && found->slot[from].prim == prim ? &found->slot[from]
                                                                          : NULL;
}

/* An engine that found it answers at most its own t of it, which is at most t + E. It may also have
 * answered an earlier find t' and turned away the box, whose computed entry lay behind t'; that is
 * at most t + (2 a + r) u t (docs/numerics.md, "Boxes"), and E is never less than (2 a + r) u t
 * ("The error of t again"). So up to t + 2 E nothing was lost. Embree's default box test has an
 * error of its own: slab_may_miss. */
enum status judge_cannot_miss(const struct judge *judge, const struct ray *ray, uint32_t prim,
                              double t_lo, double t_hi, double reach,
                              const struct judge_found *found, const struct judge_known *known,
                              bool *lost)
{
    struct twin twin = judge_twin(judge, ray, prim, known);
    double limit = t_hi + 2.0 * twin.t_err;
    *lost = false;
    if (!(t_lo > LEAST_T) || !(reach > t_hi) || !judge_takes(judge, ray, prim) ||
        !judge_surely_counts(judge, ray, prim, &twin))
        return STATUS_OK;
    if (!twin.certain) {
        bool closed = false;
        if (judge->fans) {
            enum status status = judge_fan(judge, ray, prim, found, &closed, &limit);
            if (status)
                return status;
        }
        if (!closed)
            return STATUS_OK;
    }
    *lost = reach > limit && !(judge->model.slab && slab_may_miss(judge, ray, prim, reach));
    return STATUS_OK;
}

/* Tries every exact hit before `reach`, nearest first. */
static enum status try_all(const struct judge *judge, const struct ray *ray, double reach,
                           bool *lost, struct judgement *out)
{
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    enum status status = judge_crossings(judge, ray, reach, &list, &capacity, &count);
    for (size_t i = 0; i < count && status == STATUS_OK && !*lost; i++) {
        const struct oracle_pair *pair = &list[i].pair;
        if (!oracle_is_hit(pair))
            continue;
        status = judge_cannot_miss(judge, ray, list[i].prim, pair->t_lo, pair->t_hi, reach, NULL,
                                   NULL, lost);
        if (*lost)
            judge_set_lost(out, list[i].prim, pair->t_lo, pair->t_hi);
    }
    free(list);
    return status;
}

enum status judge_lost(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, double reach,
                       const struct judge_known *known, bool *lost, struct judgement *out)
{
    *lost = false;
    if (truth->prim == ABI_NO_PRIM || !(reach > truth->t_hi))
        return STATUS_OK;
    enum status status = judge_cannot_miss(judge, ray, truth->prim, truth->t_lo, truth->t_hi, reach,
                                           NULL, known, lost);
    if (status || *lost)
        return status;
    return try_all(judge, ray, reach, lost, out);
}

enum verdict judge_why_lost(const struct judge *judge, const struct ray *ray, uint32_t prim,
                            double t_lo, double t_hi, double reach, const struct judge_known *known)
{
    struct twin twin = judge_twin(judge, ray, prim, known);
    if (!judge_takes(judge, ray, prim))
        return VERDICT_OUT_OF_CONTRACT;
    if (isfinite(twin.t_err) && reach <= t_hi + 2.0 * twin.t_err)
        return VERDICT_NEAR_TIE;
    bool open = twin.det == 0 || !judge_surely_counts(judge, ray, prim, &twin);
    for (int c = 0; c < 3; c++)
        open = open || twin.edge[c] == 0;
    if (open)
        return VERDICT_BOUNDARY;
    if (twin.certain && t_lo > LEAST_T)
        return VERDICT_SLAB;
    return VERDICT_BORDER;
}

/* Answers that a bound of t does not decide: those of a determinant whose sign is open, and those
 * at the ends of a range. */
#include "ref/judge/judge_inner.h"
#include "ref/twin/twin_replay.h"

/* What an engine of the judge's model may do. Those that promise C's bits do not fuse. */
static struct liberty liberty_of(const struct judge *judge)
{
    return (struct liberty){judge->model.rounding, !judge->model.bits};
}

static bool can_answer(const struct judge *judge, const struct ray *ray, uint32_t prim,
                       const struct replay_answer *answer)
{
    const struct liberty liberty = liberty_of(judge);
    float v[3][3];
    judge_tri(judge, prim, v);
    if (!judge->world)
        return replay_can_answer(judge->model.formula, &liberty, ray, v, answer);
    struct twin_ray placed;
    judge_take_along(judge, ray, prim, &placed);
    return replay_can_answer_placed(judge->model.formula, &liberty, &placed, v, answer);
}

bool judge_can_answer(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      const struct hit *answer)
{
    const double number[3] = {(double)answer->t, (double)answer->u, (double)answer->v};
    struct replay_answer range;
    if (judge->by_bounds)
        return judge_can_hit(judge, ray, prim);
    for (int i = 0; i < 3; i++)
        range.lo[i] = range.hi[i] = number[i];
    return can_answer(judge, ray, prim, &range);
}

bool judge_can_hit(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    /* A weight below 0 may be accepted that is flushed before it is compared. */
    double least = judge->model.rounding.tiny > ROUNDING_IEEE.tiny ? -1.0 : 0.0;
    const struct replay_answer range = {{(double)ray->tmin, least, least},
                                        {(double)ray->tmax, 1.0, 1.0}};
    return can_answer(judge, ray, prim, &range);
}

double judge_share_beyond(const struct model *model)
{
    const struct rounding *k = &model->rounding;
    return model->formula == TWIN_EMBREE
               ? (2.0 * k->mul + k->div) * JUDGE_UNIT * (1.0 + JUDGE_SHARE)
               : 0.0;
}

/* Embree's default test compares |det| tmin < T <= |det| tmax, then divides. A product rounded up
 * is at most |det| tmax (1 + k* u), so T over |det|, by the reciprocal and its product, is at most
 * tmax (1 + k* u)^2 (1 + k/ u), and mirrored at tmin: 7.5 u for its own rounding. What is flushed
 * or underflows in T or the product is at most tiny each, and so tiny / |det| of t, and tiny in t.
 */
static bool within_compared(const struct judge *judge, const struct ray *ray, uint32_t prim,
                            double t)
{
    float v[3][3];
    const struct rounding *k = &judge->model.rounding;
    const struct liberty liberty = liberty_of(judge);
    double share = judge_share_beyond(&judge->model);
    double from = (double)ray->tmin * (1.0 - share), to = (double)ray->tmax * (1.0 + share);
    if (t >= from && t <= to)
        return true;
    judge_tri(judge, prim, v);
    double lost = 3.0 * k->tiny / replay_least_det(&liberty, ray, v) + 2.0 * k->tiny;
    return t >= from - lost && t <= to + lost;
}

bool judge_may_keep(const struct judge *judge, const struct ray *ray, uint32_t prim, float t)
{
    if (judge_in_range(judge, ray, t))
        return true;
    return judge->model.formula == TWIN_EMBREE && within_compared(judge, ray, prim, (double)t);
}

/* Answers of an unpublished formula: how far must vertices move to make them right?
 *
 * Every backward stable test answers exactly for a triangle whose vertices it has moved by a small
 * multiple of u times the size of the coordinates it works on, which is M = max |vertex - origin|.
 * So an answer is measured by the smallest such move that makes it right:
 *   a hit of triangle p at t   the point o + t d must come to lie on p: its distance to p
 *   a hit of p was lost        p must leave the ray, by the distance to its nearest edge as seen
 *                              along the ray; or leave the range, or go behind what was answered,
 *                              by the distance of that point of the ray to p's plane
 * and the answer as a whole by the largest of these.
 *
 * u and v are measured alike: the point of the triangle that they weigh must come to lie on the
 * line of the ray. That point need not be the one at t: where ray and plane meet at a small angle
 * a move of vertices by little shifts both along the ray by much, and by different rounding.
 *
 * Published tests are not all backward stable, so that of slivers, and near the plane, more is
 * allowed: what ref/judge/judge_allowed.c proves of the worst of them at that triangle. */
#include "ref/judge/judge_inner.h"

#include <math.h>
#include <stdlib.h>

static void keep_least(struct judge_loss *loss, double need, double allowed, enum verdict why)
{
    if (need < loss->over * allowed) {
        loss->need = need;
        loss->over = need / allowed;
        loss->why = why;
    }
}

/* A box whose near side is rounded up may be cut off by a hit before it, so the plane is allowed
 * twice its bound: its own error and that of the other. */
static void keep_plane(const struct judge *judge, const struct judge_rounding *rounding, double t,
                       enum verdict why, struct judge_loss *loss)
{
    keep_least(loss, ray_triangle_plane_distance(t, &rounding->tri) / rounding->tri.unit,
               2.0 * judge_plane_allowed(judge, rounding, t), why);
}

struct judge_loss judge_loss_of(const struct judge *judge, const struct ray *ray,
                                const struct oracle_crossing *lost, double reach)
{
    struct judge_rounding rounding = judge_rounding_at(judge, ray, lost->prim);
    struct judge_loss loss = {lost->prim,      INFINITY,         INFINITY,         lost->pair.t_lo,
                              lost->pair.t_hi, VERDICT_BOUNDARY, rounding.tri.unit};
    for (int c = 0; c < 3; c++)
        keep_least(&loss, fabs(judge_edge_distance(&rounding, c)),
                   judge_edge_allowed(judge, &rounding, c), VERDICT_BOUNDARY);
    if (isfinite(reach))
        keep_plane(judge, &rounding, reach, VERDICT_NEAR_TIE, &loss);
    keep_plane(judge, &rounding, (double)ray->tmin, VERDICT_BORDER, &loss);
    if (isfinite(ray->tmax))
        keep_plane(judge, &rounding, (double)ray->tmax, VERDICT_BORDER, &loss);
    bool takes = judge_takes(judge, ray, lost->prim);
    if (!takes || !judge_surely_counts(judge, ray, lost->prim, NULL)) {
        loss.need = loss.over = 0.0;
        loss.why = takes ? VERDICT_BOUNDARY : VERDICT_OUT_OF_CONTRACT;
    }
    return loss;
}

/* The lost hit before `reach` that needs most; *fan: one of them lies inside a closed fan all of
 * whose triangles were lost. */
static enum status worst_loss(const struct judge *judge, const struct ray *ray,
                              const struct oracle_answer *truth, double reach,
                              struct judge_loss *worst, struct judgement *out)
{
    bool *fan = &out->fan;
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    enum status status = judge_crossings(judge, ray, reach, &list, &capacity, &count);
    for (size_t i = 0; i < count && status == STATUS_OK; i++) {
        if (!oracle_is_hit(&list[i].pair) || !(reach > list[i].pair.t_hi))
            continue;
        struct judge_loss loss = judge_loss_of(judge, ray, &list[i], reach);
        if (worst->prim == ABI_NO_PRIM || loss.over > worst->over)
            *worst = loss;
        if (list[i].prim == truth->prim)
            out->edge_lost = loss.why == VERDICT_BOUNDARY;
        bool closed = false;
        double limit = 0.0;
        if (!*fan && loss.why == VERDICT_BOUNDARY)
            status = judge_fan(judge, ray, list[i].prim, NULL, &closed, &limit);
        *fan = *fan || (closed && reach > limit);
    }
    free(list);
    return status;
}

/* True if u and v weigh a point of the triangle that rounding may move onto the ray. */
static bool weights_fit(const struct judge *judge, const struct hit *answer,
                        const struct judge_rounding *rounding)
{
    const struct ray_triangle *tri = &rounding->tri;
    double u = (double)answer->u, w = (double)answer->v, p[3];
    for (int k = 0; k < 3; k++)
        p[k] = (1.0 - u - w) * tri->v[0][k] + u * tri->v[1][k] + w * tri->v[2][k];
    double most = (judge->displacement + rounding->extra) * tri->unit;
    if (ray_triangle_line_distance(p, tri) <= most && ray_triangle_distance(p, tri) <= most)
        return true;
    /* No test accepts weights below 0; Embree's replaces those from -2^-23 on by 0. */
    return u >= -JUDGE_SHARE && w >= -JUDGE_SHARE && u + w <= 1.0 + JUDGE_SHARE &&
           judge_weight_allowed(rounding, 1, u) && judge_weight_allowed(rounding, 2, w);
}

/* How far the answered point is from the triangle over what is allowed; *need: the same in units. A
 * test that is not backward stable may shift the point along the ray, out of the triangle, as long
 * as it stays near the plane, if it may accept the triangle; then only that counts.
 * *noise: the determinant's sign is open there, so that the point may be anywhere. */
static double hit_over(const struct judge *judge, double t, const struct judge_rounding *rounding,
                       double *need, bool *noise)
{
    const struct ray_triangle *tri = &rounding->tri;
    *noise = false;
    *need = judge_point_displacement(tri, t);
    double over = *need / (judge->displacement + rounding->extra);
    if (!judge_may_accept(judge, rounding))
        return over;
    double plane = ray_triangle_plane_distance(t, tri) / tri->unit;
    double along = plane / judge_plane_allowed(judge, rounding, t);
    if (over > 1.0) {
        *need = plane;
        *noise = judge_det_is_open(rounding);
    }
    return fmin(over, along);
}

/* Where the ray meets the plane. */
static double plane_t_of(const struct judge *judge, const struct ray *ray, uint32_t prim,
                         const struct judge_rounding *rounding)
{
    float v[3][3];
    if (judge->world)
        return rounding->t / rounding->det;
    scene_tri(judge->scene, prim, v);
    return judge_plane_t(ray, v);
}

/* True if t lies outside the range by no more than judge->beyond. */
static bool just_beyond(const struct judge *judge, const struct ray *ray, double t)
{
    return judge->beyond > 0.0 && t >= (double)ray->tmin * (1.0 - judge->beyond) &&
           t <= (double)ray->tmax * (1.0 + judge->beyond);
}

enum verdict judge_named_by_distance(const struct judge *judge, const struct ray *ray,
                                     const struct oracle_answer *truth, const struct hit *answer,
                                     struct judgement *out)
{
    struct oracle_pair pair;
    bool noise;
    if (!judge_takes(judge, ray, answer->prim))
        return VERDICT_OUT_OF_CONTRACT;
    struct judge_rounding rounding = judge_rounding_at(judge, ray, answer->prim);
    oracle_pair(judge->oracle, ray, answer->prim, &pair);
    out->share = hit_over(judge, (double)answer->t, &rounding, &out->displacement, &noise);
    if (!judge_in_range(judge, ray, answer->t) && !just_beyond(judge, ray, (double)answer->t))
        return judge_set_wrong(out, WRONG_DISTANCE);
    if (out->share > 1.0) {
        double unused, exact = (double)(float)plane_t_of(judge, ray, answer->prim, &rounding);
        bool open;
        return pair.det != 0 && hit_over(judge, exact, &rounding, &unused, &open) <= 1.0
                   ? judge_set_wrong(out, WRONG_DISTANCE)
                   : judge_impossible(truth, out);
    }
    if (!weights_fit(judge, answer, &rounding))
        return judge_set_wrong(out, WRONG_BARYCENTRIC);
    return noise ? VERDICT_NOISE : judge_by_pair(judge, ray, answer->prim, &pair);
}

double judge_margin_of(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    bool near = false;
    if (!judge_takes(judge, ray, prim))
        return 0.0;
    struct judge_rounding rounding = judge_rounding_at(judge, ray, prim);
    for (int c = 0; c < 3; c++)
        near = near ||
               fabs(judge_edge_distance(&rounding, c)) <= judge_edge_allowed(judge, &rounding, c);
    double scale = fmax(1.0, judge->displacement / JUDGE_DISPLACEMENT_MOST);
    return near ? judge_margin(&rounding) / scale : 0.0;
}

/* The class of a right answer: RIGHT or TIE for one of the exact nearest set, else `why`, which
 * excuses that it is not. */
static enum verdict name_of(const struct judge *judge, const struct ray *ray,
                            const struct oracle_answer *truth, uint32_t prim, enum verdict why)
{
    struct oracle_pair pair;
    enum verdict nearest = truth->tie_count > 1 ? VERDICT_TIE : VERDICT_RIGHT;
    if (prim == truth->prim)
        return nearest;
    if (prim == ABI_NO_PRIM || truth->tie_count == 1)
        return why;
    oracle_pair(judge->oracle, ray, prim, &pair);
    return oracle_is_hit(&pair) && oracle_compare(judge->oracle, ray, prim, truth->prim) == 0
               ? nearest
               : why;
}

enum status judge_by_distance(const struct judge *judge, const struct ray *ray,
                              const struct oracle_answer *truth, const struct hit *answer,
                              struct judgement *out)
{
    bool miss = answer->prim == ABI_NO_PRIM;
    double reach = miss ? (double)INFINITY : (double)answer->t;
    struct judge_loss worst = {.prim = ABI_NO_PRIM, .why = VERDICT_NEAR_TIE};
    enum status status = STATUS_OK;
    if (!miss) {
        out->verdict = judge_named_by_distance(judge, ray, truth, answer, out);
        if (out->verdict == VERDICT_WRONG)
            return STATUS_OK;
    }
    if (truth->prim == ABI_NO_PRIM)
        return STATUS_OK;
    out->margin = judge_margin_of(judge, ray, truth->prim);
    if (!miss && judge->query == QUERY_ANY)
        return STATUS_OK;
    /* Between the nearest and the next hit only the nearest can have been lost. */
    if (reach > truth->t_hi && !(answer->prim == truth->prim && reach <= truth->t_next))
        status = worst_loss(judge, ray, truth, reach, &worst, out);
    out->edge_lost = out->edge_lost && answer->prim != truth->prim;
    if (status)
        return status;
    if (out->verdict == VERDICT_RIGHT)
        out->verdict = name_of(judge, ray, truth, answer->prim, worst.why);
    out->displacement = fmax(out->displacement, worst.need);
    out->share = fmax(out->share, worst.over);
    if (worst.over > 1.0 || (judge->model.watertight && out->fan)) {
        judge_set_wrong(out, WRONG_MISSED);
        judge_set_lost(out, worst.prim, worst.t_lo, worst.t_hi);
    }
    return STATUS_OK;
}

/* The least displacement that excuses the loss, in units of the scene: that of judge_loss_of is the
 * least over what is allowed of it, which of a sliver may be a longer one. */
static double least_need(const struct judge *judge, const struct ray *ray,
                         const struct oracle_crossing *lost, double reach)
{
    const double end[] = {reach, (double)ray->tmin, (double)ray->tmax};
    if (!judge_takes(judge, ray, lost->prim) || !judge_surely_counts(judge, ray, lost->prim, NULL))
        return 0.0;
    struct judge_rounding rounding = judge_rounding_at(judge, ray, lost->prim);
    double need = INFINITY;
    for (int c = 0; c < 3; c++)
        need = fmin(need, fabs(judge_edge_distance(&rounding, c)) * rounding.tri.unit);
    for (int i = 0; i < 3; i++)
        if (isfinite(end[i]))
            need = fmin(need, ray_triangle_plane_distance(end[i], &rounding.tri));
    return need;
}

enum status judge_need(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, const struct hit *answer, double *need)
{
    bool miss = answer->prim == ABI_NO_PRIM;
    double reach = miss ? (double)INFINITY : (double)answer->t;
    *need = 0.0;
    if (!miss) {
        float v[3][3];
        scene_tri(judge->scene, answer->prim, v);
        struct ray_triangle tri = ray_triangle_of(ray, v);
        *need = ray_triangle_distance_at((double)answer->t, &tri);
    }
    if (truth->prim == ABI_NO_PRIM || !(reach > truth->t_hi) ||
        (!miss && judge->query == QUERY_ANY))
        return STATUS_OK;
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    enum status status = judge_crossings(judge, ray, reach, &list, &capacity, &count);
    for (size_t i = 0; i < count && !status; i++) {
        if (!oracle_is_hit(&list[i].pair) || !(reach > list[i].pair.t_hi))
            continue;
        *need = fmax(*need, least_need(judge, ray, &list[i], reach));
    }
    free(list);
    return status;
}

/* Any-hit answers that are a hit and name no triangle: where nothing is exactly hit the formula
 * must be able to accept some triangle. All are tested, since rounding may find one that the ray
 * passes far beside: in the plane of a triangle every sign is open. Only in large worlds are those
 * left out whose instance is far. */
#include "ref/judge/judge_inner.h"

#include <math.h>

#define TOGETHER JUDGE_TOGETHER
_Static_assert(TOGETHER == 64, "a bit of a uint64_t each");

/* --- a first test ------------------------------------------------------------------------------
 */

/* What the first test keeps: what judge_may_be_hit or a formula of judge_looks_first may accept.
 * With x = |coordinate| of what is in brackets, M = [vertex - origin], D = [d] and L = [edge] <= 2
 * M, an edge function may have the other sign by
 *   A |d x e| u M <= 2 sqrt 3 A u M D L for A units of displacement, or, of the widest of
 *   ref/judge/judge_allowed.c, 16 u (6 + 6 + 12) M D L + 10 u 12 M D L = 504 u M D L
 * and by what is flushed, three times 2^-126 (5 + 9 S + 18 S^2) with S the largest of M, D and L.
 */
#define SHAPE    505.0
#define PER_UNIT 3.47
#define LOST     0x1p-119

struct unnamed_look {
    double p[3][3][TOGETHER]; /* vertex - origin */
    double edge[3][TOGETHER];
    double size[TOGETHER], length[TOGETHER];
};

static void take(const struct judge *judge, const struct ray *ray, uint32_t first, uint32_t count,
                 struct unnamed_look *look)
{
    for (uint32_t i = 0; i < TOGETHER; i++) {
        float v[3][3];
        scene_tri(judge->scene, first + (i < count ? i : 0), v);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                look->p[c][k][i] = (double)v[c][k] - (double)ray->org[k];
    }
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static void measure(const struct ray *ray, struct unnamed_look *look)
{
    const double x = (double)ray->dir[0], y = (double)ray->dir[1], z = (double)ray->dir[2];
    for (uint32_t i = 0; i < TOGETHER; i++)
        look->size[i] = look->length[i] = 0.0;
    for (int c = 0; c < 3; c++) {
        double(*a)[TOGETHER] = look->p[(c + 1) % 3], (*b)[TOGETHER] = look->p[(c + 2) % 3];
        for (uint32_t i = 0; i < TOGETHER; i++) {
            double ex = b[0][i] - a[0][i], ey = b[1][i] - a[1][i], ez = b[2][i] - a[2][i];
            double across = x * (a[1][i] * ez - a[2][i] * ey) + y * (a[2][i] * ex - a[0][i] * ez);
            look->edge[c][i] = across + z * (a[0][i] * ey - a[1][i] * ex);
            look->length[i] = larger(look->length[i], larger(fabs(ex), larger(fabs(ey), fabs(ez))));
            look->size[i] =
                larger(look->size[i], larger(fabs(a[0][i]), larger(fabs(a[1][i]), fabs(a[2][i]))));
        }
    }
}

uint64_t judge_first_look(const struct judge *judge, const struct ray *ray, uint32_t first,
                          uint32_t count)
{
    struct unnamed_look look;
    double d =
        fmax(fabs((double)ray->dir[0]), fmax(fabs((double)ray->dir[1]), fabs((double)ray->dir[2])));
    double share = (PER_UNIT * judge->displacement + SHAPE) * JUDGE_UNIT;
    uint64_t out = 0;
    take(judge, ray, first, count, &look);
    measure(ray, &look);
    for (uint32_t i = 0; i < TOGETHER; i++) {
        double s = 1.0 + larger(d, larger(look.size[i], look.length[i]));
        double most = share * look.size[i] * d * look.length[i] + LOST * s * s;
        bool below = look.edge[0][i] < -most || look.edge[1][i] < -most || look.edge[2][i] < -most;
        bool above = look.edge[0][i] > most || look.edge[1][i] > most || look.edge[2][i] > most;
        out |= (uint64_t) !(below && above) << i;
    }
    return out & UINT64_MAX >> (TOGETHER - count);
}

/* --- named formulas --------------------------------------------------------------------------- */

static bool may_hit(const struct judge *judge, const struct ray *ray, uint32_t prim,
                    const struct twin *twin)
{
    if (!twin->possible || isfinite(twin->t_err))
        return twin->possible;
    return judge_can_hit(judge, ray, prim);
}

bool judge_looks_first(const struct model *model)
{
    const struct rounding *k = &model->rounding;
    return k->add <= 2.0 && k->mul <= 2.0 &&
           (model->formula == TWIN_MT || model->formula == TWIN_MT_RTRS ||
            model->formula == TWIN_EMBREE || model->formula == TWIN_PLUECKER);
}

static bool possible_by_twin(const struct judge *judge, const struct ray *ray, uint32_t first,
                             uint32_t count)
{
    struct twin_pair pair[TOGETHER] = {{NULL, 0}};
    struct twin twin[TOGETHER];
    bool possible = false;
    uint64_t left = UINT64_MAX >> (TOGETHER - count);
    uint32_t pairs = 0;
    if (judge_looks_first(&judge->model))
        left = judge_first_look(judge, ray, first, count);
    for (; left; left &= left - 1)
        pair[pairs++] = (struct twin_pair){ray, first + (uint32_t)__builtin_ctzll(left)};
    twin_eval_many(judge->model.formula, judge->model.rounding, judge->scene, pair, pairs, twin);
    for (uint32_t i = 0; i < pairs && !possible; i++)
        possible = may_hit(judge, ray, pair[i].prim, &twin[i]);
    return possible;
}

/* --- an unknown formula ----------------------------------------------------------------------- */

/* How far the triangle is from the ray's point on its plane, cut to the range, in units. */
static double displacement_of(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    float v[3][3];
    judge_tri(judge, prim, v);
    const struct judge_rounding at = judge_rounding_at(judge, ray, prim);
    double t = judge->world ? at.t / at.det : judge_plane_t(ray, v);
    return judge_point_displacement(&at.tri, fmin(fmax(t, (double)ray->tmin), (double)ray->tmax));
}

static bool possible_by_distance(const struct judge *judge, const struct ray *ray, uint32_t first,
                                 uint32_t count, double *least)
{
    bool possible = false;
    for (uint64_t left = judge_first_look(judge, ray, first, count); left; left &= left - 1) {
        uint32_t prim = first + (uint32_t)__builtin_ctzll(left);
        if (judge_may_be_hit(judge, ray, prim)) {
            *least = fmin(*least, displacement_of(judge, ray, prim));
            possible = true;
        }
    }
    return possible;
}

/* --- worlds, where no formula is known that answers so ---------------------------------------- */

/* Whether the ray's line passes a box, widened by NEAR of the largest coordinate. The allowances of
 * ref/judge/judge_distance.c are below that, but for triangles that the line lies in the plane of
 * and which it passes far beside. No tracer of JUDGE_ALL_MOST triangles tests those, since it has
 * boxes itself. */
#define NEAR 0x1p-4

bool judge_comes_near(const struct ray *ray, const struct box *box)
{
    double size = 0, from = -INFINITY, to = INFINITY;
    if (!(box->lo[0] <= box->hi[0]))
        return false; /* of an instance that no ray meets */
    for (int k = 0; k < 3; k++) {
        double most = fmax(fabs((double)box->lo[k]), fabs((double)box->hi[k]));
        size = fmax(size, fmax(most, fabs((double)ray->org[k])));
    }
    for (int k = 0; k < 3; k++) {
        double d = (double)ray->dir[k], lo = (double)box->lo[k] - NEAR * size - (double)ray->org[k];
        double hi = (double)box->hi[k] + NEAR * size - (double)ray->org[k];
        if (d == 0 && (lo > 0 || hi < 0))
            return false;
        if (d == 0)
            continue;
        from = fmax(from, fmin(lo / d, hi / d));
        to = fmin(to, fmax(lo / d, hi / d));
    }
    return from <= to;
}

/* What is found where nothing is exactly hit. */
struct world_search {
    bool ill, possible;
    double least;
};

static void look_into(const struct judge *judge, const struct ray *ray, uint32_t instance,
                      struct world_search *look)
{
    const uint32_t *first = judge->world->first;
    for (uint32_t prim = first[instance]; prim < first[instance + 1] && !look->possible; prim++) {
        if (!judge_may_count(judge, ray, prim))
            continue;
        bool takes = judge_takes(judge, ray, prim);
        look->ill = look->ill || !takes;
        look->possible = takes && judge_may_be_hit(judge, ray, prim);
        if (look->possible)
            look->least = displacement_of(judge, ray, prim);
    }
}

/* Where nothing is exactly hit: what may be, one by one. */
static void judge_in_world(const struct judge *judge, const struct ray *ray, struct judgement *out)
{
    struct world_search look = {.least = INFINITY};
    for (uint32_t i = 0; i < judge->world->instance_count && !look.possible; i++)
        if (!judge->box || judge_comes_near(ray, &judge->box[i]))
            look_into(judge, ray, i, &look);
    bool ill = look.ill, possible = look.possible;
    double least = look.least;
    if (possible) {
        out->verdict = VERDICT_BOUNDARY;
        out->displacement = isfinite(least) ? least : 0.0;
    } else if (ill) {
        out->verdict = VERDICT_OUT_OF_CONTRACT;
        out->ill_conditioned = true;
    } else {
        judge_set_wrong(out, WRONG_PHANTOM);
    }
}

void judge_unnamed_hit(const struct judge *judge, const struct ray *ray,
                       const struct oracle_answer *truth, struct judgement *out)
{
    bool unknown = judge->model.formula == TWIN_UNKNOWN, possible = false;
    double least = INFINITY;
    if (truth->prim != ABI_NO_PRIM)
        return;
    if (judge->world) {
        judge_in_world(judge, ray, out);
        return;
    }
    for (uint32_t first = 0; first < judge->scene->tri_count && !possible; first += TOGETHER) {
        uint32_t left = judge->scene->tri_count - first, count = left < TOGETHER ? left : TOGETHER;
        possible = unknown ? possible_by_distance(judge, ray, first, count, &least)
                           : possible_by_twin(judge, ray, first, count);
    }
    out->verdict = possible ? VERDICT_BOUNDARY : VERDICT_WRONG;
    out->wrong = possible ? WRONG_NOT : WRONG_PHANTOM;
    if (isfinite(least))
        out->displacement = least;
}

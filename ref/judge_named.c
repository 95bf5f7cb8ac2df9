/* The triangle that an answer names, judged by itself. */
#include "ref/judge_inner.h"

#include <math.h>

/* How far outside a triangle's box, relative to the coordinates, a hit in its plane may be. */
#define IN_PLANE_PAD (64.0 * JUDGE_UNIT)

/* Where the determinant's sign is open the ray lies in the triangle's plane, as far as float32 can
 * tell: then every t is right at which the ray is inside the triangle's box, and any other is the
 * quotient of two roundings. */
static bool on_the_triangle(const struct ray *ray, float v[3][3], double t)
{
    for (int k = 0; k < 3; k++) {
        double o = (double)ray->org[k], at = o + t * (double)ray->dir[k];
        double lo = (double)v[0][k], hi = lo;
        for (int c = 1; c < 3; c++) {
            lo = fmin(lo, (double)v[c][k]);
            hi = fmax(hi, (double)v[c][k]);
        }
        double pad = IN_PLANE_PAD * (fmax(fabs(lo), fabs(hi)) + fabs(o));
        if (!(at >= lo - pad && at <= hi + pad))
            return false;
    }
    return true;
}

/* The determinant's sign is open, so nothing bounds t. */
static enum verdict unbounded(const struct ray *ray, float v[3][3], const struct oracle_pair *pair,
                              double t)
{
    if (!on_the_triangle(ray, v, t))
        return VERDICT_NOISE;
    return pair->class == ORACLE_IN_PLANE || pair->class == ORACLE_ZERO_AREA ? VERDICT_IN_PLANE
                                                                             : VERDICT_BOUNDARY;
}

/* What the exact pair says of an answer whose t, u and v are right for the triangle's plane. */
static enum verdict by_pair(const struct judge *judge, const struct oracle_pair *pair)
{
    switch (pair->class) {
    case ORACLE_INSIDE:
    case ORACLE_EDGE:
    case ORACLE_VERTEX:
        if (pair->range == ORACLE_WITHIN)
            return VERDICT_RIGHT;
        if (pair->range == ORACLE_AT_TMIN || pair->range == ORACLE_AT_TMAX)
            return judge->model.open ? VERDICT_BORDER : VERDICT_RIGHT;
        return VERDICT_BORDER;
    case ORACLE_IN_PLANE:
    case ORACLE_ZERO_AREA:
        return VERDICT_IN_PLANE;
    case ORACLE_MISS:
    case ORACLE_CLASS_COUNT:
        break;
    }
    return VERDICT_BOUNDARY;
}

static enum verdict wrong(struct judgement *out, enum wrong kind)
{
    out->wrong = kind;
    return VERDICT_WRONG;
}

enum verdict judge_named(const struct judge *judge, const struct ray *ray,
                         const struct oracle_answer *truth, const struct hit *answer,
                         const struct judge_known *known, struct judgement *out)
{
    float v[3][3];
    struct oracle_pair pair;
    struct twin twin = judge_twin(judge, ray, answer->prim, known);
    double t = (double)answer->t;
    scene_tri(judge->scene, answer->prim, v);
    if (!twin.possible)
        return wrong(out, truth->prim == ABI_NO_PRIM ? WRONG_PHANTOM : WRONG_TRIANGLE);
    /* An own formula compares the very t that it answers; Embree compares before it divides. */
    if (judge->own && !judge_in_range(judge, ray, answer->t))
        return wrong(out, WRONG_DISTANCE);
    oracle_pair(judge->oracle, ray, answer->prim, &pair);
    if (!isfinite(twin.t_err))
        return unbounded(ray, v, &pair, t);
    double share = JUDGE_SHARE * twin.t_err;
    out->over = judge_over(t, twin.t_near - share, twin.t_near + share, twin.t_err);
    if (!(out->over <= 1.0))
        return wrong(out, WRONG_DISTANCE);
    if (!judge_barycentrics(&twin, answer))
        return wrong(out, WRONG_BARYCENTRIC);
    return by_pair(judge, &pair);
}

/* The triangle that an answer names, judged alone. */
#include "ref/judge/judge_inner.h"

#include <math.h>

/* How far outside a triangle's box, relative to the coordinates, a hit in its plane may be. */
#define IN_PLANE_PAD (64.0 * JUDGE_UNIT)

/* Bounds of u and v, and of t in proportion, that decide alone; a choice of speed. */
#define SHARP 0.25

struct judge_line {
    double o[3], d[3], o_off[3], d_off[3];
};

/* Where the determinant's sign is open the ray lies in the triangle's plane, within the precision
 * of float32: then a possible t counts as on the triangle if the ray is inside its box there, and
 * any other is the quotient of two roundings. */
static bool on_the_triangle(const struct judge_line *line, float v[3][3], double t)
{
    for (int k = 0; k < 3; k++) {
        double o = line->o[k], at = o + t * line->d[k];
        double lo = INFINITY, hi = -INFINITY;
        for (int c = 0; c < 3; c++) {
            lo = fmin(lo, (double)v[c][k]);
            hi = fmax(hi, (double)v[c][k]);
        }
        double pad = IN_PLANE_PAD * (fmax(fabs(lo), fabs(hi)) + fabs(o));
        pad += line->o_off[k] + fabs(t) * line->d_off[k];
        if (!(at >= lo - pad && at <= hi + pad))
            return false;
    }
    return true;
}

/* The ray in the space of the triangle test, and how far a computed one is off. */
static struct judge_line line_of(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    struct judge_line line = {.o = {0.0}};
    struct twin_ray placed;
    if (judge->world)
        judge_take_along(judge, ray, prim, &placed);
    for (int k = 0; k < 3; k++) {
        line.o[k] = judge->world ? placed.org_near[k] : (double)ray->org[k];
        line.d[k] = judge->world ? placed.dir_near[k] : (double)ray->dir[k];
        line.o_off[k] = judge->world ? placed.org_off[k] : 0.0;
        line.d_off[k] = judge->world ? placed.dir_off[k] : 0.0;
    }
    return line;
}

static bool lies_in_plane(const struct oracle_pair *pair)
{
    return pair->class == ORACLE_IN_PLANE || pair->class == ORACLE_ZERO_AREA;
}

/* The determinant's sign is open, so nothing bounds t. */
static enum verdict unbounded(const struct judge *judge, const struct ray *ray, uint32_t prim,
                              const struct oracle_pair *pair, double t)
{
    float v[3][3];
    struct judge_line line = line_of(judge, ray, prim);
    judge_tri(judge, prim, v);
    if (!on_the_triangle(&line, v, t))
        return VERDICT_NOISE;
    return lies_in_plane(pair) ? VERDICT_IN_PLANE : VERDICT_BOUNDARY;
}

/* True if an exact hit counts, exactly. */
static bool counts(const struct judge *judge, const struct ray *ray, uint32_t prim,
                   const struct oracle_pair *pair)
{
    return !judge->world ||
           oracle_admit(judge->oracle, ray, judge->mode, prim, pair) == ORACLE_ADMITTED;
}

enum verdict judge_by_pair(const struct judge *judge, const struct ray *ray, uint32_t prim,
                           const struct oracle_pair *pair)
{
    enum oracle_ends ends = judge->model.open ? ORACLE_OPEN : ORACLE_CLOSED;
    if (oracle_is_hit(pair) && !oracle_in_range(pair, ends))
        return VERDICT_BORDER;
    if (oracle_is_hit(pair))
        return counts(judge, ray, prim, pair) ? VERDICT_RIGHT : VERDICT_BOUNDARY;
    return lies_in_plane(pair) ? VERDICT_IN_PLANE : VERDICT_BOUNDARY;
}

/* True if the bounds are so wide that a replay may decide more. */
static bool says_little(const struct twin *twin)
{
    return !(twin->t_err <= SHARP * fabs(twin->t_near)) || !(twin->u_err <= SHARP) ||
           !(twin->v_err <= SHARP);
}

/* One unit of the last place of a float32, at its largest. */
static double last_place(double value)
{
    return 2.0 * JUDGE_UNIT * fabs(value) + ROUNDING_IEEE.tiny;
}

/* To one unit of the last place, and what the near value is off. */
static bool is_near(float value, double near, double off)
{
    return fabs((double)value - near) <= last_place(near) + off;
}

/* True if the triangle is exactly hit and the answer is where, to one unit of its last place:
 * right, even if no evaluation of the formula comes to these very numbers. */
static bool is_exact(const struct oracle_pair *pair, const struct twin *twin,
                     const struct hit *answer)
{
    double t = (double)answer->t, u = (double)answer->u, v = (double)answer->v;
    if (!oracle_is_hit(pair) || !oracle_in_range(pair, ORACLE_CLOSED))
        return false;
    if (!isfinite(twin->t_err)) /* of a sliver: by t alone */
        return t >= pair->t_lo - last_place(pair->t_lo) &&
               t <= pair->t_hi + last_place(pair->t_hi) && u >= 0.0 && v >= 0.0 &&
               u + v <= 1.0 + JUDGE_SHARE;
    /* Of what has no bound, as a triangle's share of its hit, the near value is good enough. */
    return is_near(answer->t, twin->t_near, twin->t_off) &&
           is_near(answer->u, twin->u_near, JUDGE_SHARE * fmin(twin->u_err, 1.0)) &&
           is_near(answer->v, twin->v_near, JUDGE_SHARE * fmin(twin->v_err, 1.0));
}

enum verdict judge_named(const struct judge *judge, const struct ray *ray,
                         const struct oracle_answer *truth, const struct hit *answer,
                         const struct judge_known *known, struct judgement *out)
{
    struct oracle_pair pair;
    uint32_t prim = answer->prim;
    struct twin twin = judge_twin(judge, ray, prim, known);
    double t = (double)answer->t;
    if (!judge_takes(judge, ray, prim))
        return VERDICT_OUT_OF_CONTRACT;
    if (!twin.possible)
        return judge_impossible(truth, out);
    if (!judge_may_keep(judge, ray, prim, answer->t))
        return judge_set_wrong(out, WRONG_DISTANCE);
    oracle_pair(judge->oracle, ray, prim, &pair);
    if (says_little(&twin) && !is_exact(&pair, &twin, answer) &&
        !judge_can_answer(judge, ray, prim, answer))
        return judge_can_hit(judge, ray, prim) ? judge_set_wrong(out, WRONG_DISTANCE)
                                               : judge_impossible(truth, out);
    if (!isfinite(twin.t_err))
        return unbounded(judge, ray, prim, &pair, t);
    out->over = judge_over(t, twin.t_near - twin.t_off, twin.t_near + twin.t_off, twin.t_err);
    if (!(out->over <= 1.0))
        return judge_set_wrong(out, WRONG_DISTANCE);
    if (!judge_barycentrics(&twin, answer))
        return judge_set_wrong(out, WRONG_BARYCENTRIC);
    return judge_by_pair(judge, ray, prim, &pair);
}

/* What counts in a world: masks, opacity, facing and filter. All of it is exact, but for the side
 * that is seen where the determinant's sign is open, and for the filter's cell where u or v may lie
 * in another. */
#include "ref/judge/judge_inner.h"

#include <math.h>
#include <stdlib.h>

#define CELLS ((int)ABI_FILTER_GRID)

/* A triangle as the world sees it. */
struct standing_of {
    const struct instance *instance;
    struct place place;
    bool opaque; /* with the flags of instance and ray */
};

static struct standing_of stand(const struct judge *judge, uint32_t prim)
{
    const struct world *world = judge->world;
    struct place place = world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    bool opaque = world->mesh[place.mesh].geometry[place.geometry].opaque;
    return (struct standing_of){instance, place, world_is_opaque(instance, opaque, judge->mode)};
}

static bool is_finite_ray(const struct ray *ray)
{
    bool finite = true;
    for (int k = 0; k < 3; k++)
        finite = finite && float_is_finite(ray->org[k]) && float_is_finite(ray->dir[k]);
    return finite;
}

/* --- the side that is seen -------------------------------------------------------------------- */

/* Of an unknown formula: by the exact sign, where no displacement that is allowed turns it. */
static int side_by_distance(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    struct judge_rounding rounding = judge_rounding_at(judge, ray, prim);
    struct judge_at at = judge_locate(judge, prim);
    struct oracle_pair pair;
    if (!judge_takes(judge, ray, prim) || judge_side_is_open(judge, &rounding))
        return 0;
    oracle_pair(judge->oracle, ray, prim, &pair);
    return pair.det * instance_det_sign((const float(*)[4])judge->world->instance[at.instance].m);
}

/* The sign of d . ((v1 - v0) x (v2 - v0)) in the space of the mesh, in every evaluation; 0: it is
 * open. */
static int side_of(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    struct twin_ray placed;
    float v[3][3];
    if (!is_finite_ray(ray))
        return 0;
    if (!judge->own)
        return side_by_distance(judge, ray, prim);
    judge_tri(judge, prim, v);
    judge_take_along(judge, ray, prim, &placed);
    return twin_placed_side(judge->model.rounding, &placed, v);
}

static bool culls(const struct judge *judge, const struct standing_of *at, bool front)
{
    return world_culls(at->instance, at->opaque, front, judge->mode);
}

/* --- the filter ------------------------------------------------------------------------------- */

/* A number in cell `cell`, or the nearest to x in it. */
static double into_cell(double x, int cell)
{
    double lo = cell == 0 ? -(double)INFINITY : (double)cell / CELLS;
    double hi = cell == CELLS - 1 ? (double)INFINITY : (double)(cell + 1) / CELLS;
    return fmin(fmax(x, lo), hi);
}

/* u and v of a triangle, or how far they may be from what is computed. */
struct weights_seen {
    struct judge_rounding rounding; /* of an unknown formula */
    double near[2], off[2];         /* of others */
};

static struct weights_seen weights_of(const struct judge *judge, const struct ray *ray,
                                      uint32_t prim, const struct twin *twin)
{
    struct weights_seen out = {.off = {INFINITY, INFINITY}};
    if (!judge->own) {
        out.rounding = judge_rounding_at(judge, ray, prim);
        return out;
    }
    out.near[0] = twin->u_near;
    out.near[1] = twin->v_near;
    out.off[0] = twin->u_err * (1.0 + JUDGE_SHARE);
    out.off[1] = twin->v_err * (1.0 + JUDGE_SHARE);
    return out;
}

/* True if u (0) or v (1) may be computed in that cell. */
static bool reaches(const struct judge *judge, const struct weights_seen *seen, int which, int cell)
{
    if (judge->own) {
        double near = seen->near[which];
        return isinf(seen->off[which]) || fabs(into_cell(near, cell) - near) <= seen->off[which];
    }
    const struct judge_rounding *r = &seen->rounding;
    return r->det == 0.0 ||
           judge_weight_allowed(r, 1 + which, into_cell(r->edge[1 + which] / r->det, cell));
}

static bool cell_passes(const struct judge *judge, const struct place *place, int u, int v)
{
    return filter_passes(&judge->world->filter, place, ((float)u + 0.5f) / (float)CELLS,
                         ((float)v + 0.5f) / (float)CELLS);
}

/* Whether the filter passes in some cell that u and v may reach (`all`: in each). */
static bool passes(const struct judge *judge, const struct ray *ray, uint32_t prim,
                   const struct standing_of *at, const struct twin *twin, bool all)
{
    if (at->opaque || !filter_reads_uv(&judge->world->filter))
        return at->opaque || cell_passes(judge, &at->place, 0, 0);
    struct weights_seen seen = weights_of(judge, ray, prim, twin);
    for (int u = 0; u < CELLS; u++)
        for (int v = 0; v < CELLS; v++)
            if (reaches(judge, &seen, 0, u) && reaches(judge, &seen, 1, v) &&
                cell_passes(judge, &at->place, u, v) != all)
                return !all;
    return all;
}

/* An engine that promises C's bits asks the filter about the very u and v that it answers. */
static bool may_pass(const struct judge *judge, const struct ray *ray, const struct hit *answer,
                     const struct standing_of *at)
{
    bool numbers = float_is_finite(answer->u) && float_is_finite(answer->v);
    struct twin twin = {.u_err = INFINITY, .v_err = INFINITY};
    if (at->opaque || !filter_reads_uv(&judge->world->filter))
        return at->opaque || cell_passes(judge, &at->place, 0, 0);
    if (!numbers || !is_finite_ray(ray))
        return true; /* judged otherwise */
    if (judge->model.bits)
        return filter_passes(&judge->world->filter, &at->place, answer->u, answer->v);
    if (!judge->in_contract || !ray_in_contract(ray))
        return true; /* u and v may be any */
    if (judge->own)
        twin = judge_twin(judge, ray, answer->prim, NULL);
    return passes(judge, ray, answer->prim, at, &twin, false);
}

/* --- answers ---------------------------------------------------------------------------------- */

enum wrong judge_ruled_out(const struct judge *judge, const struct ray *ray,
                           const struct hit *answer, uint32_t tag)
{
    struct standing_of at = stand(judge, answer->prim);
    const uint32_t opacity = ABI_RAY_CULL_OPAQUE | ABI_RAY_CULL_NO_OPAQUE;
    const struct ray_mode by_opacity = {judge->mode.mask, judge->mode.flags & opacity};
    bool front = tag & ABI_TAG_FRONT;
    if (!world_meets(at.instance, judge->mode))
        return WRONG_MASKED;
    if (world_culls(at.instance, at.opaque, front, by_opacity))
        return WRONG_OPACITY;
    if ((tag & ~ABI_TAG_FRONT) != at.instance->custom)
        return WRONG_INSTANCE;
    int side = side_of(judge, ray, answer->prim);
    bool seen = side == 0 ? front : world_is_front(at.instance, side);
    if (culls(judge, &at, seen))
        return WRONG_CULLED;
    if (seen != front)
        return WRONG_FACING;
    return may_pass(judge, ray, answer, &at) ? WRONG_NOT : WRONG_OPACITY;
}

bool judge_surely_counts(const struct judge *judge, const struct ray *ray, uint32_t prim,
                         const struct twin *twin)
{
    if (!judge->world)
        return true;
    struct standing_of at = stand(judge, prim);
    if (!world_meets(at.instance, judge->mode))
        return false;
    bool front = culls(judge, &at, true), back = culls(judge, &at, false);
    if (front != back) {
        int side = side_of(judge, ray, prim);
        if (side == 0 || (world_is_front(at.instance, side) ? front : back))
            return false;
    } else if (front) {
        return false;
    }
    return passes(judge, ray, prim, &at, twin, true);
}

bool judge_may_count(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    const struct twin any = {.u_err = INFINITY, .v_err = INFINITY};
    struct standing_of at = stand(judge, prim);
    int side = side_of(judge, ray, prim);
    bool culled = side == 0 ? culls(judge, &at, true) && culls(judge, &at, false)
                            : culls(judge, &at, world_is_front(at.instance, side));
    return world_meets(at.instance, judge->mode) && !culled &&
           passes(judge, ray, prim, &at, &any, false);
}

/* True if `t` is within the bound of that exact hit. */
static bool fits(const struct judge *judge, const struct ray *ray,
                 const struct oracle_crossing *crossing, float t)
{
    if (!judge->own) {
        struct judge_rounding r = judge_rounding_at(judge, ray, crossing->prim);
        double off = ray_triangle_plane_distance((double)t, &r.tri) / r.tri.unit;
        return off <= judge_plane_allowed(judge, &r, (double)t);
    }
    struct twin twin = judge_twin(judge, ray, crossing->prim, NULL);
    return judge_over((double)t, crossing->pair.t_lo, crossing->pair.t_hi, twin.t_err) <= 1.0;
}

enum status judge_is_anothers(const struct judge *judge, const struct ray *ray,
                              const struct hit *answer, bool *found)
{
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    *found = false;
    if (!judge->world)
        return STATUS_OK;
    struct judge_at named = judge_locate(judge, answer->prim);
    enum status status = judge_crossings(judge, ray, (double)INFINITY, &list, &capacity, &count);
    bool own = false; /* its t is that of the triangle it names */
    for (size_t i = 0; i < count && !status && !own; i++)
        own = list[i].prim == answer->prim && fits(judge, ray, &list[i], answer->t);
    for (size_t i = 0; i < count && !status && !own && !*found; i++) {
        struct judge_at other = judge_locate(judge, list[i].prim);
        *found = oracle_is_hit(&list[i].pair) && other.instance != named.instance &&
                 other.mesh == named.mesh && other.prim == named.prim &&
                 fits(judge, ray, &list[i], answer->t);
    }
    free(list);
    return status;
}

/* A triangle that is judged: of a scene, or of a mesh that an instance has placed. All other files
 * of the judge see triangles through these functions. */
#include "ref/judge/judge_inner.h"

#include <math.h>

struct judge_at judge_locate(const struct judge *judge, uint32_t prim)
{
    const struct world *world = judge->world;
    if (!world)
        return (struct judge_at){.scene = judge->scene, .prim = prim};
    uint32_t instance = world_instance_of(world, prim), base = world->first[instance];
    return (struct judge_at){world_scene(world, instance), prim - base, base,
                             world->instance[instance].mesh, instance};
}

void judge_tri(const struct judge *judge, uint32_t prim, float v[3][3])
{
    struct judge_at at = judge_locate(judge, prim);
    scene_tri(at.scene, at.prim, v);
}

static void take_to(const struct judge *judge, const struct ray *ray, uint32_t instance,
                    struct twin_ray *out)
{
    twin_ray_of(&judge->place[instance], judge->model.rounding, !judge->model.bits, ray, out);
}

void judge_take_along(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      struct twin_ray *out)
{
    take_to(judge, ray, world_instance_of(judge->world, prim), out);
}

static bool in_contract_there(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    struct twin_ray placed;
    judge_take_along(judge, ray, prim, &placed);
    return placed.in_contract;
}

bool judge_takes(const struct judge *judge, const struct ray *ray, uint32_t prim)
{
    if (!judge->world)
        return true;
    if (judge->model.formula == TWIN_UNKNOWN)
        return judge->place[world_instance_of(judge->world, prim)].kappa <= JUDGE_KAPPA_MOST;
    return in_contract_there(judge, ray, prim);
}

enum verdict judge_finite(const struct judge *judge, const struct ray *ray, const struct hit *hit)
{
    if (float_is_finite(hit->t) && float_is_finite(hit->u) && float_is_finite(hit->v))
        return VERDICT_RIGHT;
    bool excused =
        judge->world && hit->prim < judge->tri_count && !in_contract_there(judge, ray, hit->prim);
    return excused ? VERDICT_OUT_OF_CONTRACT : VERDICT_WRONG;
}

struct twin judge_twin(const struct judge *judge, const struct ray *ray, uint32_t prim,
                       const struct judge_known *known)
{
    float v[3][3];
    for (size_t i = 0; known && i < known->count; i++)
        if (known->prim[i] == prim)
            return known->twin[i];
    judge_tri(judge, prim, v);
    if (judge->world) {
        struct twin_ray placed;
        judge_take_along(judge, ray, prim, &placed);
        return twin_eval_placed(judge->model.formula, judge->model.rounding, &placed, v);
    }
    struct twin twin = twin_eval(judge->model.formula, judge->model.rounding, ray, v);
    return twin;
}

enum status judge_crossings(const struct judge *judge, const struct ray *ray, double t_most,
                            struct oracle_crossing **list, size_t *capacity, size_t *count)
{
    if (judge->world)
        return oracle_crossings_world(judge->oracle, ray, judge->mode, t_most, list, capacity,
                                      count, NULL);
    return oracle_crossings(judge->oracle, ray, t_most, list, capacity, count, NULL);
}

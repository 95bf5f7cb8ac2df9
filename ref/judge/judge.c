#include "ref/judge/judge_inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Larger coordinates are out of contract: degree 3 in them overflows float32 a little later. */
#define LARGEST_COORDINATE 0x1p40f

const char *verdict_name(enum verdict verdict)
{
    static const char *const names[VERDICT_COUNT] = {
        "right",    "tie",  "near_tie", "boundary",        "border",
        "in_plane", "slab", "noise",    "out_of_contract", "wrong",
    };
    return verdict < VERDICT_COUNT ? names[verdict] : "unknown";
}

const char *wrong_name(enum wrong wrong)
{
    static const char *const names[WRONG_COUNT] = {
        "not",        "missed",         "phantom",       "triangle", "distance", "barycentric",
        "not_finite", "not_repeatable", "any_disagrees", "twice",    "order",    "masked",
        "culled",     "opacity",        "instance",      "facing"};
    return wrong < WRONG_COUNT ? names[wrong] : "unknown";
}

/* The coordinates of a scene are in contract. */
static bool scene_in_contract(const struct scene *scene, float largest[3])
{
    bool in_contract = true;
    struct box box = scene_bounds(scene);
    for (int k = 0; k < 3 && scene->tri_count > 0; k++) {
        largest[k] = fmaxf(fabsf(box.lo[k]), fabsf(box.hi[k]));
        in_contract = in_contract && largest[k] <= LARGEST_COORDINATE;
    }
    return in_contract;
}

/* The transform of one instance, and whether its coordinates are in contract in the world.
 *   largest  of its mesh */
static enum status make_place(struct judge *judge, uint32_t i, const float largest[3],
                              struct reason *reason)
{
    const struct instance *instance = &judge->world->instance[i];
    struct reason why = {""};
    if (twin_place_of(instance, &judge->place[i], &why))
        return fail(reason, STATUS_LIMIT, "instance %u: %s", i, why.text);
    for (int k = 0; k < 3; k++) {
        double reach = fabs((double)instance->m[k][3]);
        for (int j = 0; j < 3; j++)
            reach += fabs((double)instance->m[k][j]) * (double)largest[j];
        judge->in_contract = judge->in_contract && reach <= (double)LARGEST_COORDINATE;
    }
    return STATUS_OK;
}

/* The transforms, and whether coordinates are in contract in every mesh that is placed, and in the
 * world. */
static enum status make_places(struct judge *judge, struct reason *reason)
{
    const struct world *world = judge->world;
    struct mesh_size {
        bool known;
        float largest[3];
    } *size = alloc_zeroed(world->mesh_count, sizeof *size);
    enum status status = STATUS_OK;
    judge->place = alloc_zeroed(world->instance_count, sizeof *judge->place);
    if (!size || !judge->place)
        status = fail(reason, STATUS_MEMORY, "no memory for a judge");
    for (uint32_t i = 0; i < world->instance_count && !status; i++) {
        uint32_t mesh = world->instance[i].mesh;
        if (mesh == WORLD_NO_MESH || world_scene(world, i)->tri_count == 0)
            continue;
        struct mesh_size *of = &size[mesh];
        if (!of->known && !scene_in_contract(world_scene(world, i), of->largest))
            judge->in_contract = false;
        of->known = true;
        status = make_place(judge, i, of->largest, reason);
    }
    free(size);
    return status;
}

/* Boxes of instances, where there are too many triangles to look at each. */
static enum status make_boxes(struct judge *judge, struct reason *reason)
{
    if (!judge->model.any_unnamed || judge->query != QUERY_ANY ||
        judge->tri_count <= JUDGE_ALL_MOST)
        return STATUS_OK;
    return world_boxes_make(judge->world, WORLD_BOXES_OF_CORNERS, &judge->box, reason);
}

static enum status make_lazy(struct judge *judge, struct reason *reason)
{
    uint32_t count = judge->world ? judge->world->mesh_count : 1;
    struct judge_lazy *lazy = judge->lazy = alloc_zeroed(1, sizeof *lazy);
    if (!lazy)
        return fail(reason, STATUS_MEMORY, "no memory for a judge");
    pthread_mutex_init(&lazy->lock, NULL);
    lazy->topology = alloc_zeroed(count, sizeof *lazy->topology);
    if (!lazy->topology)
        return fail(reason, STATUS_MEMORY, "no memory for a judge");
    lazy->count = count;
    for (uint32_t i = 0; i < count; i++)
        atomic_init(&lazy->topology[i], NULL);
    return STATUS_OK;
}

enum status judge_make(const struct oracle *oracle, const struct model *model, enum query query,
                       struct judge **out, struct reason *reason)
{
    struct judge *judge = alloc_zeroed(1, sizeof *judge);
    *out = judge;
    if (!judge)
        return fail(reason, STATUS_MEMORY, "no memory for a judge");
    judge->oracle = oracle;
    judge->scene = oracle_scene(oracle);
    judge->world = oracle_world(oracle);
    judge->tri_count = judge->world ? world_tri_count(judge->world) : judge->scene->tri_count;
    judge->mode = ray_mode_all();
    judge->model = *model;
    if (judge->world && !twin_is_own(model->formula)) { /* transforms are its own, too */
        judge->model.formula = TWIN_UNKNOWN;
        judge->beyond = judge_share_beyond(model); /* but t is not transformed */
    }
    judge->query = query;
    judge->own = twin_is_own(model->formula);
    judge->displacement = model->displacement > 0.0 ? model->displacement : JUDGE_DISPLACEMENT_MOST;
    /* The proof in judge_fan.c needs the same rounding of the same product wherever it is made. */
    judge->fans =
        model->watertight && model->formula == TWIN_WOOP && rounding_is_nearest(model->rounding);
    judge->in_contract = judge->world || scene_in_contract(judge->scene, judge->largest);
    enum status status = judge->world ? make_places(judge, reason) : STATUS_OK;
    if (!status && judge->world)
        status = make_boxes(judge, reason);
    if (!status)
        status = make_lazy(judge, reason);
    if (status) {
        judge_free(judge);
        *out = NULL;
    }
    return status;
}

void judge_by_bounds(struct judge *judge, bool on)
{
    judge->by_bounds = on;
}

static void free_lazy(struct judge_lazy *lazy)
{
    for (uint32_t i = 0; i < lazy->count; i++) {
        struct topology *topology = atomic_load(&lazy->topology[i]);
        if (topology)
            topology_free(topology);
        free(topology);
    }
    free(lazy->topology);
    pthread_mutex_destroy(&lazy->lock);
    free(lazy);
}

void judge_free(struct judge *judge)
{
    if (!judge)
        return;
    if (judge->lazy)
        free_lazy(judge->lazy);
    free(judge->box);
    free(judge->place);
    free(judge);
}

double judge_over(double t, double lo, double hi, double bound)
{
    double error = t < lo ? lo - t : t > hi ? t - hi : 0.0;
    return error > 0.0 ? error / bound : 0.0;
}

bool judge_in_range(const struct judge *judge, const struct ray *ray, float t)
{
    return judge->model.open ? t > ray->tmin && t < ray->tmax : t >= ray->tmin && t <= ray->tmax;
}

bool judge_barycentrics(const struct twin *twin, const struct hit *answer)
{
    double u = fabs((double)answer->u - twin->u_near), u_most = twin->u_err * (1 + JUDGE_SHARE);
    double w = fabs((double)answer->v - twin->v_near), w_most = twin->v_err * (1 + JUDGE_SHARE);
    return (isinf(twin->u_err) || u <= u_most) && (isinf(twin->v_err) || w <= w_most);
}

/* Most answers: the nearest triangle itself, t within its bound. True if that settles it. */
static bool settled(const struct judge *judge, const struct ray *ray,
                    const struct oracle_answer *truth, const struct hit *answer,
                    const struct judge_known *known, struct judgement *out)
{
    struct twin twin = judge_twin(judge, ray, truth->prim, known);
    double t = (double)answer->t;
    if (!isfinite(twin.t_err) || !judge_in_range(judge, ray, answer->t))
        return false;
    double over = judge_over(t, truth->t_lo, truth->t_hi, twin.t_err);
    /* Behind the next hit: then it may be that one that was lost. */
    if (!(over <= 1.0) || !(judge->query == QUERY_ANY || t <= truth->t_next) ||
        !judge_barycentrics(&twin, answer))
        return false;
    out->over = over;
    out->verdict =
        truth->tie_count > 1 && judge->query == QUERY_CLOSEST ? VERDICT_TIE : VERDICT_RIGHT;
    return true;
}

/* The rule: the named triangle is possible, its t is right, and no certain hit lies before it. */
static enum status judge_certified(const struct judge *judge, const struct ray *ray,
                                   const struct oracle_answer *truth, const struct hit *answer,
                                   const struct judge_known *known, struct judgement *out)
{
    bool miss = answer->prim == ABI_NO_PRIM, lost = false;
    if (truth->prim == ABI_NO_PRIM && miss)
        return STATUS_OK;
    if (!miss && answer->prim == truth->prim && settled(judge, ray, truth, answer, known, out))
        return STATUS_OK;
    enum verdict named = VERDICT_RIGHT;
    if (!miss) {
        named = out->verdict = judge_named(judge, ray, truth, answer, known, out);
        if (named == VERDICT_WRONG || judge->query == QUERY_ANY)
            return STATUS_OK;
    }
    double reach = miss ? (double)INFINITY : (double)answer->t;
    enum status status = judge_lost(judge, ray, truth, reach, known, &lost, out);
    if (status || lost) {
        judge_set_wrong(out, WRONG_MISSED);
        return status;
    }
    if (named != VERDICT_RIGHT)
        return STATUS_OK;
    if (!miss && truth->prim == answer->prim)
        out->verdict = truth->tie_count > 1 ? VERDICT_TIE : VERDICT_RIGHT;
    else if (!miss && truth->tie_count > 1 &&
             oracle_compare(judge->oracle, ray, answer->prim, truth->prim) == 0)
        out->verdict = VERDICT_TIE;
    else
        out->verdict =
            judge_why_lost(judge, ray, truth->prim, truth->t_lo, truth->t_hi, reach, known);
    return STATUS_OK;
}

enum status judge_knowing(const struct judge *judge, const struct ray *ray, bool in_contract,
                          const struct oracle_answer *truth, const struct hit *answer,
                          const struct judge_known *known, struct judgement *out)
{
    bool hit = answer->prim != ABI_NO_PRIM;
    bool unnamed = judge->query == QUERY_ANY && judge->model.any_unnamed;
    enum status status = STATUS_OK;
    *out = (struct judgement){.verdict = VERDICT_RIGHT,
                              .expected = truth->prim,
                              .t_lo = truth->t_lo,
                              .t_hi = truth->t_hi};
    if (hit && !unnamed && answer->prim >= judge->tri_count) {
        judge_set_wrong(out, WRONG_PHANTOM); /* whatever the ray */
        return STATUS_OK;
    }
    if (!judge->in_contract || !in_contract) {
        out->verdict = VERDICT_OUT_OF_CONTRACT;
        return STATUS_OK;
    }
    enum verdict finite = judge_finite(judge, ray, answer);
    if (finite == VERDICT_WRONG)
        judge_set_wrong(out, WRONG_NOT_FINITE);
    else if (finite == VERDICT_OUT_OF_CONTRACT)
        out->verdict = finite;
    else if (unnamed && hit)
        judge_unnamed_hit(judge, ray, truth, out);
    else if (judge->model.formula == TWIN_UNKNOWN)
        status = judge_by_distance(judge, ray, truth, answer, out);
    else
        status = judge_certified(judge, ray, truth, answer, known, out);
    if (status)
        *out = (struct judgement){.verdict = VERDICT_OUT_OF_CONTRACT, .expected = truth->prim};
    return status;
}

enum status judge_answer(const struct judge *judge, const struct ray *ray,
                         const struct oracle_answer *truth, const struct hit *answer,
                         struct judgement *out)
{
    return judge_knowing(judge, ray, ray_in_contract(ray), truth, answer, NULL, out);
}

/* True of a class that leaves open whether something is hit. */
static bool is_open(enum verdict verdict)
{
    return verdict == VERDICT_BOUNDARY || verdict == VERDICT_BORDER ||
           verdict == VERDICT_IN_PLANE || verdict == VERDICT_SLAB || verdict == VERDICT_NOISE;
}

static bool is_unjudged(const struct judgement *judgement)
{
    return judgement->verdict == VERDICT_OUT_OF_CONTRACT;
}

void judge_any_against_closest(const struct judge *judge, const struct ray *ray,
                               const struct hit *closest, const struct judgement *closest_judgement,
                               const struct hit *any, struct judgement *any_judgement)
{
    bool any_hit = any->prim != ABI_NO_PRIM, truth_hit = any_judgement->expected != ABI_NO_PRIM;
    if ((closest->prim != ABI_NO_PRIM) == any_hit || !judge->in_contract || !ray_in_contract(ray) ||
        any_judgement->verdict == VERDICT_WRONG || is_unjudged(closest_judgement) ||
        is_unjudged(any_judgement))
        return;
    const struct judgement *off = any_hit != truth_hit ? any_judgement : closest_judgement;
    if (judge->own || !is_open(off->verdict))
        judge_set_wrong(any_judgement, WRONG_ANY_DISAGREES);
}

enum verdict judge_bits(const struct ray *ray, const struct hit *a, const struct hit *b)
{
    if (memcmp(a, b, sizeof *a) == 0)
        return VERDICT_RIGHT;
    return ray_in_contract(ray) ? VERDICT_WRONG : VERDICT_OUT_OF_CONTRACT;
}

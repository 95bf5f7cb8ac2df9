#include "ref/oracle/environment.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/world_walk.h"

#include <math.h>

#define GRID ((int)ABI_FILTER_GRID)

const char *oracle_admission_name(enum oracle_admission admission)
{
    static const char *const name[ORACLE_ADMISSION_COUNT] = {
        "admitted", "masked", "culled by opacity", "culled by facing", "filtered"};
    return admission < ORACLE_ADMISSION_COUNT ? name[admission] : "unknown";
}

/* What the world says of one triangle. */
struct standing {
    const struct instance *instance;
    const struct filter_rule *filter;
    struct place place;
    bool opaque; /* with the flags of instance and ray */
    int det_sign;
};

/* A scene's triangles are of one opaque mesh at the identity. */
static struct standing standing_of(const struct oracle *oracle, struct ray_mode mode, uint32_t prim)
{
    static const struct instance only = {.mask = 0xFF};
    static const struct filter_rule none = {.kind = FILTER_ALL};
    const struct placing *placing = oracle->placing;
    if (!placing)
        return (struct standing){
            &only, &none, {.prim = prim, .tri = prim}, world_is_opaque(&only, true, mode), 1};
    const struct world *world = placing->world;
    struct place place = world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    bool opaque = world->mesh[place.mesh].geometry[place.geometry].opaque;
    return (struct standing){instance, &world->filter, place,
                             world_is_opaque(instance, opaque, mode),
                             placing->inverse[place.instance].det_sign};
}

/* --- u and v ---------------------------------------------------------------------------------- */

static int cell_of(double x)
{
    int cell = GRID - 1;
    while (cell > 0 && x < (double)cell / GRID)
        cell--;
    return cell;
}

/* The cell of an exact weight: a line between two cells belongs to the upper one. */
static int exact_cell(const struct fraction *weight)
{
    int cell = GRID - 1;
    while (cell > 0 && fraction_compare_double(weight, (double)cell / GRID) < 0)
        cell--;
    return cell;
}

static void weights_exactly(const struct ray *ray, const struct located *at,
                            struct fraction weight[2])
{
    float v[3][3];
    scene_tri(at->mesh->scene, at->tri, v);
    exact_weights(ray, v, at->instance, weight);
}

static bool passes(const struct standing *standing, int u_cell, int v_cell)
{
    return filter_passes(standing->filter, &standing->place, ((float)u_cell + 0.5f) / (float)GRID,
                         ((float)v_cell + 0.5f) / (float)GRID);
}

/* Whether the filter passes a hit. */
static bool passes_at(const struct standing *standing, const struct ray *ray,
                      const struct located *at)
{
    struct enclosure u, v;
    struct fraction weight[2];
    if (!filter_reads_uv(standing->filter))
        return passes(standing, 0, 0);
    if (pair_weights(ray, at, &u, &v) && cell_of(u.lo) == cell_of(u.hi) &&
        cell_of(v.lo) == cell_of(v.hi))
        return passes(standing, cell_of(u.lo), cell_of(v.lo));
    weights_exactly(ray, at, weight);
    return passes(standing, exact_cell(&weight[0]), exact_cell(&weight[1]));
}

void oracle_weights(const struct oracle *oracle, const struct ray *ray, uint32_t prim, double u[2],
                    double v[2])
{
    struct fraction weight[2];
    unsigned long saved = environment_enter();
    struct located at = pair_locate(oracle, prim);
    weights_exactly(ray, &at, weight);
    fraction_enclose(&weight[0], &u[0], &u[1]);
    fraction_enclose(&weight[1], &v[0], &v[1]);
    environment_leave(saved);
}

bool oracle_filter_is_open(const struct oracle *oracle, const struct ray *ray, struct ray_mode mode,
                           uint32_t prim, double du, double dv)
{
    struct standing standing = standing_of(oracle, mode, prim);
    double u[2], v[2];
    if (standing.opaque || !filter_reads_uv(standing.filter))
        return false;
    oracle_weights(oracle, ray, prim, u, v);
    /* A line belongs to the cell above it: a difference below one may be rounded to it, while a sum
     * that is not below one is not rounded to below it. */
    int left = cell_of(nextafter(u[0] - du, -INFINITY)), right = cell_of(u[1] + du);
    int low = cell_of(nextafter(v[0] - dv, -INFINITY)), high = cell_of(v[1] + dv);
    bool first = passes(&standing, left, low);
    for (int i = left; i <= right; i++)
        for (int j = low; j <= high; j++)
            if (passes(&standing, i, j) != first)
                return true;
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

static bool is_front(const struct standing *standing, const struct oracle_pair *pair)
{
    return world_is_front(standing->instance, pair->det * standing->det_sign);
}

bool oracle_is_front(const struct oracle *oracle, const struct oracle_pair *pair, uint32_t prim)
{
    struct standing standing = standing_of(oracle, ray_mode_all(), prim);
    return is_front(&standing, pair);
}

static enum oracle_admission admit(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, uint32_t prim, const struct located *at,
                                   const struct oracle_pair *pair)
{
    const struct ray_mode opacity = {mode.mask,
                                     mode.flags & (ABI_RAY_CULL_OPAQUE | ABI_RAY_CULL_NO_OPAQUE)};
    struct standing standing = standing_of(oracle, mode, prim);
    if (!world_meets(standing.instance, mode))
        return ORACLE_MASKED;
    if (world_culls(standing.instance, standing.opaque, true, opacity))
        return ORACLE_CULLED_OPACITY;
    bool in_plane = pair->class == ORACLE_IN_PLANE;
    if (!in_plane &&
        world_culls(standing.instance, standing.opaque, is_front(&standing, pair), mode))
        return ORACLE_CULLED_FACING;
    if (standing.opaque || (in_plane && filter_reads_uv(standing.filter)) ||
        passes_at(&standing, ray, at))
        return ORACLE_ADMITTED;
    return ORACLE_FILTERED;
}

enum oracle_admission admission_of(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, const struct decided *pair)
{
    return admit(oracle, ray, mode, pair->prim, &pair->at, &pair->pair);
}

enum oracle_admission oracle_admit(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, uint32_t prim,
                                   const struct oracle_pair *pair)
{
    unsigned long saved = environment_enter();
    struct located at = pair_locate(oracle, prim);
    enum oracle_admission admission = admit(oracle, ray, mode, prim, &at, pair);
    environment_leave(saved);
    return admission;
}

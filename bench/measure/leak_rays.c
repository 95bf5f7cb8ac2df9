#include "bench/measure/leak_rays.h"

#include "ref/base/rng.h"
#include "ref/scene/topology.h"
#include "scenes/rays/rays_stage.h"

#include <math.h>
#include <stdlib.h>

/* Points tried per requested origin: in a thin shell most of the box is outside. */
#define TRIES 64

/* State of the search for points inside. */
struct search {
    const struct oracle *oracle;
    struct stage stage;
    struct oracle_crossing *crossing;
    size_t capacity;
};

/* Decides by parity whether `org` is inside. A ray that meets an edge, a vertex or a plane decides
 * nothing and counts as outside; other points are tried. */
static enum status is_inside(struct search *search, struct rng *rng, const float org[3],
                             bool *inside, struct reason *reason)
{
    float dir[3];
    struct ray ray;
    size_t count = 0;
    stage_direction(rng, dir);
    stage_ray(org, dir, &ray);
    ray.tmax = INFINITY;
    enum status status = oracle_crossings(search->oracle, &ray, INFINITY, &search->crossing,
                                          &search->capacity, &count, reason);
    *inside = count % 2 == 1;
    for (size_t i = 0; i < count; i++)
        if (search->crossing[i].pair.class != ORACLE_INSIDE ||
            search->crossing[i].pair.range != ORACLE_WITHIN)
            *inside = false;
    return status;
}

static enum status find_origins(struct search *search, struct rng *rng, size_t wanted,
                                float (*origin)[3], size_t *found, struct reason *reason)
{
    const struct box *box = &search->stage.box;
    *found = 0;
    for (size_t i = 0; i < wanted * TRIES && *found < wanted; i++) {
        float org[3];
        bool inside;
        for (int k = 0; k < 3; k++)
            org[k] = rng_range(rng, box->lo[k], box->hi[k]);
        enum status status = is_inside(search, rng, org, &inside, reason);
        if (status)
            return status;
        for (int k = 0; k < 3 && inside; k++)
            origin[*found][k] = org[k];
        *found += inside;
    }
    if (*found == 0)
        return fail(reason, STATUS_INPUT, "no point inside found, of %zu tried", wanted * TRIES);
    return STATUS_OK;
}

static void choose_target(const struct topology *topology, const struct scene *scene,
                          enum leak_target target, struct rng *rng, float out[3])
{
    const float *vertex = scene->vertex;
    if (target == LEAK_VERTEX) {
        /* Choose a vertex of a triangle: files may hold vertices that no triangle uses. */
        const struct topology_edge *edge = &topology->edge[rng_below(rng, topology->edge_count)];
        const float *p =
            vertex + 3 * (size_t)topology->vertex[rng_below(rng, 2) ? edge->a : edge->b];
        for (int k = 0; k < 3; k++)
            out[k] = p[k];
        return;
    }
    const struct topology_edge *edge = &topology->edge[rng_below(rng, topology->edge_count)];
    const float *a = vertex + 3 * (size_t)topology->vertex[edge->a];
    const float *b = vertex + 3 * (size_t)topology->vertex[edge->b];
    double s = rng_below(rng, 4) == 0 ? 0.5 : (double)rng_float(rng);
    for (int k = 0; k < 3; k++)
        out[k] = (float)((1.0 - s) * (double)a[k] + s * (double)b[k]);
}

enum status leak_rays_make(const struct oracle *oracle, const struct scene *scene,
                           enum leak_target target, uint64_t seed, size_t count, struct ray *out,
                           struct reason *reason)
{
    struct search search = {.oracle = oracle, .stage = stage_make(scene, seed, STAGE_EDGES)};
    struct topology topology;
    float origin[LEAK_ORIGINS][3];
    size_t origins = 0;
    struct rng rng = rng_make(seed, 100 + (uint64_t)target);
    enum status status = topology_make(scene, &topology, reason);
    if (status)
        return status;
    status = topology_is_closed(&topology, scene, reason);
    if (status == STATUS_OK)
        status = find_origins(&search, &rng, count < LEAK_ORIGINS ? count : LEAK_ORIGINS, origin,
                              &origins, reason);
    for (size_t i = 0; i < count && status == STATUS_OK; i++) {
        float aim[3];
        choose_target(&topology, scene, target, &rng, aim);
        stage_aim(origin[rng_below(&rng, (uint32_t)origins)], aim, &out[i]);
    }
    free(search.crossing);
    topology_free(&topology);
    return status;
}

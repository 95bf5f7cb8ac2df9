/* Double hits of a list of all hits, and the parity of the walls crossed. */
#include "ref/judge/judge_all.h"

#include "ref/judge/leaks.h"

#include <math.h>
#include <stdlib.h>

/* Directions that are tried to find whether an origin is inside, until one meets no edge. */
static const float generic[][3] = {{0.5413f, 0.7291f, -0.4187f},  {-0.6821f, 0.2719f, 0.6793f},
                                   {0.1373f, -0.8117f, 0.5677f},  {-0.4391f, -0.5323f, -0.7237f},
                                   {0.8819f, 0.0947f, 0.4618f},   {0.3331f, 0.6197f, 0.7109f},
                                   {-0.2411f, 0.9043f, -0.3527f}, {-0.9341f, -0.1879f, 0.3037f}};

/* A list of crossings, reused. */
struct crossings {
    struct oracle_crossing *list;
    size_t capacity, count;
};

static enum status cross(const struct oracle *oracle, const struct ray *ray, struct crossings *out)
{
    return oracle_crossings(oracle, ray, (double)INFINITY, &out->list, &out->capacity, &out->count,
                            NULL);
}

/* Through the interior and off the ends of the range: a wall is crossed there. */
static bool is_wall(const struct oracle_crossing *crossing)
{
    return crossing->pair.class == ORACLE_INSIDE && crossing->pair.range == ORACLE_WITHIN;
}

static bool all_are_walls(const struct crossings *work)
{
    bool all = true;
    for (size_t i = 0; i < work->count; i++)
        all = all && is_wall(&work->list[i]);
    return all;
}

/* Parity of all walls from the origin of a ray without ends; *known is false if the origin is on a
 * wall, or no direction is generic. */
static enum status parity_from(const struct oracle *oracle, struct ray ray, struct crossings *work,
                               bool *known, unsigned *parity)
{
    enum status status = STATUS_OK;
    *known = false;
    for (size_t d = 0; d < ARRAY_COUNT(generic) && !status && !*known; d++) {
        for (int k = 0; k < 3; k++)
            ray.dir[k] = generic[d][k];
        status = cross(oracle, &ray, work);
        *known = !status && all_are_walls(work);
        *parity = work->count % 2;
    }
    return status;
}

/* Parity of the walls between the ends of the ray, which a ray moved by a hair would cross. */
static enum status parity_of(const struct oracle *oracle, const struct ray *ray,
                             struct crossings *work, bool *known, unsigned *parity)
{
    struct ray whole = *ray;
    unsigned outside = 0;
    enum status status = cross(oracle, ray, work);
    *known = all_are_walls(work);
    *parity = work->count % 2;
    if (status || *known)
        return status;
    /* Edges, vertices or planes are met: then all walls of the line less those beyond the ends. */
    whole.tmin = 0;
    whole.tmax = INFINITY;
    status = cross(oracle, &whole, work);
    *known = true;
    for (size_t i = 0; i < work->count; i++) {
        const struct oracle_pair *pair = &work->list[i].pair;
        if (pair->t_hi < (double)ray->tmin || pair->t_lo > (double)ray->tmax) {
            *known = *known && is_wall(&work->list[i]);
            outside ^= 1u;
        } else {
            *known = *known && pair->t_lo > (double)ray->tmin && pair->t_hi < (double)ray->tmax;
        }
    }
    if (!status && *known)
        status = parity_from(oracle, whole, work, known, parity);
    *parity ^= outside;
    return status;
}

enum status judge_list_mesh(const struct oracle *oracle, const struct topology *topology,
                            bool closed, const struct ray *ray, const struct hit *hit, size_t count,
                            struct list_mesh *out)
{
    struct crossings work = {.list = NULL};
    enum status status = STATUS_OK;
    *out = (struct list_mesh){.pair = {ABI_NO_PRIM, ABI_NO_PRIM}};
    uint32_t *prim = alloc_zeroed(2 * count, sizeof *prim), *group = prim ? prim + count : NULL;
    if (!prim)
        return STATUS_MEMORY;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool again = hit[i].prim >= topology->tri_count;
        for (size_t k = 0; k < kept && !again; k++)
            again = prim[k] == hit[i].prim;
        if (!again)
            prim[kept++] = hit[i].prim;
    }
    size_t extra = leaks_extra(topology, oracle, ray, prim, kept, out->pair, group);
    unsigned listed = (kept - extra) % 2, crossed = listed;
    out->doubled = extra > 0;
    if (closed)
        status = parity_of(oracle, ray, &work, &out->parity, &crossed);
    out->parity = out->parity && !status;
    out->parity_off = out->parity && crossed != listed;
    free(work.list);
    free(prim);
    return status;
}

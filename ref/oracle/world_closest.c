#include "ref/oracle/environment.h"
#include "ref/base/invariant.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/nearest.h"
#include "ref/oracle/tree_walk.h"
#include "ref/oracle/world_walk.h"

#define CHUNK 16 /* rays that a thread takes at once */

/* The nearest hits of one ray, as a visitor. */
struct closest_visitor {
    struct world_visitor visitor; /* first: the walk knows no more */
    enum oracle_ends ends;
    struct nearest nearest;
};

static enum status take(struct world_visitor *visitor, const struct ray *ray, struct decided *pair)
{
    struct closest_visitor *closest = (struct closest_visitor *)visitor;
    nearest_add(&closest->nearest, ray, closest->ends, pair);
    visitor->reach = tree_min((double)ray->tmax, nearest_reach(&closest->nearest));
    return STATUS_OK;
}

static void closest_one(const struct oracle *oracle, bool brute, const struct ray *ray,
                        struct ray_mode mode, struct closest_visitor *closest,
                        struct oracle_answer *out)
{
    nearest_start(&closest->nearest);
    nearest_finish(&closest->nearest, out); /* a miss */
    if (!oracle_takes(ray)) {
        out->flags = ORACLE_REFUSED;
        return;
    }
    if (ray_is_still(ray))
        return;
    closest->visitor.reach = (double)ray->tmax;
    /* take() never fails. */
    (void)!world_walk(oracle, ray, mode, brute, &closest->visitor);
    nearest_finish(&closest->nearest, out);
}

enum status oracle_closest_world(const struct oracle *oracle, enum oracle_path path,
                                 enum oracle_ends ends, const struct ray *ray,
                                 const struct ray_mode *mode, size_t count, unsigned threads,
                                 struct oracle_answer *out, struct oracle_stats *stats,
                                 struct reason *reason)
{
    int team = oracle_team((count + CHUNK - 1) / CHUNK, threads);
    (void)reason;
    invariant(oracle->placing);
#pragma omp parallel num_threads(team)
    {
        unsigned long saved = environment_enter();
        struct closest_visitor closest = {.visitor = {.take = take}, .ends = ends};
#pragma omp for schedule(dynamic, CHUNK)
        for (size_t i = 0; i < count; i++)
            closest_one(oracle, path == ORACLE_BRUTE, &ray[i], mode ? mode[i] : ray_mode_all(),
                        &closest, &out[i]);
        environment_leave(saved);
#pragma omp critical(oracle_stats)
        if (stats) {
            stats->pairs += closest.visitor.stats.pairs;
            stats->undecided += closest.visitor.stats.undecided;
            stats->wide += closest.visitor.stats.wide;
        }
    }
    return STATUS_OK;
}

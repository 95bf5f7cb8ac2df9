#include "ref/oracle/environment.h"
#include "ref/oracle/filter.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/nearest.h"

#include <math.h>
#include <omp.h>

static void closest_brute(const struct oracle *oracle, enum oracle_ends ends, const struct ray *ray,
                          struct oracle_answer *out, struct oracle_stats *stats)
{
    const struct scene *scene = oracle->scene;
    struct nearest nearest;
    nearest_start(&nearest);
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        struct decided pair;
        scene_tri(scene, prim, v);
        if (filter_misses(ray, v))
            continue;
        pair_decide(scene, oracle->flat[prim], ray, prim, PAIR_HITS, &pair, stats);
        nearest_add(&nearest, scene, ray, ends, prim, &pair);
    }
    stats->pairs += scene->tri_count;
    nearest_finish(&nearest, out);
}

enum status oracle_closest(const struct oracle *oracle, enum oracle_path path,
                           enum oracle_ends ends, const struct ray *ray, size_t count,
                           unsigned threads, struct oracle_answer *out, struct oracle_stats *stats,
                           struct reason *reason)
{
    uint64_t pairs = 0, undecided = 0, wide = 0;
    int team = threads ? (int)threads : omp_get_max_threads();
    (void)path;
    (void)reason;
#pragma omp parallel num_threads(team) reduction(+ : pairs, undecided, wide)
    {
        __auto_type saved = environment_enter();
        struct oracle_stats work = {0};
#pragma omp for schedule(dynamic, 16)
        for (size_t i = 0; i < count; i++) {
            if (oracle_takes(&ray[i])) {
                closest_brute(oracle, ends, &ray[i], &out[i], &work);
            } else {
                out[i] = (struct oracle_answer){.prim = ABI_NO_PRIM,
                                                .t_lo = INFINITY,
                                                .t_hi = INFINITY,
                                                .t_next = INFINITY,
                                                .flags = ORACLE_REFUSED};
            }
        }
        pairs += work.pairs;
        undecided += work.undecided;
        wide += work.wide;
        environment_leave(saved);
    }
    if (stats) {
        stats->pairs += pairs;
        stats->undecided += undecided;
        stats->wide += wide;
    }
    return STATUS_OK;
}

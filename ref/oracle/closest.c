#include "ref/oracle/environment.h"
#include "ref/base/invariant.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/nearest.h"
#include "ref/oracle/tree_walk.h"

#define TILE 16 /* rays that go through the triangles together, while these are in the cache */

/* One thread's. */
struct work {
    const struct oracle *oracle;
    enum oracle_ends ends;
    struct oracle_stats stats;
};

/* Decides the triangles of a run of the order that are not certainly missed. */
static void take_run(struct work *work, const struct ray *ray, const struct early_ray *early,
                     uint32_t first, uint32_t count, double largest, struct nearest *nearest)
{
    const struct oracle *oracle = work->oracle;
    uint64_t left = oracle->kernel->look(&oracle->soup, early, first, count, largest);
    work->stats.pairs += count;
    for (; left; left &= left - 1) {
        struct decided pair;
        uint32_t prim = oracle->tree.order[first + (uint32_t)__builtin_ctzll(left)];
        const struct located at = {oracle, NULL, prim};
        pair_decide(&at, ray, prim, PAIR_HITS, &pair, &work->stats);
        nearest_add(nearest, ray, work->ends, &pair);
    }
}

static double largest_in(const struct box *box, const struct early_ray *early)
{
    double largest = 0;
    for (int k = 0; k < 3; k++) {
        double below = early->o[k] - (double)box->lo[k], above = (double)box->hi[k] - early->o[k];
        largest = tree_max(largest, tree_max(below, above));
    }
    return largest;
}

/* A tile of rays against every triangle. */
static void closest_brute(struct work *work, const struct ray *const ray[TILE], int count,
                          struct nearest nearest[TILE])
{
    struct early_ray early[TILE];
    uint32_t tri_count = work->oracle->scene->tri_count;
    for (int i = 0; i < count; i++)
        early[i] = early_ray_make(ray[i]);
    for (uint32_t first = 0; first < tri_count; first += EARLY_MOST) {
        uint32_t run = tri_count - first < EARLY_MOST ? tri_count - first : EARLY_MOST;
        for (int i = 0; i < count; i++)
            take_run(work, ray[i], &early[i], first, run,
                     largest_in(&work->oracle->run[first / EARLY_MOST], &early[i]), &nearest[i]);
    }
}

static void closest_tree(struct work *work, const struct ray *ray, struct nearest *nearest)
{
    struct early_ray early = early_ray_make(ray);
    struct tree_walk walk;
    struct tree_leaf leaf;
    double reach = (double)ray->tmax;
    tree_walk_start(&walk, &work->oracle->tree, ray);
    while (tree_walk_next(&walk, reach, &leaf)) {
        take_run(work, ray, &early, leaf.first, leaf.count, leaf.largest, nearest);
        reach = tree_min((double)ray->tmax, nearest_reach(nearest));
    }
}

/* Rays [0, count), count <= TILE. */
static void closest_tile(struct work *work, bool brute, const struct ray *ray, int count,
                         struct oracle_answer *out)
{
    struct nearest nearest[TILE];
    const struct ray *taken[TILE];
    int slot[TILE], slots = 0;
    for (int i = 0; i < count; i++) {
        nearest_start(&nearest[slots]);
        nearest_finish(&nearest[slots], &out[i]); /* a miss */
        if (!oracle_takes(&ray[i])) {
            out[i].flags = ORACLE_REFUSED;
        } else if (!ray_is_still(&ray[i])) {
            taken[slots] = &ray[i];
            slot[slots++] = i;
        }
    }
    if (brute)
        closest_brute(work, taken, slots, nearest);
    for (int s = 0; s < slots; s++) {
        if (!brute)
            closest_tree(work, taken[s], &nearest[s]);
        nearest_finish(&nearest[s], &out[slot[s]]);
    }
}

enum status oracle_closest(const struct oracle *oracle, enum oracle_path path,
                           enum oracle_ends ends, const struct ray *ray, size_t count,
                           unsigned threads, struct oracle_answer *out, struct oracle_stats *stats,
                           struct reason *reason)
{
    size_t tiles = (count + TILE - 1) / TILE;
    int team = oracle_team(tiles, threads);
    bool brute = path == ORACLE_BRUTE ||
                 (path == ORACLE_AUTO && oracle->scene->tri_count <= ORACLE_BRUTE_MOST);
    (void)reason;
    invariant(!oracle->placing);
#pragma omp parallel num_threads(team)
    {
        unsigned long saved = environment_enter();
        struct work work = {.oracle = oracle, .ends = ends};
#pragma omp for schedule(dynamic, 4)
        for (size_t tile = 0; tile < tiles; tile++) {
            size_t first = tile * TILE;
            int size = count - first < TILE ? (int)(count - first) : TILE;
            closest_tile(&work, brute, ray + first, size, out + first);
        }
        environment_leave(saved);
#pragma omp critical(oracle_stats)
        if (stats) {
            stats->pairs += work.stats.pairs;
            stats->undecided += work.stats.undecided;
            stats->wide += work.stats.wide;
        }
    }
    return STATUS_OK;
}

/* Rays sorted by origin and direction before they are traced one by one. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

#define CELLS 64 /* along an axis */

struct sort_key {
    uint64_t key;
    uint32_t ray;
};

static int by_key(const void *a, const void *b)
{
    const struct sort_key *x = a, *y = b;
    int order = order_numbers(x->key, y->key);
    return order ? order : order_numbers(x->ray, y->ray);
}

/* The cell of x in [lo, hi]. */
static uint64_t cell_of(double x, double lo, double hi)
{
    double at = hi > lo ? (x - lo) / (hi - lo) * CELLS : 0;
    return at >= CELLS - 1 ? CELLS - 1 : at >= 1 ? (uint64_t)at : 0;
}

/* Bits of three numbers in turn, the first numbers' first. */
static uint64_t interleave(const uint64_t cell[3])
{
    uint64_t key = 0;
    for (int bit = 5; bit >= 0; bit--)
        for (int k = 0; k < 3; k++)
            key = key << 1 | (cell[k] >> bit & 1);
    return key;
}

/* Cells of the origin, the octant of the direction, then its cells. */
static uint64_t key_of(const struct ray *ray, const struct box *box)
{
    uint64_t octant = 0, origin[3], direction[3];
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double d = (double)ray->dir[k];
        most = d > most ? d : -d > most ? -d : most;
    }
    for (int k = 0; k < 3; k++) {
        octant = octant << 1 | (ray->dir[k] < 0);
        origin[k] = cell_of((double)ray->org[k], (double)box->lo[k], (double)box->hi[k]);
        direction[k] = cell_of((double)ray->dir[k], -most, most);
    }
    return interleave(origin) << 21 | octant << 18 | interleave(direction);
}

/* Sorts a wave; the rays are read and written once more, past the caches. */
static enum status play_wave(struct traffic_run *run, uint32_t wave, struct reason *reason)
{
    const struct traffic_wave *of = &run->paths->wave[wave];
    struct sort_key *key = alloc_zeroed(of->count, sizeof *key);
    uint32_t *order = alloc_zeroed(of->count, sizeof *order);
    struct box box = scene_bounds(run->walker->job.scene);
    enum status status = STATUS_OK;
    if (!key || !order)
        status = fail(reason, STATUS_MEMORY, "no memory to sort %zu rays", of->count);
    for (size_t i = 0; i < of->count && !status; i++)
        key[i] = (struct sort_key){key_of(&of->ray[i], &box), (uint32_t)i};
    if (!status) {
        qsort(key, of->count, sizeof *key, by_key);
        for (int write = 0; write < 2; write++)
            traffic_access(&run->memory, 0, TRAFFIC_DRAM, TRAFFIC_AT_RAYS, 0,
                           of->count * (uint64_t)TRAFFIC_RAY_BYTES, write);
        for (size_t i = 0; i < of->count; i++)
            order[i] = key[i].ray;
        status = traffic_in_order(run, wave, order, reason);
    }
    free(key);
    free(order);
    return status;
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++)
        status = play_wave(run, k, reason);
    return status;
}

const struct scheduler sched_sorted = {.name = "sorted",
                                       .summary =
                                           "as depth_first, rays sorted by origin and direction",
                                       .uses = "units lanes private layout store",
                                       .play = play};

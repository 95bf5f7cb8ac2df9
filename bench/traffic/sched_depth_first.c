/* Rays in the order of the image: each unit traces so many in turn, a node each, and takes the next
 * one where one is done. The stack is in memory. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

struct in_order {
    struct traffic_run *run;
    uint32_t wave;
    const uint32_t *order;
    size_t taken;
    struct traffic_lane *lane;
    bool *busy;
};

/* Gives a lane the next ray that meets the root. Returns false if there is none. */
static bool next_ray(struct in_order *o, uint32_t unit, uint32_t lane)
{
    const struct traffic_wave *wave = &o->run->paths->wave[o->wave];
    struct traffic_lane *l = &o->lane[lane];
    while (o->taken < wave->count) {
        l->ray = o->order ? o->order[o->taken] : (uint32_t)o->taken;
        l->slot = lane;
        traffic_take_ray(o->run, unit, o->wave, (uint32_t)o->taken++);
        if (traffic_begin(o->run->walker, l, &wave->ray[l->ray]) == TRAFFIC_MORE)
            return true;
        traffic_answer(o->run, unit, o->wave, l->ray, &l->walk.best);
    }
    return false;
}

/* One node. Returns whether the lane was busy. */
static bool turn(struct in_order *o, uint32_t unit, uint32_t lane, bool *limit)
{
    struct traffic_lane *l = &o->lane[lane];
    o->run->walker->unit = unit;
    if (!o->busy[lane])
        o->busy[lane] = next_ray(o, unit, lane);
    if (!o->busy[lane])
        return false;
    enum traffic_end end = traffic_step(o->run->walker, l);
    *limit = *limit || end == TRAFFIC_LIMIT;
    if (end != TRAFFIC_MORE) {
        traffic_answer(o->run, unit, o->wave, l->ray, &l->walk.best);
        o->busy[lane] = false;
    }
    return true;
}

enum status traffic_in_order(struct traffic_run *run, uint32_t wave, const uint32_t *order,
                             struct reason *reason)
{
    uint32_t units = run->machine->memory.units, lanes = run->machine->lanes;
    struct in_order o = {.run = run,
                         .wave = wave,
                         .order = order,
                         .lane = alloc_zeroed((size_t)units * lanes, sizeof *o.lane),
                         .busy = alloc_zeroed((size_t)units * lanes, sizeof *o.busy)};
    bool any = o.lane && o.busy, limit = false;
    enum status status =
        any ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %u lanes", units * lanes);
    while (any) {
        any = false;
        for (uint32_t i = 0; i < units * lanes; i++) /* unit by unit in turn */
            any = turn(&o, i % units, i % units * lanes + i / units, &limit) || any;
    }
    free(o.lane);
    free(o.busy);
    return limit ? fail(reason, STATUS_LIMIT, "a ray was not finished") : status;
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++)
        status = traffic_in_order(run, k, NULL, reason);
    return status;
}

const struct scheduler sched_depth_first = {.name = "depth_first",
                                            .summary =
                                                "each ray by itself, in the order of the image",
                                            .uses = "units lanes private layout store",
                                            .play = play};

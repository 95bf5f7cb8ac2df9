/* RayCore (Nah et al. 2014): a k-d tree with triangles as planes and lines; each ray is traced to
 * its end, with its path's further rays next. The stack is on the chip and is not seen; units take
 * paths in turn. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

struct raycore_unit {
    struct traffic_run *run;
    uint32_t unit;
};

static void on_read(void *reader, enum kd_read array, ptrdiff_t number, size_t bytes)
{
    static const enum traffic_array at[] = {[KD_READ_NODE] = TRAFFIC_AT_NODES,
                                            [KD_READ_ITEM] = TRAFFIC_AT_ITEMS,
                                            [KD_READ_TRI] = TRAFFIC_AT_VERTICES};
    const struct raycore_unit *u = reader;
    u->run->walker->visits += array == KD_READ_NODE;
    traffic_access(&u->run->memory, u->unit, TRAFFIC_L1, at[array], (uint64_t)number * bytes, bytes,
                   false);
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    size_t *at = alloc_zeroed(run->depth, sizeof *at); /* of each wave, the next ray */
    if (!at)
        return fail(reason, STATUS_MEMORY, "no memory for %u waves", run->depth);
    for (uint32_t path = 0; path < run->paths->wave[0].count; path++) {
        struct raycore_unit u = {run, path % run->machine->memory.units};
        for (uint32_t k = 0; k < run->depth; k++) {
            const struct traffic_wave *wave = &run->paths->wave[k];
            if (at[k] >= wave->count || wave->path[at[k]] != path)
                break;
            uint32_t ray = (uint32_t)at[k]++;
            traffic_take_ray(run, u.unit, k, ray);
            struct hit hit = kd_watched(run->kd, &wave->ray[ray], on_read, &u);
            traffic_answer(run, u.unit, k, ray, &hit);
        }
    }
    free(at);
    return STATUS_OK;
}

const struct scheduler sched_raycore = {.name = "raycore",
                                        .summary = "path by path through engine kd's tree",
                                        .uses = "units private",
                                        .kd = true,
                                        .play = play};

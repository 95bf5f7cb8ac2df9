/* Mach-RT (Vasiou et al. 2020): several chips, each with a pool of rays, their queues and hit
 * records on the chip. They read the segments of the scene in one order through a last level that
 * they share: a unit is a chip, and level 2 is that level. What does not fit into the pools is a
 * wavefront of its own. */
#include "bench/traffic/schedulers.h"

static enum status play(struct traffic_run *run, struct reason *reason)
{
    const struct traffic_streaming how = {
        .pools = run->machine->memory.units, .on_chip = true, .from = TRAFFIC_L2};
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++) {
        size_t count = run->paths->wave[k].count;
        size_t most = (size_t)run->machine->queue * how.pools;
        for (size_t first = 0; first < count && !status; first += most) {
            size_t end = count - first < most ? count : first + most;
            status = traffic_stream(run, k, first, end, &how, reason);
        }
    }
    return status;
}

const struct scheduler sched_mach_rt = {
    .name = "mach_rt",
    .summary = "chips with rays of their own share a stream of the scene",
    .uses = "units treelet queue private layout store",
    .streams = true,
    .reorders = true,
    .play = play};

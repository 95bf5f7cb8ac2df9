/* STRaTA (Kopta et al. 2015): rays wait at treelets in buffers on the chip. Instead of a stack a
 * ray has a trail of one bit a level, so that the way back leads over the parents, which are
 * read. */
#include "bench/traffic/schedulers.h"

static enum status play(struct traffic_run *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < run->depth && !status; k++)
        status = traffic_by_treelet(run, k, true, reason);
    return status;
}

const struct scheduler sched_strata = {.name = "strata",
                                       .summary = "rays wait at treelets on the chip, with a trail",
                                       .uses = "units treelet queue private layout store",
                                       .play = play};

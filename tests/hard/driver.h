/* Cases that measure a Vulkan driver directly, by the probes of `raydiff doctor`
 * (gpu/card/card.h). */
#ifndef HARD_DRIVER_H
#define HARD_DRIVER_H

#include "tests/hard/run.h"

/* packHalf2x16 of 196,608 floats: each the nearest half, ties to even. */
void driver_packs_halves(const struct engine_options *options, struct hard_result *out);

/* Loops of 100,000 rounds, one, two in turn, two nested: all are run. */
void driver_runs_loops(const struct engine_options *options, struct hard_result *out);

#endif

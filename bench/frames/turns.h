/* The order of contestants in a round of a race. */
#ifndef TURNS_H
#define TURNS_H

#include "ref/base/rng.h"

#include <stddef.h>

/* Sets the order before the first round: 0 to count - 1. */
void turns_start(size_t *order, size_t count);

/* Makes the next round's order from the last one. It is random, since a contestant that always
 * follows the same one gains or loses by the state of caches and predictors. The first is never the
 * last of the round before, which would find its own state. */
void turns_next(struct rng *rng, size_t *order, size_t count);

#endif

/* The order of contestants in a round of a race. */
#ifndef TURNS_H
#define TURNS_H

#include "ref/base/rng.h"

#include <stddef.h>

/* Before the first round: 0 to count - 1. */
void turns_start(size_t *order, size_t count);

/* The next round's order, made of the last one's: at random, since who always follows the same one
 * gains or loses by what that leaves in caches and predictors; and the first is not the last of the
 * round before, who would find its own. */
void turns_next(struct rng *rng, size_t *order, size_t count);

#endif

/* The parts of a world that shader world_brute tests in one dispatch each. */
#ifndef WORLD_PART_H
#define WORLD_PART_H

#include "ref/abi_world.h"
#include "ref/base/base.h"

struct world;

/* Sets first, last and index of *push to the part from push->last on, which is 0 before the first:
 * at most DISPATCH_PART triangles of at most as many instances, so that no loop is long enough for
 * a driver to end it early. The only part of a world without triangles is empty. Returns true if
 * there are more parts. */
bool world_part_next(const struct world *world, struct world_push *push);

#endif

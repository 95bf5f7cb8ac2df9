/* A mesh placed many times. */
#ifndef CROWD_H
#define CROWD_H

#include "ref/world/world.h"

/* Makes a world of `count` instances of a mesh, rotated, their centres spread evenly over the cube
 * from -1 to 1, the largest side of each 0.5 to 1.5 times `size`; the custom index of each is its
 * number. The same arguments give the same bytes on every machine.
 *   mesh  at least a triangle, not all in one point; borrowed
 * It has passed world_finish. Errors: STATUS_INPUT a mesh of no size; STATUS_LIMIT more than 2^20
 * instances; those of world_finish; STATUS_MEMORY. *out is zero on error. */
enum status world_crowd_of(const struct scene *mesh, uint32_t count, double size, uint64_t seed,
                           struct world *out, struct reason *reason) MUST_USE;

#endif

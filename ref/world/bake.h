/* A world as one scene: its placed triangles with vertices rounded to float32. For aiming rays and
 * for pictures; the truth about a world never comes from here. */
#ifndef BAKE_H
#define BAKE_H

#include "ref/world/world.h"

/* Makes a scene of the world's active instances, in order, each with vertices and triangles of its
 * own: M v + T in double, rounded to the nearest float32. Where the transform is exact in float32,
 * so is the scene. With more than `most` placed triangles it takes instances spread evenly over the
 * world, at least one, whole. Errors: STATUS_LIMIT a vertex beyond float32: instance and vertex;
 * more than 2^32 - 2 vertices. STATUS_MEMORY. */
enum status world_bake(const struct world *world, uint32_t most, struct scene *out,
                       struct reason *reason) MUST_USE;

/* The step of those instances: 0, step, 2 step ... are taken, where they are active. */
uint32_t world_bake_step(const struct world *world, uint32_t most);

#endif

/* Moves a scene's vertices, to test refitted trees. */
#ifndef MOVE_H
#define MOVE_H

#include "ref/scene/scene.h"

/* Moves each vertex along each axis by a uniform random distance within +-`amount` times the
 * longest side of the scene's box. The result is the same on every machine. The distance depends on
 * the vertex's position and the seed only, so that vertices in the same place stay together.
 * Coordinates are clamped to +-FLT_MAX. `amount` is finite and at least 0; 0 changes nothing.
 * Normals are not changed: no triangle test reads them. */
void scene_move(struct scene *scene, float amount, uint64_t seed);

#endif

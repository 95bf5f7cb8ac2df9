/* Motion of a scene's vertices, for trees that are refitted. */
#ifndef MOVE_H
#define MOVE_H

#include "ref/scene/scene.h"

/* Moves each vertex along each axis by up to `amount` times the longest side of the scene's box,
 * either way, evenly; the same on every machine. The distance depends on the vertex's position
 * only, so that vertices in the same place stay together. A coordinate ends at FLT_MAX in
 * magnitude. `amount` is at least 0 and finite; 0 changes nothing. Normals stay as they are: no
 * triangle test reads them. */
void scene_move(struct scene *scene, float amount, uint64_t seed);

#endif

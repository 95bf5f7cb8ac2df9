/* Motion of a scene's vertices, for trees that are refitted. */
#ifndef MOVE_H
#define MOVE_H

#include "ref/scene/scene.h"

/* Moves each vertex along each axis by up to `amount` times the longest side of the scene's box,
 * either way, evenly; the same on every machine. How far says the place where it is, so that what
 * was joined stays joined, also vertices that only lie in the same place. A coordinate ends at
 * FLT_MAX in magnitude. `amount` is at least 0 and finite; 0 changes nothing. Normals stay as they
 * are: no test of triangles reads them. */
void scene_move(struct scene *scene, float amount, uint64_t seed);

#endif

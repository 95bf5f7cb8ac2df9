/* Worlds as scenes for pictures. */
#ifndef PLACED_SCENE_H
#define PLACED_SCENE_H

#include "ref/world/world.h"

/* Triangles of a world that are drawn at most. */
#define PLACED_MOST (1u << 22)

/* Opens what scene_open opens, and worlds: the placed triangles of the instances that rays can
 * meet, their vertices rounded to float32, each instance in one of eight colours by its number. Of
 * a world of more than PLACED_MOST triangles it takes instances spread evenly.
 *   placed  triangles of the world; 0: it is a scene
 * Errors: as world_open, world_bake; STATUS_INPUT nothing in the world can be hit. */
enum status placed_scene_open(const char *spec, uint64_t seed, struct scene *out, uint64_t *placed,
                              struct reason *reason) MUST_USE;

#endif

/* raydiff leaks on worlds. For commands only. */
#ifndef CMD_LEAKS_WORLD_H
#define CMD_LEAKS_WORLD_H

#include "cmd/leaks/cmd_leaks.h"

struct world;

/* Aims rays from inside the instances and runs every engine; masks of the world are replaced. Adds
 * rows to *result. Errors: as of world_rays_inside_make, world_trees_make; STATUS_MEMORY. Errors of
 * a row are recorded in the row. */
enum status leaks_play_world(const struct leaks_options *options, struct pool *pool,
                             struct progress *progress, struct world *world,
                             struct leak_scene *result, struct reason *reason) MUST_USE;

#endif

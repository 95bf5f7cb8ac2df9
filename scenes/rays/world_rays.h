/* Rays into a world, and what they may meet. */
#ifndef WORLD_RAYS_H
#define WORLD_RAYS_H

#include "scenes/rays/ray_modes.h"
#include "scenes/rays/rays.h"

/* Makes `count` rays of a set and their modes. The set is aimed at the placed triangles, of large
 * worlds at some of them, with vertices rounded to float32. The caller frees *ray and *mode, also
 * on error. Errors: those of world_bake and ray_set_new; STATUS_MEMORY. */
enum status world_rays_new(const struct world *world, const struct ray_set *set,
                           enum ray_modes modes, uint64_t seed, size_t count, struct ray **ray,
                           struct ray_mode **mode, struct reason *reason) MUST_USE;

#endif

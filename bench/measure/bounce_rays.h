/* Rays that leave what other rays hit in a world. */
#ifndef BOUNCE_RAYS_H
#define BOUNCE_RAYS_H

#include "ref/world/world.h"

/* Makes a ray from each hit of `count` rays, in a direction of the half space that its ray came
 * from, likelier the steeper it is. It starts a little (1e-4 of `size`) before the surface and has
 * no end. Keeps the order of the rays and repeats them until there are `count`. `out` must not
 * overlap. Errors: STATUS_INPUT no ray hits. */
enum status bounce_rays_make(const struct world *world, double size, uint64_t seed,
                             const struct ray *ray, const struct hit *hit, size_t count,
                             struct ray *out, struct reason *reason) MUST_USE;

#endif

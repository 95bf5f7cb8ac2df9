/* Rays from where others hit to a light. */
#ifndef SHADOW_RAYS_H
#define SHADOW_RAYS_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

/* From the hit of each of `count` rays that hits, a little (1e-4 of the scene's size) before the
 * surface, to the scene's first light, or to a point beside and above the scene; tmax 1 is the
 * light. In the order of the rays; repeated from the first until there are `count`. `out` may not
 * overlap. Errors: STATUS_INPUT none hits. */
enum status shadow_rays_make(const struct scene *scene, const struct ray *ray,
                             const struct hit *hit, size_t count, struct ray *out,
                             struct reason *reason) MUST_USE;

#endif

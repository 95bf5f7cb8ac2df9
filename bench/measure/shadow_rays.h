/* Rays from hits towards a light. */
#ifndef SHADOW_RAYS_H
#define SHADOW_RAYS_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

/* Makes a ray from each hit of `count` rays to the scene's first light or, without one, to a point
 * beside and above the scene. It starts a little (1e-4 of the scene's size) before the surface; the
 * light is at tmax 1. Keeps the order of the rays and repeats them until there are `count`. `out`
 * must not overlap. Errors: STATUS_INPUT no ray hits. */
enum status shadow_rays_make(const struct scene *scene, const struct ray *ray,
                             const struct hit *hit, size_t count, struct ray *out,
                             struct reason *reason) MUST_USE;

#endif

/* Rays from inside the instances of a world, for the leak counter. */
#ifndef RAYS_INSIDE_WORLD_H
#define RAYS_INSIDE_WORLD_H

#include "ref/world/world.h"
#include "scenes/rays/rays_inside.h"

#define INSIDE_INSTANCES 64 /* most instances that rays start in */

struct world_inside {
    uint32_t instances; /* that rays start in, 1 to INSIDE_INSTANCES */
    size_t origins;     /* of all of them */
    bool seams;         /* see below */
};

/* Makes `count` rays and what they may meet, so that every one must hit something.
 *   Where the mesh of every active instance is closed, rays start inside instances, spread evenly
 * over the world, and are aimed at edges and vertices as rays_inside_make aims them in the space of
 * the mesh, from an origin that float32 can place: what transforms round leaves it inside. They
 * meet the instances of one bit of the mask: call world_inside_masks before they are traced.
 *   Else the instances together must be a closed mesh in float32 (world_bake), where they touch:
 * *inside->seams, and rays from inside it meet all of them.
 * Errors: STATUS_INPUT no active instance; neither is closed, with the instance; no point inside an
 * instance is far enough from its surface; STATUS_LIMIT the inverse of a transform, or a placed
 * vertex, is beyond float32; STATUS_MEMORY. */
enum status world_rays_inside_make(const struct world *world, uint64_t seed, size_t count,
                                   struct ray *out, struct ray_mode *mode, uint8_t *aim,
                                   struct world_inside *inside, struct reason *reason) MUST_USE;

/* Gives active instance i the mask 1 << i % 8. */
void world_inside_masks(struct world *world);

#endif

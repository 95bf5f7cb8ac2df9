#include "scenes/rays/world_rays.h"

#include "ref/world/bake.h"

#define AIMED_MOST (1u << 20) /* triangles that rays are aimed at */

enum status world_rays_new(const struct world *world, const struct ray_set *set,
                           enum ray_modes modes, uint64_t seed, size_t count, struct ray **ray,
                           struct ray_mode **mode, struct reason *reason)
{
    struct scene baked;
    *ray = NULL;
    *mode = NULL;
    enum status status = world_bake(world, AIMED_MOST, &baked, reason);
    if (status)
        return status;
    status = ray_set_new(set, &baked, seed, count, ray, reason);
    scene_free(&baked);
    *mode = alloc_zeroed(count, sizeof **mode);
    if (status == STATUS_OK && !*mode)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    if (status == STATUS_OK)
        ray_modes_make(modes, seed, count, *mode);
    return status;
}

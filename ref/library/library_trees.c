/* The public library: packed trees and hard rays. */
#include "ref/library/library.h"

#include "ref/packed/packed_file.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"

#include <stdlib.h>
#include <string.h>

enum raydiff_error raydiff_check_tree(const struct raydiff_oracle *oracle, const void *bytes,
                                      size_t size, struct raydiff_faults *faults,
                                      struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct packed packed = {0};
    struct packed_faults found = {0};
    enum status status = library_given(oracle, "oracle", &reason);
    if (!status)
        status = library_given(bytes, "bytes", &reason);
    if (!status && oracle->is_world)
        status = fail(&reason, STATUS_INPUT, "oracle: is of a world, a packed tree of triangles");
    if (!status)
        status = packed_file_read("tree", bytes, size, &oracle->scene, &packed, &found, &reason);
    packed_free(&packed);
    if (faults)
        *faults = status ? (struct raydiff_faults){0}
                         : (struct raydiff_faults){.loose_boxes = found.loose_boxes,
                                                   .bad_references = found.bad_refs,
                                                   .cycles = found.cycles,
                                                   .lost_triangles = found.lost_prims,
                                                   .double_triangles = found.double_prims,
                                                   .bad_triangles = found.bad_prims,
                                                   .too_deep = found.too_deep,
                                                   .bad_vertices = found.bad_tris};
    return library_end(modes, status, &reason, why);
}

const char *raydiff_rays_name(uint32_t number)
{
    uint32_t i = 0;
    while (i < number && ray_sets[i])
        i++;
    return ray_sets[i] ? ray_sets[i]->name : NULL;
}

/* The same of a world. */
static enum status world_rays(const struct world *world, const struct ray_set *set, uint64_t seed,
                              size_t count, float *out, struct reason *reason)
{
    struct ray *ray = NULL;
    struct ray_mode *mode = NULL;
    enum status status =
        world_rays_new(world, set, RAY_MODES_ALL, seed, count, &ray, &mode, reason);
    if (!status && count)
        memcpy(out, ray, count * sizeof *ray);
    free(ray);
    free(mode);
    return status;
}

enum raydiff_error raydiff_hard_rays(const struct raydiff_oracle *oracle, const char *set,
                                     uint64_t seed, size_t count, float *ray,
                                     struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    uint32_t which = 0;
    enum status status = library_given(oracle, "oracle", &reason);
    if (!status && count)
        status = library_given(ray, "rays", &reason);
    if (!status && set)
        status = library_find("rays", set, raydiff_rays_name, &which, &reason);
    if (!status && oracle->is_world)
        status = world_rays(&oracle->world, ray_sets[which], seed, count, ray, &reason);
    else if (!status)
        status = ray_set_make(ray_sets[which], &oracle->scene, seed, count,
                              (struct ray *)(void *)ray, &reason);
    if (status && ray)
        memset(ray, 0, 8 * count * sizeof *ray);
    return library_end(modes, status, &reason, why);
}

/* The public library: packed trees and hard rays. */
#include "ref/library/library.h"

#include "ref/packed/packed_file.h"
#include "scenes/rays/rays.h"

#include <string.h>

enum raydiff_error raydiff_check_tree(const struct raydiff_oracle *oracle, const void *bytes,
                                      size_t size, struct raydiff_faults *faults,
                                      struct raydiff_why *why)
{
    struct reason reason = {""};
    struct packed packed = {0};
    struct packed_faults found = {0};
    enum status status = library_given(oracle, "oracle", &reason);
    if (!status)
        status = library_given(bytes, "bytes", &reason);
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
    return library_end(status, &reason, why);
}

const char *raydiff_rays_name(uint32_t number)
{
    uint32_t i = 0;
    while (i < number && ray_sets[i])
        i++;
    return ray_sets[i] ? ray_sets[i]->name : NULL;
}

enum raydiff_error raydiff_hard_rays(const struct raydiff_oracle *oracle, const char *set,
                                     uint64_t seed, size_t count, float *ray,
                                     struct raydiff_why *why)
{
    struct reason reason = {""};
    uint32_t which = 0;
    enum status status = library_given(oracle, "oracle", &reason);
    if (!status && count)
        status = library_given(ray, "rays", &reason);
    if (!status && set)
        status = library_find("rays", set, raydiff_rays_name, &which, &reason);
    if (!status)
        status = ray_set_make(ray_sets[which], &oracle->scene, seed, count,
                              (struct ray *)(void *)ray, &reason);
    if (status && ray)
        memset(ray, 0, 8 * count * sizeof *ray);
    return library_end(status, &reason, why);
}

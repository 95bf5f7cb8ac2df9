/* What raydiff scene info tells of a world. */
#include "cmd/scene/cmd_scene.h"

#include "ref/base/json_record.h"

#include <stdio.h>

/* What is counted in a world. */
struct world_counts {
    uint64_t vertices, triangles;
    uint32_t geometries, not_opaque;
    uint32_t inactive, mirrored, identity;
};

static struct world_counts count_world(const struct world *world)
{
    struct world_counts counts = {0};
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct world_mesh *mesh = &world->mesh[i];
        counts.vertices += mesh->scene->vertex_count;
        counts.triangles += mesh->scene->tri_count;
        counts.geometries += mesh->geometry_count;
        for (uint32_t k = 0; k < mesh->geometry_count; k++)
            counts.not_opaque += !mesh->geometry[k].opaque;
    }
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *instance = &world->instance[i];
        counts.inactive += instance->mesh == WORLD_NO_MESH || instance->mask == 0;
        counts.mirrored += instance_det_sign(instance->m) < 0;
        counts.identity += instance_is_identity(instance);
    }
    return counts;
}

static const char *filter_name(const struct world *world)
{
    static const char *const name[] = {[FILTER_ALL] = "all",
                                       [FILTER_NONE] = "none",
                                       [FILTER_TRIANGLES] = "triangles",
                                       [FILTER_CELLS] = "cells"};
    return name[world->filter.kind];
}

void world_print(const char *spec, const struct world *world)
{
    const struct world_counts counts = count_world(world);
    printf("%s\n", spec);
    printf("  meshes              %u\n", world->mesh_count);
    printf("  geometries          %u, not opaque %u\n", counts.geometries, counts.not_opaque);
    printf("  vertices            %llu\n", (unsigned long long)counts.vertices);
    printf("  triangles           %llu\n", (unsigned long long)counts.triangles);
    printf("  instances           %u, inactive %u, mirrored %u, at the identity %u\n",
           world->instance_count, counts.inactive, counts.mirrored, counts.identity);
    printf("  placed triangles    %u\n", world_tri_count(world));
    printf("  filter              %s, %u of 256\n", filter_name(world), world->filter.share);
}

json_t *world_json(const char *spec, const struct world *world)
{
    const struct world_counts counts = count_world(world);
    return json_record("world=%s meshes=%u geometries=%u not_opaque=%u vertices=%zu triangles=%zu "
                       "instances=%u inactive=%u mirrored=%u identity=%u placed_triangles=%u "
                       "filter=%s share=%u",
                       spec, world->mesh_count, counts.geometries, counts.not_opaque,
                       (size_t)counts.vertices, (size_t)counts.triangles, world->instance_count,
                       counts.inactive, counts.mirrored, counts.identity, world_tri_count(world),
                       filter_name(world), world->filter.share);
}

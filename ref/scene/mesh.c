#include "ref/scene/mesh.h"

#include <stdlib.h>
#include <string.h>

void mesh_free(struct mesh *mesh)
{
    free(mesh->vertex);
    free(mesh->index);
    *mesh = (struct mesh){0};
}

enum status mesh_vertex(struct mesh *mesh, const float position[3])
{
    if (mesh->vertex_count >= UINT32_MAX - 1)
        return STATUS_LIMIT;
    enum status status = array_reserve(&mesh->vertex, &mesh->vertex_capacity,
                                       3 * mesh->vertex_count + 3, sizeof *mesh->vertex);
    if (!status)
        memcpy(mesh->vertex + 3 * mesh->vertex_count++, position, 3 * sizeof *position);
    return status;
}

void mesh_polygon(struct mesh *mesh)
{
    mesh->corners = 0;
}

enum status mesh_corner(struct mesh *mesh, uint32_t vertex)
{
    if (mesh->corners >= MESH_CORNERS_MOST || mesh->tri_count >= UINT32_MAX - 1)
        return STATUS_LIMIT;
    if (mesh->corners == 0)
        mesh->first = vertex;
    if (mesh->corners >= 2) {
        enum status status = array_reserve(&mesh->index, &mesh->index_capacity,
                                           3 * mesh->tri_count + 3, sizeof *mesh->index);
        if (status)
            return status;
        uint32_t *triangle = mesh->index + 3 * mesh->tri_count++;
        triangle[0] = mesh->first;
        triangle[1] = mesh->last;
        triangle[2] = vertex;
    }
    mesh->last = vertex;
    mesh->corners++;
    return STATUS_OK;
}

/* Frees unused capacity; returns the same array if that fails. */
static void *shrink(void *array, size_t count, size_t size)
{
    void *moved = realloc(array, count * size);
    return moved ? moved : array;
}

enum status mesh_finish(struct mesh *mesh, const char *name, struct scene *out,
                        struct reason *reason)
{
    *out = (struct scene){0};
    if (mesh->tri_count == 0) {
        enum status status = fail(reason, STATUS_INPUT, "%s: has no triangle (%zu vertices)", name,
                                  mesh->vertex_count);
        mesh_free(mesh);
        return status;
    }
    *out = (struct scene){
        .vertex = shrink(mesh->vertex, 3 * mesh->vertex_count, sizeof *mesh->vertex),
        .index = shrink(mesh->index, 3 * mesh->tri_count, sizeof *mesh->index),
        .vertex_count = (uint32_t)mesh->vertex_count,
        .tri_count = (uint32_t)mesh->tri_count,
    };
    *mesh = (struct mesh){0};
    struct reason rule;
    enum status status = scene_check(out, &rule);
    if (!status)
        return STATUS_OK;
    scene_free(out);
    return fail(reason, status, "%s: %s", name, rule.text);
}

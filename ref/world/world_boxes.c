#include "ref/world/world_boxes.h"

#include "ref/world/placed.h"

#include <stdlib.h>

const char *world_boxes_name(enum world_boxes how)
{
    static const char *const names[] = {"auto", "vertices", "corners"};
    return how < ARRAY_COUNT(names) ? names[how] : "unknown";
}

bool world_is_active(const struct world *world, uint32_t instance)
{
    const struct scene *scene = world_scene(world, instance);
    return scene && scene->tri_count > 0 && world->instance[instance].mask != 0;
}

/* Of each mesh, what its instances need. */
struct mesh_points {
    struct box bounds;
    float *point; /* vertices in use, 3 * count; NULL if boxes are made of corners */
    uint32_t count;
};

static enum status points_of(const struct scene *scene, struct mesh_points *out)
{
    out->point = alloc_zeroed(3 * (size_t)scene->vertex_count, sizeof *out->point);
    uint8_t *used = alloc_zeroed(scene->vertex_count, 1);
    if (!out->point || !used) {
        free(used);
        return STATUS_MEMORY;
    }
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        used[scene->index[i]] = 1;
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        if (used[i]) {
            for (size_t k = 0; k < 3; k++)
                out->point[3 * (size_t)out->count + k] = scene->vertex[3 * (size_t)i + k];
            out->count++;
        }
    free(used);
    return STATUS_OK;
}

static struct box box_of(const struct instance *instance, const struct mesh_points *mesh)
{
    if (!mesh->point)
        return placed_box_bounds(instance->m, &mesh->bounds);
    struct box box = box_empty();
    for (uint32_t i = 0; i < mesh->count; i++)
        for (int k = 0; k < 3; k++)
            placed_grow(instance->m[k], mesh->point + 3 * (size_t)i, &box.lo[k], &box.hi[k]);
    return box;
}

static bool is_finite(const struct box *box)
{
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(box->lo[k]) || !float_is_finite(box->hi[k]))
            return false;
    return true;
}

static uint64_t placed_vertices(const struct world *world)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world_is_active(world, i))
            count += world_scene(world, i)->vertex_count;
    return count;
}

static void free_points(struct mesh_points *mesh, uint32_t count)
{
    for (uint32_t i = 0; i < count && mesh; i++)
        free(mesh[i].point);
    free(mesh);
}

/* *out is NULL on error. */
static enum status points_make(const struct world *world, bool vertices, struct mesh_points **out)
{
    struct mesh_points *mesh = alloc_zeroed(world->mesh_count, sizeof *mesh);
    enum status status = mesh ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        mesh[i].bounds = scene_bounds(world->mesh[i].scene);
        if (vertices)
            status = points_of(world->mesh[i].scene, &mesh[i]);
    }
    if (status)
        free_points(mesh, world->mesh_count);
    *out = status ? NULL : mesh;
    return status;
}

bool world_boxes_are_of_vertices(const struct world *world, enum world_boxes how)
{
    return how == WORLD_BOXES_OF_VERTICES ||
           (how == WORLD_BOXES_AUTO && placed_vertices(world) <= WORLD_BOXES_VERTICES);
}

enum status world_boxes_make(const struct world *world, enum world_boxes how, struct box **out,
                             struct reason *reason)
{
    bool vertices = world_boxes_are_of_vertices(world, how);
    struct mesh_points *mesh;
    enum status status = points_make(world, vertices, &mesh);
    struct box *box = alloc_zeroed(world->instance_count, sizeof *box);
    if (status || !box)
        status = fail(reason, STATUS_MEMORY, "no memory for the boxes of %u instances",
                      world->instance_count);
#pragma omp parallel for schedule(dynamic, 16) if (world->instance_count > 16)
    for (long long i = 0; i < (status ? 0 : (long long)world->instance_count); i++) {
        const struct instance *instance = &world->instance[i];
        box[i] = world_is_active(world, (uint32_t)i) ? box_of(instance, &mesh[instance->mesh])
                                                     : box_empty();
    }
    for (uint32_t i = 0; i < world->instance_count && !status; i++)
        if (!is_finite(&box[i]))
            status =
                fail(reason, STATUS_LIMIT, "instance %u: its triangles reach beyond float32", i);
    free_points(mesh, world->mesh_count);
    if (status)
        free(box);
    *out = status ? NULL : box;
    return status;
}

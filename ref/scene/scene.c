#include "ref/scene/scene.h"

#include <math.h>
#include <stdlib.h>

enum status scene_make(uint32_t vertex_count, uint32_t tri_count, struct scene *out)
{
    *out = (struct scene){.vertex_count = vertex_count, .tri_count = tri_count};
    out->vertex = alloc_zeroed(3 * (size_t)vertex_count, sizeof *out->vertex);
    out->index = alloc_zeroed(3 * (size_t)tri_count, sizeof *out->index);
    if (out->vertex && out->index)
        return STATUS_OK;
    scene_free(out);
    return STATUS_MEMORY;
}

void scene_free(struct scene *scene)
{
    free(scene->vertex);
    free(scene->index);
    free(scene->normal);
    free(scene->material_of);
    free(scene->light);
    free(scene->material);
    *scene = (struct scene){0};
}

enum status scene_check(const struct scene *scene, struct reason *reason)
{
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            if (!float_is_finite(scene->vertex[3 * (size_t)i + (size_t)k]))
                return fail(reason, STATUS_INPUT, "vertex %u: coordinate %c is not finite", i,
                            "xyz"[k]);
    for (uint32_t i = 0; i < scene->tri_count; i++)
        for (int c = 0; c < 3; c++)
            if (scene->index[3 * (size_t)i + (size_t)c] >= scene->vertex_count)
                return fail(reason, STATUS_INPUT,
                            "triangle %u: vertex index %u, but the scene has %u vertices", i,
                            scene->index[3 * (size_t)i + (size_t)c], scene->vertex_count);
    return STATUS_OK;
}

struct box scene_tri_bounds(const struct scene *scene, uint32_t prim)
{
    float v[3][3];
    scene_tri(scene, prim, v);
    struct box box = box_empty();
    for (int c = 0; c < 3; c++)
        box_add_point(&box, v[c]);
    return box;
}

struct box scene_bounds(const struct scene *scene)
{
    struct box all = box_empty();
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        struct box one = scene_tri_bounds(scene, i);
        box_add_box(&all, &one);
    }
    return all;
}

struct camera scene_camera(const struct scene *scene)
{
    if (scene->has_camera)
        return scene->camera;
    struct box box = scene_bounds(scene);
    if (scene->tri_count == 0)
        box = (struct box){{-1, -1, -1}, {1, 1, 1}};
    float extent = 0;
    struct camera camera = {.orbit = true};
    for (int k = 0; k < 3; k++) {
        camera.at[k] = 0.5f * box.lo[k] + 0.5f * box.hi[k];
        extent = fmaxf(extent, box.hi[k] - box.lo[k]);
    }
    static const float direction[3] = {1.0f, 0.7f, 1.3f};
    for (int k = 0; k < 3; k++)
        camera.pos[k] = camera.at[k] + direction[k] * (extent > 0 ? extent : 1.0f);
    return camera;
}

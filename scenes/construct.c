#include "scenes/construct.h"

#include "scenes/read/formats.h"
#include "scenes/read/normals.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A scene being built, model by model. */
struct growing {
    const struct construct *from;
    struct scene scene;
    size_t vertex_capacity, index_capacity, material_capacity;
    uint32_t red;
};

/* Names model `i` in error messages. */
#define MODEL_IS    "model %u (%s)"
#define MODEL(i, m) (i), (m)->spec

static enum status check_finite(const float *number, size_t count, size_t each, const char *what,
                                struct reason *reason)
{
    for (size_t i = 0; i < count; i++)
        if (!float_is_finite(number[i]))
            return fail(reason, STATUS_INPUT, "%s %zu: number %zu is not finite", what, i / each,
                        i % each);
    return STATUS_OK;
}

static enum status check_camera(const struct camera *camera, struct reason *reason)
{
    float length = 0;
    enum status status = check_finite(camera->pos, 3, 3, "camera position", reason);
    if (!status)
        status = check_finite(camera->at, 3, 3, "camera target", reason);
    for (int k = 0; k < 3; k++)
        length = fmaxf(length, fabsf(camera->at[k] - camera->pos[k]));
    if (!status && length == 0)
        return fail(reason, STATUS_INPUT,
                    "the camera has no direction: its target is its position");
    if (!status && !float_is_finite(length))
        return fail(reason, STATUS_INPUT,
                    "the camera's target is farther away than the range of a float");
    return status;
}

static bool wants_red(const struct construct *from)
{
    bool wanted = from->material_count == 0;
    for (uint32_t i = 0; i < from->model_count; i++)
        wanted |= from->model[i].material == CONSTRUCT_DEFAULT;
    return wanted;
}

static enum status check_material(const struct construct *from, uint32_t i, struct reason *reason)
{
    const struct construct_model *model = &from->model[i];
    uint32_t count = from->material_count;
    if (model->material == CONSTRUCT_DEFAULT || model->material < (count ? count : 1))
        return STATUS_OK;
    if (count == 0)
        return fail(reason, STATUS_INPUT,
                    MODEL_IS ": material %u, but none is given: there is only the default, 0",
                    MODEL(i, model), model->material);
    return fail(reason, STATUS_INPUT,
                MODEL_IS ": material %u, but there %s %u, counted from 0 to %u", MODEL(i, model),
                model->material, count == 1 ? "is" : "are", count, count - 1);
}

static enum status check(const struct construct *from, struct reason *reason)
{
    enum status status = STATUS_OK;
    if (from->model_count == 0)
        return fail(reason, STATUS_INPUT, "no model is given");
    if (from->light_count)
        status = check_finite(from->light->pos, 4 * (size_t)from->light_count, 4, "light", reason);
    if (!status && from->material_count)
        status = check_finite(from->material->color, 7 * (size_t)from->material_count, 7,
                              "material", reason);
    if (!status)
        status = check_camera(&from->camera, reason);
    for (uint32_t i = 0; i < from->model_count && !status; i++)
        status = check_material(from, i, reason);
    return status;
}

/* Makes room for the vertices and triangles of `mesh`. */
static enum status reserve(struct growing *growing, uint32_t i, const struct scene *mesh,
                           struct reason *reason)
{
    struct scene *scene = &growing->scene;
    size_t vertices = (size_t)scene->vertex_count + mesh->vertex_count;
    size_t tris = (size_t)scene->tri_count + mesh->tri_count;
    void *vertex = scene->vertex, *index = scene->index, *material = scene->material_of;
    if (vertices > UINT32_MAX - 1 || tris > UINT32_MAX - 1)
        return fail(reason, STATUS_LIMIT,
                    MODEL_IS ": the scene has more than 2^32 - 2 vertices or triangles",
                    MODEL(i, &growing->from->model[i]));
    enum status status =
        array_reserve(&vertex, &growing->vertex_capacity, 3 * vertices, sizeof *scene->vertex);
    scene->vertex = vertex;
    if (!status)
        status = array_reserve(&index, &growing->index_capacity, 3 * tris, sizeof *scene->index);
    scene->index = index;
    if (!status)
        status =
            array_reserve(&material, &growing->material_capacity, tris, sizeof *scene->material_of);
    scene->material_of = material;
    return status ? fail(reason, status, MODEL_IS ": no memory for %zu triangles",
                         MODEL(i, &growing->from->model[i]), tris)
                  : STATUS_OK;
}

static enum status add_vertices(struct growing *growing, uint32_t i, const struct scene *mesh,
                                struct reason *reason)
{
    const struct construct_model *model = &growing->from->model[i];
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        float *to = growing->scene.vertex + 3 * (size_t)growing->scene.vertex_count++;
        transform_point(&model->transform, mesh->vertex + 3 * (size_t)v, to);
        if (!float_is_finite(to[0]) || !float_is_finite(to[1]) || !float_is_finite(to[2]))
            return fail(reason, STATUS_INPUT,
                        MODEL_IS ": its transform takes vertex %u out of the range of a float",
                        MODEL(i, model), v);
    }
    return STATUS_OK;
}

static void add_triangles(struct growing *growing, uint32_t i, const struct scene *mesh,
                          uint32_t base)
{
    const struct construct_model *model = &growing->from->model[i];
    struct scene *scene = &growing->scene;
    bool turned = model->transform.mirrors;
    uint32_t material = model->material == CONSTRUCT_DEFAULT ? growing->red : model->material;
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        const uint32_t *from = mesh->index + 3 * (size_t)t;
        uint32_t *to = scene->index + 3 * (size_t)scene->tri_count;
        to[0] = base + from[0];
        to[1] = base + from[turned ? 2 : 1];
        to[2] = base + from[turned ? 1 : 2];
        scene->material_of[scene->tri_count++] = (int32_t)material;
    }
}

static enum status add_model(struct growing *growing, uint32_t i, struct reason *reason)
{
    struct construct_model *model = &growing->from->model[i];
    struct scene mesh;
    if (growing->from->step)
        growing->from->step(growing->from->user, model->spec);
    enum status status = scene_open(model->spec, growing->from->seed, &mesh, reason);
    if (status)
        return status;
    uint32_t base = growing->scene.vertex_count;
    status = reserve(growing, i, &mesh, reason);
    if (!status)
        status = add_vertices(growing, i, &mesh, reason);
    if (!status) {
        add_triangles(growing, i, &mesh, base);
        model->vertex_count = mesh.vertex_count;
        model->tri_count = mesh.tri_count;
    }
    scene_free(&mesh);
    return status;
}

/* Error for a vertex without normal. Finds the model of vertex and triangle, and their indices in
 * it. */
static enum status refuse_normal(const struct growing *growing, uint32_t vertex, uint32_t tri,
                                 struct reason *reason)
{
    uint32_t i = 0;
    while (vertex >= growing->from->model[i].vertex_count) {
        vertex -= growing->from->model[i].vertex_count;
        tri -= growing->from->model[i++].tri_count;
    }
    return fail(reason, STATUS_INPUT,
                MODEL_IS ": vertex %u of triangle %u has no normal: its triangles have no area, or "
                         "face each other",
                MODEL(i, &growing->from->model[i]), vertex, tri);
}

static enum status add_normals(struct growing *growing, struct construct_notes *notes,
                               struct reason *reason)
{
    struct scene *scene = &growing->scene;
    uint8_t *none = alloc_zeroed(scene->vertex_count, 1);
    uint8_t *used = alloc_zeroed(scene->vertex_count, 1);
    enum status status = STATUS_OK;
    if (none && used)
        scene->normal = scene_normals_told(scene, none);
    if (!scene->normal)
        status = fail(reason, STATUS_MEMORY, "no memory for %u normals", scene->vertex_count);
    for (uint32_t t = 0; t < scene->tri_count && !status; t++)
        for (int c = 0; c < 3 && !status; c++) {
            uint32_t vertex = scene->index[3 * (size_t)t + (size_t)c];
            notes->filled += none[vertex] && !used[vertex];
            used[vertex] = 1;
            if (none[vertex] && !growing->from->fill_normals)
                status = refuse_normal(growing, vertex, t, reason);
        }
    for (uint32_t v = 0; v < scene->vertex_count && !status; v++)
        notes->unused += !used[v];
    free(none);
    free(used);
    return status;
}

/* Copies materials, lights and camera; appends the default red to the materials. */
static enum status furnish(struct growing *growing, struct reason *reason)
{
    const struct construct *from = growing->from;
    struct scene *scene = &growing->scene;
    bool red = growing->red != CONSTRUCT_DEFAULT;
    scene->material = alloc_zeroed((size_t)from->material_count + red, sizeof *scene->material);
    if (from->light_count)
        scene->light = alloc_zeroed(from->light_count, sizeof *scene->light);
    if (!scene->material || (from->light_count && !scene->light))
        return fail(reason, STATUS_MEMORY, "no memory for materials and lights");
    if (from->material_count)
        memcpy(scene->material, from->material, from->material_count * sizeof *scene->material);
    if (red)
        scene->material[growing->red] = rtrs_red;
    if (from->light_count)
        memcpy(scene->light, from->light, from->light_count * sizeof *scene->light);
    scene->material_count = from->material_count + red;
    scene->light_count = from->light_count;
    scene->camera = from->camera;
    scene->has_camera = true;
    return STATUS_OK;
}

enum status construct_scene(const struct construct *from, struct scene *out,
                            struct construct_notes *notes, struct reason *reason)
{
    struct growing growing = {.from = from, .red = CONSTRUCT_DEFAULT};
    *out = (struct scene){0};
    enum status status = check(from, reason);
    if (!status && wants_red(from))
        growing.red = from->material_count;
    *notes = (struct construct_notes){.red = growing.red};
    if (!status)
        status = furnish(&growing, reason);
    for (uint32_t i = 0; i < from->model_count && !status; i++)
        status = add_model(&growing, i, reason);
    if (!status)
        status = add_normals(&growing, notes, reason);
    if (status)
        scene_free(&growing.scene);
    else
        *out = growing.scene;
    return status;
}

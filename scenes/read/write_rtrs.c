#include "ref/base/decimal.h"
#include "scenes/read/formats.h"
#include "scenes/read/normals.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

const struct material rtrs_red = {{0.5f, 0.1f, 0.1f}, {0.9f, 0.1f, 0.0f}, 10.0f};

static void put_indent(FILE *stream, int depth)
{
    fprintf(stream, "%*s", 2 * depth, "");
}

/* `"key": x` on a line of its own; the last member of an object has no comma. */
static void put_float(FILE *stream, int depth, const char *key, float x)
{
    char text[DECIMAL_TEXT];
    decimal_write_float(x, text);
    put_indent(stream, depth);
    fprintf(stream, "\"%s\": %s\n", key, text);
}

static void put_float3(FILE *stream, int depth, const char *key, const float x[3], bool last)
{
    put_indent(stream, depth);
    fprintf(stream, "\"%s\": [\n", key);
    for (int k = 0; k < 3; k++) {
        char text[DECIMAL_TEXT];
        decimal_write_float(x[k], text);
        put_indent(stream, depth + 1);
        fprintf(stream, "%s%s\n", text, k < 2 ? "," : "");
    }
    put_indent(stream, depth);
    fputs(last ? "]\n" : "],\n", stream);
}

/* Opens and closes a list of objects, which is one word where it is empty. */
static void open_list(FILE *stream, const char *key, size_t count)
{
    fprintf(stream, "  \"%s\": [%s", key, count ? "\n" : "");
}

static void close_list(FILE *stream, size_t count, bool last)
{
    fprintf(stream, "%s]%s\n", count ? "  " : "", last ? "" : ",");
}

static void open_object(FILE *stream)
{
    fputs("    {\n", stream);
}

static void close_object(FILE *stream, bool last)
{
    fputs(last ? "    }\n" : "    },\n", stream);
}

static void put_camera(const struct camera *camera, FILE *stream)
{
    fputs("  \"camera\": {\n", stream);
    put_float3(stream, 2, "pos", camera->pos, false);
    put_float3(stream, 2, "at", camera->at, true);
    fputs("  },\n", stream);
    fprintf(stream, "  \"camera_controller\": \"%s\",\n", camera->orbit ? "Orbit" : "Fixed");
}

static void put_prims(const struct scene *scene, FILE *stream)
{
    open_list(stream, "prims", scene->tri_count);
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        const uint32_t *index = scene->index + 3 * (size_t)i;
        open_object(stream);
        fprintf(stream,
                "      \"indices\": [\n        %u,\n        %u,\n        %u\n      ],\n"
                "      \"material\": %d\n",
                index[0], index[1], index[2], scene->material_of ? scene->material_of[i] : 0);
        close_object(stream, i + 1 == scene->tri_count);
    }
    close_list(stream, scene->tri_count, false);
}

static void put_vertices(const struct scene *scene, const float *normal, FILE *stream)
{
    open_list(stream, "vertices", scene->vertex_count);
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        open_object(stream);
        put_float3(stream, 3, "pos", scene->vertex + 3 * (size_t)i, false);
        put_float3(stream, 3, "normal", normal + 3 * (size_t)i, true);
        close_object(stream, i + 1 == scene->vertex_count);
    }
    close_list(stream, scene->vertex_count, false);
}

static void put_lights(const struct scene *scene, FILE *stream)
{
    open_list(stream, "lights", scene->light_count);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        open_object(stream);
        put_float3(stream, 3, "pos", scene->light[i].pos, false);
        put_float(stream, 3, "strength", scene->light[i].strength);
        close_object(stream, i + 1 == scene->light_count);
    }
    close_list(stream, scene->light_count, false);
}

static void put_materials(const struct material *material, uint32_t count, FILE *stream)
{
    open_list(stream, "materials", count);
    for (uint32_t i = 0; i < count; i++) {
        open_object(stream);
        put_float3(stream, 3, "color", material[i].color, false);
        put_float3(stream, 3, "albedo", material[i].albedo, false);
        put_float(stream, 3, "spec", material[i].spec);
        close_object(stream, i + 1 == count);
    }
    close_list(stream, count, true);
}

/* The first of `count` numbers that JSON cannot hold. */
static enum status check_finite(const float *number, size_t count, const char *what,
                                struct reason *reason)
{
    for (size_t i = 0; i < count; i++)
        if (!float_is_finite(number[i]))
            return fail(reason, STATUS_INPUT,
                        "%s: number %zu is not finite, which JSON cannot hold", what, i);
    return STATUS_OK;
}

/* A light is 4 floats, a material 7, both without padding. */
_Static_assert(sizeof(struct light) == 4 * sizeof(float), "light is an array of floats");
_Static_assert(sizeof(struct material) == 7 * sizeof(float), "material is an array of floats");

static enum status check_all(const struct scene *scene, const struct camera *camera,
                             struct reason *reason)
{
    enum status status = STATUS_OK;
    if (scene->normal)
        status = check_finite(scene->normal, 3 * (size_t)scene->vertex_count, "normals", reason);
    if (status == STATUS_OK && scene->light_count)
        status = check_finite(scene->light->pos, 4 * (size_t)scene->light_count, "lights", reason);
    if (status == STATUS_OK && scene->material_count)
        status = check_finite(scene->material->color, 7 * (size_t)scene->material_count,
                              "materials", reason);
    if (status == STATUS_OK)
        status = check_finite(camera->pos, 3, "camera position", reason);
    return status == STATUS_OK ? check_finite(camera->at, 3, "camera target", reason) : status;
}

/* The scene's camera; one that was chosen is moved into the range of a float, which it leaves where
 * the scene spans more than half of that. */
static struct camera choose_camera(const struct scene *scene)
{
    struct camera camera = scene_camera(scene);
    for (int k = 0; k < 3 && !scene->has_camera; k++)
        camera.pos[k] = fmaxf(-FLT_MAX, fminf(camera.pos[k], FLT_MAX));
    return camera;
}

enum status write_rtrs(const struct scene *scene, FILE *stream, struct reason *reason)
{
    struct camera camera = choose_camera(scene);
    enum status status = check_all(scene, &camera, reason);
    if (status != STATUS_OK)
        return status;
    float *made = NULL;
    if (!scene->normal && !(made = scene_normals(scene)))
        return fail(reason, STATUS_MEMORY, "no memory for %u normals", scene->vertex_count);
    fputs("{\n", stream);
    put_camera(&camera, stream);
    put_prims(scene, stream);
    put_vertices(scene, made ? made : scene->normal, stream);
    put_lights(scene, stream);
    if (scene->material_count)
        put_materials(scene->material, scene->material_count, stream);
    else
        put_materials(&rtrs_red, 1, stream);
    fputs("}", stream);
    free(made);
    return STATUS_OK;
}

#include "ref/base/decimal.h"
#include "scenes/read/formats.h"
#include "scenes/read/normals.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

const struct material rtrs_red = {{0.5f, 0.1f, 0.1f}, {0.9f, 0.1f, 0.0f}, 10.0f};

/* What is written: the scene, and what it lacks. */
struct rtrs_out {
    const struct scene *scene;
    const struct material *material;
    const float *normal;
};

/* `"key": x` on a line of its own; the last member of an object has no comma. */
static void put_float(FILE *stream, const char *key, float x)
{
    char text[DECIMAL_TEXT];
    decimal_write_float(x, text);
    fprintf(stream, "      \"%s\": %s\n", key, text);
}

static void put_float3(FILE *stream, int depth, const char *key, const float x[3], bool last)
{
    fprintf(stream, "%*s\"%s\": [\n", 2 * depth, "", key);
    for (int k = 0; k < 3; k++) {
        char text[DECIMAL_TEXT];
        decimal_write_float(x[k], text);
        fprintf(stream, "%*s%s%s\n", 2 * depth + 2, "", text, k < 2 ? "," : "");
    }
    fprintf(stream, "%*s]%s\n", 2 * depth, "", last ? "" : ",");
}

static void put_camera(const struct camera *camera, FILE *stream)
{
    fputs("  \"camera\": {\n", stream);
    put_float3(stream, 2, "pos", camera->pos, false);
    put_float3(stream, 2, "at", camera->at, true);
    fputs("  },\n", stream);
    fprintf(stream, "  \"camera_controller\": \"%s\",\n", camera->orbit ? "Orbit" : "Fixed");
}

/* A list of objects, the members of each put by `put`; without one it is "[]". */
static void put_list(FILE *stream, const char *key, uint32_t count,
                     void (*put)(const struct rtrs_out *from, size_t i, FILE *stream),
                     const struct rtrs_out *from, bool last)
{
    fprintf(stream, "  \"%s\": [%s", key, count ? "\n" : "");
    for (uint32_t i = 0; i < count; i++) {
        fputs("    {\n", stream);
        put(from, i, stream);
        fputs(i + 1 == count ? "    }\n" : "    },\n", stream);
    }
    fprintf(stream, "%s]%s\n", count ? "  " : "", last ? "" : ",");
}

static void put_prim(const struct rtrs_out *from, size_t i, FILE *stream)
{
    const uint32_t *index = from->scene->index + 3 * i;
    fprintf(stream,
            "      \"indices\": [\n        %u,\n        %u,\n        %u\n      ],\n"
            "      \"material\": %d\n",
            index[0], index[1], index[2],
            from->scene->material_of ? from->scene->material_of[i] : 0);
}

static void put_vertex(const struct rtrs_out *from, size_t i, FILE *stream)
{
    put_float3(stream, 3, "pos", from->scene->vertex + 3 * i, false);
    put_float3(stream, 3, "normal", from->normal + 3 * i, true);
}

static void put_light(const struct rtrs_out *from, size_t i, FILE *stream)
{
    put_float3(stream, 3, "pos", from->scene->light[i].pos, false);
    put_float(stream, "strength", from->scene->light[i].strength);
}

static void put_material(const struct rtrs_out *from, size_t i, FILE *stream)
{
    put_float3(stream, 3, "color", from->material[i].color, false);
    put_float3(stream, 3, "albedo", from->material[i].albedo, false);
    put_float(stream, "spec", from->material[i].spec);
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
    if (!status && scene->light_count)
        status = check_finite(scene->light->pos, 4 * (size_t)scene->light_count, "lights", reason);
    if (!status && scene->material_count)
        status = check_finite(scene->material->color, 7 * (size_t)scene->material_count,
                              "materials", reason);
    if (!status)
        status = check_finite(camera->pos, 3, "camera position", reason);
    return status ? status : check_finite(camera->at, 3, "camera target", reason);
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
    if (status)
        return status;
    float *made = NULL;
    if (!scene->normal && !(made = scene_normals(scene)))
        return fail(reason, STATUS_MEMORY, "no memory for %u normals", scene->vertex_count);
    const struct rtrs_out from = {.scene = scene,
                                  .material = scene->material_count ? scene->material : &rtrs_red,
                                  .normal = made ? made : scene->normal};
    fputs("{\n", stream);
    put_camera(&camera, stream);
    put_list(stream, "prims", scene->tri_count, put_prim, &from, false);
    put_list(stream, "vertices", scene->vertex_count, put_vertex, &from, false);
    put_list(stream, "lights", scene->light_count, put_light, &from, false);
    put_list(stream, "materials", scene->material_count ? scene->material_count : 1, put_material,
             &from, true);
    fputs("}", stream);
    free(made);
    return STATUS_OK;
}

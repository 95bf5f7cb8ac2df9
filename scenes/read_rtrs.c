#include "scenes/formats.h"

#include <float.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

/* Where a value stands: "vertices[3]", "camera" or the whole file, for reasons. */
struct place {
    const char *name; /* of the file */
    const char *list; /* or NULL */
    size_t index;     /* NO_INDEX: `list` is no list */
    struct reason *reason;
};

#define NO_INDEX SIZE_MAX

/* "FILE: vertices[3].normal[1]: " and the rule; key NULL and element < 0 leave their part out. */
static enum status refuse(const struct place *place, const char *key, int element, const char *rule)
{
    char index[32] = "", inner[16] = "";
    if (place->index != NO_INDEX)
        snprintf(index, sizeof index, "[%zu]", place->index);
    if (element >= 0)
        snprintf(inner, sizeof inner, "[%d]", element);
    return fail(place->reason, STATUS_INPUT, "%s: %s%s%s%s%s%s%s", place->name,
                place->list ? place->list : "", index, place->list && key ? "." : "",
                key ? key : "", inner, place->list || key ? ": " : "", rule);
}

/* The member `key` of an object. */
static enum status get(const struct place *place, const json_t *object, const char *key,
                       const json_t **out)
{
    *out = NULL;
    if (!json_is_object(object))
        return refuse(place, NULL, -1, "must be an object");
    *out = json_object_get(object, key);
    return *out ? STATUS_OK : refuse(place, key, -1, "is missing");
}

static enum status to_float(const struct place *place, const char *key, int element,
                            const json_t *value, float *out)
{
    /* From here on a double rounds to 2^128: halfway between FLT_MAX and that. */
    static const double beyond = 0x1.ffffffp127;
    if (json_is_null(value))
        return refuse(place, key, element, "is null, which stands for NaN");
    if (!json_is_number(value))
        return refuse(place, key, element, "must be a number");
    if (json_is_integer(value)) {
        *out = (float)json_integer_value(value);
        return STATUS_OK;
    }
    double number = json_real_value(value);
    if (!(fabs(number) < beyond))
        return refuse(place, key, element, "is beyond the range of a 32-bit float");
    *out = (float)number;
    return STATUS_OK;
}

static enum status get_float(const struct place *place, const json_t *object, const char *key,
                             float *out)
{
    const json_t *value;
    enum status status = get(place, object, key, &value);
    return status == STATUS_OK ? to_float(place, key, -1, value, out) : status;
}

/* The member `key`, an array of exactly three elements. */
static enum status get_three(const struct place *place, const json_t *object, const char *key,
                             const json_t **out)
{
    enum status status = get(place, object, key, out);
    if (status != STATUS_OK)
        return status;
    if (!json_is_array(*out) || json_array_size(*out) != 3)
        return refuse(place, key, -1, "must be an array of exactly 3 numbers");
    return STATUS_OK;
}

static enum status get_float3(const struct place *place, const json_t *object, const char *key,
                              float out[3])
{
    const json_t *three;
    enum status status = get_three(place, object, key, &three);
    for (int k = 0; k < 3 && status == STATUS_OK; k++)
        status = to_float(place, key, k, json_array_get(three, (size_t)k), &out[k]);
    return status;
}

/* The list `key` of the file: its array, and memory for one element of `size` bytes each (NULL for
 * an empty list). */
static enum status get_list(const struct place *root, const json_t *file, const char *key,
                            size_t size, const json_t **list, void **memory)
{
    *memory = NULL;
    enum status status = get(root, file, key, list);
    if (status != STATUS_OK)
        return status;
    if (!json_is_array(*list))
        return refuse(root, key, -1, "must be an array");
    if (json_array_size(*list) >= UINT32_MAX)
        return refuse(root, key, -1, "has more than 4294967294 elements");
    if (json_array_size(*list) == 0)
        return STATUS_OK;
    *memory = alloc_zeroed(json_array_size(*list), size);
    if (!*memory)
        return fail(root->reason, STATUS_MEMORY, "%s: no memory for %zu %s", root->name,
                    json_array_size(*list), key);
    return STATUS_OK;
}

static enum status read_vertices(const struct place *root, const json_t *file, struct scene *scene)
{
    const json_t *list;
    void *positions, *normals;
    enum status status = get_list(root, file, "vertices", 3 * sizeof(float), &list, &positions);
    scene->vertex = positions;
    if (status != STATUS_OK)
        return status;
    scene->vertex_count = (uint32_t)json_array_size(list);
    status = get_list(root, file, "vertices", 3 * sizeof(float), &list, &normals);
    scene->normal = normals;
    for (uint32_t i = 0; i < scene->vertex_count && status == STATUS_OK; i++) {
        const json_t *vertex = json_array_get(list, i);
        const struct place place = {root->name, "vertices", i, root->reason};
        status = get_float3(&place, vertex, "pos", scene->vertex + 3 * (size_t)i);
        if (status == STATUS_OK)
            status = get_float3(&place, vertex, "normal", scene->normal + 3 * (size_t)i);
    }
    return status;
}

static enum status read_prim(const struct place *place, const json_t *prim, struct scene *scene)
{
    const json_t *indices, *material;
    enum status status = get_three(place, prim, "indices", &indices);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < 3; k++) {
        const json_t *index = json_array_get(indices, (size_t)k);
        if (!json_is_integer(index) || json_integer_value(index) < 0)
            return refuse(place, "indices", k, "must be a whole number from 0");
        if (json_integer_value(index) >= scene->vertex_count)
            return refuse(place, "indices", k, "names a vertex that does not exist");
        scene->index[3 * place->index + (size_t)k] = (uint32_t)json_integer_value(index);
    }
    status = get(place, prim, "material", &material);
    if (status != STATUS_OK)
        return status;
    if (!json_is_integer(material))
        return refuse(place, "material", -1, "must be a whole number");
    json_int_t number = json_integer_value(material);
    /* 0 is fine without materials: the default one stands in. */
    if (number != 0 && (number < 0 || number >= scene->material_count || number > INT32_MAX))
        return refuse(place, "material", -1, "names a material that does not exist");
    scene->material_of[place->index] = (int32_t)number;
    return STATUS_OK;
}

static enum status read_prims(const struct place *root, const json_t *file, struct scene *scene)
{
    const json_t *list;
    void *indices, *materials;
    enum status status = get_list(root, file, "prims", 3 * sizeof(uint32_t), &list, &indices);
    scene->index = indices;
    if (status != STATUS_OK)
        return status;
    scene->tri_count = (uint32_t)json_array_size(list);
    if (scene->tri_count == 0)
        return refuse(root, "prims", -1, "is empty: the scene has no triangle");
    status = get_list(root, file, "prims", sizeof(int32_t), &list, &materials);
    scene->material_of = materials;
    for (uint32_t i = 0; i < scene->tri_count && status == STATUS_OK; i++) {
        const struct place place = {root->name, "prims", i, root->reason};
        status = read_prim(&place, json_array_get(list, i), scene);
    }
    return status;
}

static enum status read_lights(const struct place *root, const json_t *file, struct scene *scene)
{
    const json_t *list;
    void *lights;
    enum status status = get_list(root, file, "lights", sizeof *scene->light, &list, &lights);
    scene->light = lights;
    if (status != STATUS_OK)
        return status;
    scene->light_count = (uint32_t)json_array_size(list);
    for (uint32_t i = 0; i < scene->light_count && status == STATUS_OK; i++) {
        const json_t *light = json_array_get(list, i);
        const struct place place = {root->name, "lights", i, root->reason};
        status = get_float3(&place, light, "pos", scene->light[i].pos);
        if (status == STATUS_OK)
            status = get_float(&place, light, "strength", &scene->light[i].strength);
    }
    return status;
}

static enum status read_materials(const struct place *root, const json_t *file, struct scene *scene)
{
    const json_t *list;
    void *materials;
    enum status status =
        get_list(root, file, "materials", sizeof *scene->material, &list, &materials);
    scene->material = materials;
    if (status != STATUS_OK)
        return status;
    scene->material_count = (uint32_t)json_array_size(list);
    for (uint32_t i = 0; i < scene->material_count && status == STATUS_OK; i++) {
        const json_t *material = json_array_get(list, i);
        const struct place place = {root->name, "materials", i, root->reason};
        status = get_float3(&place, material, "color", scene->material[i].color);
        if (status == STATUS_OK)
            status = get_float3(&place, material, "albedo", scene->material[i].albedo);
        if (status == STATUS_OK)
            status = get_float(&place, material, "spec", &scene->material[i].spec);
    }
    return status;
}

static enum status read_camera(const struct place *root, const json_t *file, struct scene *scene)
{
    const json_t *camera, *controller;
    const struct place place = {root->name, "camera", NO_INDEX, root->reason};
    enum status status = get(root, file, "camera", &camera);
    if (status == STATUS_OK)
        status = get_float3(&place, camera, "pos", scene->camera.pos);
    if (status == STATUS_OK)
        status = get_float3(&place, camera, "at", scene->camera.at);
    if (status == STATUS_OK)
        status = get(root, file, "camera_controller", &controller);
    if (status != STATUS_OK)
        return status;
    const char *word = json_string_value(controller);
    if (!word || (strcmp(word, "Orbit") != 0 && strcmp(word, "Fixed") != 0))
        return refuse(root, "camera_controller", -1, "must be \"Orbit\" or \"Fixed\"");
    scene->camera.orbit = word[0] == 'O';
    scene->has_camera = true;
    return STATUS_OK;
}

/* Why jansson could not parse: its text may quote the file, so control bytes are replaced. */
static enum status refuse_syntax(const char *name, const json_error_t *error, struct reason *reason)
{
    char text[JSON_ERROR_TEXT_LENGTH];
    snprintf(text, sizeof text, "%s", error->text);
    for (char *at = text; *at; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7F)
            *at = '?';
    if (json_error_code(error) == json_error_out_of_memory)
        return fail(reason, STATUS_MEMORY, "%s: no memory to parse the JSON text", name);
    return fail(reason, STATUS_INPUT, "%s: line %d, column %d: %s", name, error->line,
                error->column, text);
}

enum status read_rtrs(const char *name, const char *bytes, size_t size, struct scene *out,
                      struct reason *reason)
{
    *out = (struct scene){0};
    json_error_t error;
    json_t *file = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &error);
    if (!file)
        return refuse_syntax(name, &error, reason);
    const struct place root = {name, NULL, NO_INDEX, reason};
    enum status status = read_camera(&root, file, out);
    if (status == STATUS_OK)
        status = read_vertices(&root, file, out);
    if (status == STATUS_OK)
        status = read_materials(&root, file, out);
    if (status == STATUS_OK)
        status = read_prims(&root, file, out);
    if (status == STATUS_OK)
        status = read_lights(&root, file, out);
    json_decref(file);
    struct reason rule;
    if (status == STATUS_OK && (status = scene_check(out, &rule)) != STATUS_OK)
        status = fail(reason, status, "%s: %s", name, rule.text);
    if (status != STATUS_OK)
        scene_free(out);
    return status;
}

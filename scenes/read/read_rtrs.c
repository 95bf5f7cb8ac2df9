#include "ref/base/json_text.h"
#include "scenes/read/formats.h"
#include "scenes/read/json_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Position of a value for reasons: "vertices[3]", "camera" or the whole file. */
struct rtrs_place {
    const char *name; /* of the file */
    const char *list; /* or NULL */
    size_t index;     /* NO_INDEX: `list` is no list */
    struct reason *reason;
};

#define NO_INDEX SIZE_MAX

/* "FILE: vertices[3].normal[1]: " and the rule; key NULL and element < 0 leave their part out. */
static enum status refuse(const struct rtrs_place *place, const char *key, int element,
                          const char *rule)
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
static enum status get(const struct rtrs_place *place, const json_t *object, const char *key,
                       const json_t **out)
{
    *out = NULL;
    if (!json_is_object(object))
        return refuse(place, NULL, -1, "must be an object");
    *out = json_object_get(object, key);
    return *out ? STATUS_OK : refuse(place, key, -1, "is missing");
}

static enum status to_float(const struct rtrs_place *place, const char *key, int element,
                            const json_t *value, float *out)
{
    /* From here on a double rounds to 2^128: halfway between FLT_MAX and that. */
    static const double beyond = 0x1.ffffffp127;
    if (json_is_null(value))
        return refuse(place, key, element, "is null (NaN)");
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

static enum status get_float(const struct rtrs_place *place, const json_t *object, const char *key,
                             float *out)
{
    const json_t *value;
    enum status status = get(place, object, key, &value);
    return status ? status : to_float(place, key, -1, value, out);
}

/* The member `key`, an array of exactly three elements. */
static enum status get_three(const struct rtrs_place *place, const json_t *object, const char *key,
                             const json_t **out)
{
    enum status status = get(place, object, key, out);
    if (status)
        return status;
    if (!json_is_array(*out) || json_array_size(*out) != 3)
        return refuse(place, key, -1, "must be an array of exactly 3 numbers");
    return STATUS_OK;
}

static enum status get_float3(const struct rtrs_place *place, const json_t *object, const char *key,
                              float out[3])
{
    const json_t *three;
    enum status status = get_three(place, object, key, &three);
    for (int k = 0; k < 3 && !status; k++)
        status = to_float(place, key, k, json_array_get(three, (size_t)k), &out[k]);
    return status;
}

/* The elements of the four lists as they stand in the file. */
struct vertex {
    float pos[3], normal[3];
};

struct prim {
    uint32_t index[3];
    int32_t material;
};

static enum status take_vertex(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct vertex *vertex = out;
    enum status status = get_float3(place, json, "pos", vertex->pos);
    return status ? status : get_float3(place, json, "normal", vertex->normal);
}

static enum status take_prim(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct prim *prim = out;
    const json_t *indices, *material;
    enum status status = get_three(place, json, "indices", &indices);
    if (status)
        return status;
    for (int k = 0; k < 3; k++) {
        const json_t *index = json_array_get(indices, (size_t)k);
        json_int_t number = json_integer_value(index);
        if (!json_is_integer(index) || number < 0 || number > UINT32_MAX)
            return refuse(place, "indices", k, "must be a whole number from 0 to 4294967295");
        prim->index[k] = (uint32_t)number;
    }
    status = get(place, json, "material", &material);
    if (status)
        return status;
    json_int_t number = json_integer_value(material);
    if (!json_is_integer(material) || number < 0 || number > INT32_MAX)
        return refuse(place, "material", -1, "must be a whole number from 0 to 2147483647");
    prim->material = (int32_t)number;
    return STATUS_OK;
}

static enum status take_light(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct light *light = out;
    enum status status = get_float3(place, json, "pos", light->pos);
    return status ? status : get_float(place, json, "strength", &light->strength);
}

static enum status take_material(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct material *material = out;
    enum status status = get_float3(place, json, "color", material->color);
    if (!status)
        status = get_float3(place, json, "albedo", material->albedo);
    return status ? status : get_float(place, json, "spec", &material->spec);
}

static enum status take_camera(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct camera *camera = out;
    enum status status = get_float3(place, json, "pos", camera->pos);
    return status ? status : get_float3(place, json, "at", camera->at);
}

static enum status take_controller(const struct rtrs_place *place, const json_t *json, void *out)
{
    struct camera *camera = out;
    const char *word = json_string_value(json);
    if (!word || (strcmp(word, "Orbit") != 0 && strcmp(word, "Fixed") != 0))
        return refuse(place, NULL, -1, "must be \"Orbit\" or \"Fixed\"");
    camera->orbit = word[0] == 'O';
    return STATUS_OK;
}

/* A member of the file: a list, growing while it is read, or a single value. */
struct rtrs_member {
    const char *key;
    size_t size; /* of a list's element; 0: no list */
    enum status (*take)(const struct rtrs_place *place, const json_t *json, void *out);
    bool seen;
    void *items; /* of a single value borrowed */
    size_t count, capacity;
};

enum { CAMERA, CONTROLLER, PRIMS, VERTICES, LIGHTS, MATERIALS, MEMBERS };

/* The file while it is read. */
struct rtrs {
    struct json_walk walk;
    struct rtrs_member member[MEMBERS];
    struct camera camera;
};

static enum status read_list(struct json_walk *walk, struct rtrs_member *list)
{
    bool more;
    enum status status = json_walk_open(walk, '[');
    while (!status) {
        json_t *json;
        status = json_walk_more(walk, ']', &more);
        if (status || !more || (status = json_walk_value(walk, &json)) != STATUS_OK)
            break;
        const struct rtrs_place place = {walk->name, list->key, list->count, walk->reason};
        if (list->count == UINT32_MAX - 1)
            status = refuse(&place, NULL, -1, "is one more than 4294967294");
        else if (array_reserve(&list->items, &list->capacity, list->count + 1, list->size))
            status = fail(walk->reason, STATUS_MEMORY, "%s: no memory for %zu %s", walk->name,
                          list->count + 1, list->key);
        else
            status = list->take(&place, json, (char *)list->items + list->count++ * list->size);
        json_decref(json);
    }
    return status;
}

/* Reads the value of the file's member `key`; of an unknown one it is ignored. */
static enum status read_member(struct rtrs *rtrs, const char *key)
{
    const struct rtrs_place place = {rtrs->walk.name, key, NO_INDEX, rtrs->walk.reason};
    struct rtrs_member *member = NULL;
    for (int i = 0; i < MEMBERS; i++)
        if (strcmp(key, rtrs->member[i].key) == 0)
            member = &rtrs->member[i];
    if (member && member->seen)
        return refuse(&place, NULL, -1, "is there twice");
    if (member)
        member->seen = true;
    if (member && member->size)
        return read_list(&rtrs->walk, member);
    json_t *json;
    enum status status = json_walk_value(&rtrs->walk, &json);
    if (!status && member)
        status = member->take(&place, json, member->items);
    json_decref(json);
    return status;
}

static enum status read_file(struct rtrs *rtrs)
{
    bool more;
    enum status status = json_walk_open(&rtrs->walk, '{');
    while (!status) {
        json_t *key;
        status = json_walk_more(&rtrs->walk, '}', &more);
        if (status || !more || (status = json_walk_key(&rtrs->walk, &key)))
            break;
        status = read_member(rtrs, json_string_value(key));
        json_decref(key);
    }
    if (!status)
        status = json_walk_end(&rtrs->walk);
    for (int i = 0; i < MEMBERS && !status; i++) {
        const struct rtrs_place place = {rtrs->walk.name, rtrs->member[i].key, NO_INDEX,
                                         rtrs->walk.reason};
        if (!rtrs->member[i].seen)
            status = refuse(&place, NULL, -1, "is missing");
    }
    const struct rtrs_place prims = {rtrs->walk.name, "prims", NO_INDEX, rtrs->walk.reason};
    if (!status && rtrs->member[PRIMS].count == 0)
        status = refuse(&prims, NULL, -1, "is empty: the scene has no triangle");
    return status;
}

/* Checks that every vertex and material named by a triangle exists. Without materials 0 names the
 * default one. */
static enum status check_names(const struct rtrs *rtrs)
{
    const struct prim *prim = rtrs->member[PRIMS].items;
    size_t materials = rtrs->member[MATERIALS].count;
    for (size_t i = 0; i < rtrs->member[PRIMS].count; i++) {
        const struct rtrs_place place = {rtrs->walk.name, "prims", i, rtrs->walk.reason};
        for (int k = 0; k < 3; k++)
            if (prim[i].index[k] >= rtrs->member[VERTICES].count)
                return refuse(&place, "indices", k, "names a vertex that does not exist");
        if (prim[i].material != 0 && (size_t)prim[i].material >= materials)
            return refuse(&place, "material", -1, "names a material that does not exist");
    }
    return STATUS_OK;
}

/* Gives a list that is an array of the scene to it; NULL where it is empty. */
static void *hand_over(struct rtrs_member *list, uint32_t *count)
{
    void *items = list->items;
    *count = (uint32_t)list->count;
    list->items = NULL;
    return items;
}

static enum status to_scene(struct rtrs *rtrs, struct scene *out)
{
    const struct vertex *vertex = rtrs->member[VERTICES].items;
    const struct prim *prim = rtrs->member[PRIMS].items;
    uint32_t vertex_count = (uint32_t)rtrs->member[VERTICES].count;
    uint32_t tri_count = (uint32_t)rtrs->member[PRIMS].count;
    enum status status = scene_make(vertex_count, tri_count, out);
    if (!status) {
        out->normal = alloc_zeroed(vertex_count, 3 * sizeof *out->normal);
        out->material_of = alloc_zeroed(tri_count, sizeof *out->material_of);
    }
    if (!out->normal || !out->material_of) {
        scene_free(out);
        return fail(rtrs->walk.reason, STATUS_MEMORY, "%s: no memory for %u triangles",
                    rtrs->walk.name, tri_count);
    }
    for (size_t i = 0; i < vertex_count; i++) {
        memcpy(out->vertex + 3 * i, vertex[i].pos, sizeof vertex[i].pos);
        memcpy(out->normal + 3 * i, vertex[i].normal, sizeof vertex[i].normal);
    }
    for (size_t i = 0; i < tri_count; i++) {
        memcpy(out->index + 3 * i, prim[i].index, sizeof prim[i].index);
        out->material_of[i] = prim[i].material;
    }
    out->light = hand_over(&rtrs->member[LIGHTS], &out->light_count);
    out->material = hand_over(&rtrs->member[MATERIALS], &out->material_count);
    out->camera = rtrs->camera;
    out->has_camera = true;
    struct reason rule;
    status = scene_check(out, &rule);
    if (!status)
        return STATUS_OK;
    scene_free(out);
    return fail(rtrs->walk.reason, status, "%s: %s", rtrs->walk.name, rule.text);
}

enum status read_rtrs(const char *name, const char *bytes, size_t size, struct scene *out,
                      struct reason *reason)
{
    *out = (struct scene){0};
    struct rtrs rtrs = {
        .walk = {.name = name, .start = bytes, .at = bytes, .end = bytes + size, .reason = reason},
        .member = {
            [CAMERA] = {.key = "camera", .take = take_camera, .items = &rtrs.camera},
            [CONTROLLER] = {.key = "camera_controller",
                            .take = take_controller,
                            .items = &rtrs.camera},
            [PRIMS] = {.key = "prims", .size = sizeof(struct prim), .take = take_prim},
            [VERTICES] = {.key = "vertices", .size = sizeof(struct vertex), .take = take_vertex},
            [LIGHTS] = {.key = "lights", .size = sizeof(struct light), .take = take_light},
            [MATERIALS] = {
                .key = "materials", .size = sizeof(struct material), .take = take_material}}};
    if (!json_text_fits(bytes, size))
        return fail(reason, STATUS_INPUT, "%s: " JSON_TEXT_RULE, name);
    enum status status = read_file(&rtrs);
    if (!status)
        status = check_names(&rtrs);
    if (!status)
        status = to_scene(&rtrs, out);
    for (int i = PRIMS; i < MEMBERS; i++)
        free(rtrs.member[i].items);
    return status;
}

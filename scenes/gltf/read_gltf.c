#include "scenes/gltf/gltf.h"
#include "scenes/read/world_fields.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status gltf_fail(const struct gltf *gltf, const char *format, ...)
{
    char text[240];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fail(gltf->pull.walk.reason, STATUS_INPUT, "%s: %s", gltf->pull.walk.name, text);
}

enum status gltf_no_memory(const struct gltf *gltf)
{
    return fail(gltf->pull.walk.reason, STATUS_MEMORY, "%s: no memory", gltf->pull.walk.name);
}

void *gltf_append(void *item, size_t *capacity, size_t *count, size_t size)
{
    char *array;
    if (array_reserve(item, capacity, *count + 1, size))
        return NULL;
    memcpy(&array, item, sizeof array); /* object pointers have one representation (POSIX) */
    return memset(array + size * (*count)++, 0, size);
}

enum status gltf_take_id(struct json_pull *pull, uint32_t *out)
{
    uint64_t id;
    enum status status = json_pull_whole(pull, GLTF_NONE - 1, &id);
    *out = status ? GLTF_NONE : (uint32_t)id;
    return status;
}

/* --- the top of the file ---------------------------------------------------------------------- */

static enum status take_version(struct json_pull *pull, void *self)
{
    (void)self;
    json_t *text;
    enum status status = json_pull_text(pull, &text);
    if (!status && strncmp(json_string_value(text), "2.", 2) != 0)
        status = json_pull_fail(pull, "is '%.20s'; glTF 2.0 is read", json_string_value(text));
    json_decref(text);
    return status;
}

static enum status take_asset(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"version", take_version, true}, {0}};
    return json_pull_object(pull, members, self);
}

static enum status refuse_extension(struct json_pull *pull, void *self)
{
    (void)self;
    json_t *text;
    enum status status = json_pull_text(pull, &text);
    if (!status)
        status = json_pull_fail(pull, "the extension %.60s is required, which is not read",
                                json_string_value(text));
    json_decref(text);
    return status;
}

static enum status take_required(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, refuse_extension, self);
}

static enum status take_default(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct gltf *)self)->default_scene);
}

static enum status take_world_filter(struct json_pull *pull, void *self)
{
    return take_filter(pull, &((struct gltf *)self)->filter);
}

static enum status take_raydiff(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"filter", take_world_filter, false}, {0}};
    return json_pull_object(pull, members, self);
}

static enum status take_extras(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"raydiff", take_raydiff, false}, {0}};
    if (json_walk_peek(&pull->walk) != '{')
        return json_walk_skip(&pull->walk);
    return json_pull_object(pull, members, self);
}

static const struct json_member top[] = {{"asset", take_asset, true},
                                         {"extensionsRequired", take_required, false},
                                         {"scene", take_default, false},
                                         {"scenes", gltf_take_scenes, false},
                                         {"nodes", gltf_take_nodes, false},
                                         {"meshes", gltf_take_meshes, false},
                                         {"materials", gltf_take_materials, false},
                                         {"accessors", gltf_take_accessors, false},
                                         {"bufferViews", gltf_take_views, false},
                                         {"buffers", gltf_take_buffers, false},
                                         {"extras", take_extras, false},
                                         {0}};

/* --- GLB -------------------------------------------------------------------------------------- */

#define GLB_HEADER 12u /* "glTF", version, length */
#define GLB_CHUNK  8u  /* length, type */

static uint32_t get_u32(const char *at)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)(unsigned char)at[i] << (8 * i);
    return value;
}

static bool is_glb(const char *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "glTF", 4) == 0;
}

/* Finds the chunks: JSON comes first, then BIN, if there is one; others are skipped. */
static enum status find_chunks(struct gltf *gltf, const char *bytes, size_t size, const char **json,
                               size_t *json_size)
{
    *json = NULL;
    if (size < GLB_HEADER + GLB_CHUNK)
        return gltf_fail(gltf, "byte %zu: the header is cut short", size);
    if (get_u32(bytes + 4) != 2)
        return gltf_fail(gltf, "byte 4: version %u of GLB; 2 is read", get_u32(bytes + 4));
    if (get_u32(bytes + 8) != size)
        return gltf_fail(gltf, "byte 8: the length is %u, but the file has %zu bytes",
                         get_u32(bytes + 8), size);
    for (size_t at = GLB_HEADER; at < size;) {
        if (size - at < GLB_CHUNK)
            return gltf_fail(gltf, "byte %zu: a chunk is cut short", at);
        uint32_t length = get_u32(bytes + at), type = get_u32(bytes + at + 4);
        if (length % 4 != 0 || length > size - at - GLB_CHUNK)
            return gltf_fail(gltf,
                             "byte %zu: the chunk has %u bytes, but %zu follow; it must be a "
                             "multiple of 4",
                             at, length, size - at - GLB_CHUNK);
        const char *data = bytes + at + GLB_CHUNK;
        if ((type == 0x4E4F534Au) != (at == GLB_HEADER))
            return gltf_fail(gltf, "byte %zu: the first chunk, and no other, must be JSON", at);
        if (at == GLB_HEADER) {
            *json = data;
            *json_size = length;
        } else if (type == 0x004E4942u && !gltf->chunk) {
            gltf->chunk = data;
            gltf->chunk_size = length;
        }
        at += GLB_CHUNK + length;
    }
    return STATUS_OK;
}

/* --- the file --------------------------------------------------------------------------------- */

static void free_lists(struct gltf *gltf)
{
    for (size_t i = 0; i < gltf->buffer.count; i++) {
        json_decref(gltf->buffer.item[i].uri);
        free(gltf->buffer.item[i].own);
    }
    for (size_t i = 0; i < gltf->node.count; i++)
        free(gltf->node.item[i].told);
    free(gltf->buffer.item);
    free(gltf->view.item);
    free(gltf->accessor.item);
    free(gltf->material.item);
    free(gltf->primitive.item);
    free(gltf->mesh.item);
    free(gltf->node.item);
    free(gltf->child.item);
    free(gltf->transform.item);
    free(gltf->scene.item);
    free(gltf->root.item);
    free(gltf->base_of);
}

/* Makes the meshes and the instances of what has been read. */
static enum status make_world(struct gltf *gltf, bool *double_sided, struct world *out)
{
    for (size_t i = 0; i < gltf->accessor.count; i++)
        gltf->base_of[i] = GLTF_NONE;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < gltf->mesh.count && !status; i++) {
        out->mesh_count = i + 1;
        status = gltf_make_mesh(gltf, i, &out->mesh[i], &double_sided[i]);
    }
    if (!status)
        status = gltf_make_instances(gltf, double_sided, out);
    if (status)
        return status;
    struct reason why = {""};
    out->filter = gltf->filter;
    status = world_finish(out, &why);
    return status == STATUS_MEMORY ? gltf_no_memory(gltf)
           : status                ? gltf_fail(gltf, "%s", why.text)
                                   : STATUS_OK;
}

enum status read_gltf(const char *name, const char *bytes, size_t size,
                      const struct world_files *files, struct world *out, struct world_notes *notes,
                      struct reason *reason)
{
    *out = (struct world){0};
    *notes = (struct world_notes){0};
    struct gltf gltf = {.files = files, .notes = notes, .given = size, .default_scene = GLTF_NONE};
    gltf.pull = json_pull_make(name, bytes, size, reason);
    enum status status = STATUS_OK;
    if (is_glb(bytes, size)) {
        const char *json;
        size_t json_size = 0;
        status = find_chunks(&gltf, bytes, size, &json, &json_size);
        if (!status)
            gltf.pull = json_pull_make(name, json, json_size, reason);
    }
    if (!status)
        status = json_pull_file(&gltf.pull, top, &gltf);
    bool *double_sided = alloc_zeroed(gltf.mesh.count, sizeof *double_sided);
    out->mesh = alloc_zeroed(gltf.mesh.count, sizeof *out->mesh);
    gltf.base_of = alloc_zeroed(gltf.accessor.count, sizeof *gltf.base_of);
    if (!status && (!double_sided || !out->mesh || !gltf.base_of))
        status = gltf_no_memory(&gltf);
    if (!status)
        status = make_world(&gltf, double_sided, out);
    free(double_sided);
    free_lists(&gltf);
    if (status) {
        world_free(out);
        *notes = (struct world_notes){0};
    }
    return status;
}

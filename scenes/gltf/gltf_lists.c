/* Buffers, views, accessors, materials and meshes of a glTF file, as they stand there. */
#include "scenes/gltf/gltf.h"

#include <stdlib.h>
#include <string.h>

#define OFFSET_MOST (UINT64_C(1) << 53) /* whole numbers up to here are doubles */

static enum status take_offset(struct json_pull *pull, uint64_t *out)
{
    return json_pull_whole(pull, OFFSET_MOST, out);
}

/* --- buffers ---------------------------------------------------------------------------------- */

/* The text behind the comma of a data: URI of base64, or NULL. Media types are not looked at. */
static const char *base64_of(const char *uri)
{
    static const char mark[] = ";base64";
    const char *comma = strchr(uri, ',');
    size_t length = sizeof mark - 1;
    if (!comma || (size_t)(comma - uri) < length || memcmp(comma - length, mark, length) != 0)
        return NULL;
    return comma + 1;
}

static enum status take_uri(struct json_pull *pull, void *self)
{
    struct gltf_buffer *buffer = self;
    enum status status = json_pull_text(pull, &buffer->uri);
    if (status || strncmp(json_string_value(buffer->uri), "data:", 5) != 0)
        return status;
    const char *text = base64_of(json_string_value(buffer->uri));
    if (!text)
        return json_pull_fail(pull, "a data: URI must have ;base64, before its data");
    size_t size = strlen(text), got = 0;
    buffer->own = alloc_zeroed(size / 4 * 3, 1);
    if (!buffer->own)
        return fail(pull->walk.reason, STATUS_MEMORY, "%s: no memory", pull->walk.name);
    if (!base64_decode(text, size, buffer->own, &got))
        return json_pull_fail(pull, "is no base64: letters by fours, with padding");
    buffer->size = got;
    json_decref(buffer->uri);
    buffer->uri = NULL;
    return STATUS_OK;
}

static enum status take_length(struct json_pull *pull, void *self)
{
    return take_offset(pull, &((struct gltf_buffer *)self)->length);
}

static enum status take_buffer(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {
        {"uri", take_uri, false}, {"byteLength", take_length, true}, {0}};
    struct gltf *gltf = self;
    struct gltf_buffer *buffer;
    if (!GLTF_APPEND(gltf->buffer, buffer))
        return gltf_no_memory(gltf);
    return json_pull_object(pull, members, buffer);
}

enum status gltf_take_buffers(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_buffer, self);
}

/* --- views ------------------------------------------------------------------------------------ */

static enum status take_view_buffer(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct gltf_view *)self)->buffer);
}

static enum status take_view_offset(struct json_pull *pull, void *self)
{
    return take_offset(pull, &((struct gltf_view *)self)->offset);
}

static enum status take_view_length(struct json_pull *pull, void *self)
{
    return take_offset(pull, &((struct gltf_view *)self)->length);
}

static enum status take_stride(struct json_pull *pull, void *self)
{
    uint64_t stride;
    enum status status = json_pull_whole(pull, 252, &stride);
    if (!status && (stride < 4 || stride % 4 != 0))
        status = json_pull_fail(pull, "must be a multiple of 4 from 4 to 252");
    ((struct gltf_view *)self)->stride = (uint32_t)stride;
    return status;
}

static enum status take_view(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"buffer", take_view_buffer, true},
                                                 {"byteOffset", take_view_offset, false},
                                                 {"byteLength", take_view_length, true},
                                                 {"byteStride", take_stride, false},
                                                 {0}};
    struct gltf *gltf = self;
    struct gltf_view *view;
    if (!GLTF_APPEND(gltf->view, view))
        return gltf_no_memory(gltf);
    return json_pull_object(pull, members, view);
}

enum status gltf_take_views(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_view, self);
}

/* --- accessors -------------------------------------------------------------------------------- */

static enum status take_accessor_view(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct gltf_accessor *)self)->view);
}

static enum status take_accessor_offset(struct json_pull *pull, void *self)
{
    return take_offset(pull, &((struct gltf_accessor *)self)->offset);
}

static enum status take_accessor_count(struct json_pull *pull, void *self)
{
    return json_pull_whole(pull, UINT32_MAX - 1, &((struct gltf_accessor *)self)->count);
}

static enum status take_component(struct json_pull *pull, void *self)
{
    uint64_t component;
    enum status status = json_pull_whole(pull, UINT16_MAX, &component);
    ((struct gltf_accessor *)self)->component = (uint16_t)component;
    return status;
}

static enum status take_type(struct json_pull *pull, void *self)
{
    struct gltf_accessor *accessor = self;
    json_t *text;
    enum status status = json_pull_text(pull, &text);
    if (status)
        return status;
    accessor->vec3 = strcmp(json_string_value(text), "VEC3") == 0;
    accessor->scalar = strcmp(json_string_value(text), "SCALAR") == 0;
    json_decref(text);
    return STATUS_OK;
}

static enum status take_sparse(struct json_pull *pull, void *self)
{
    ((struct gltf_accessor *)self)->sparse = true;
    return json_walk_skip(&pull->walk);
}

static enum status take_accessor(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"bufferView", take_accessor_view, false},
                                                 {"byteOffset", take_accessor_offset, false},
                                                 {"componentType", take_component, true},
                                                 {"count", take_accessor_count, true},
                                                 {"type", take_type, true},
                                                 {"sparse", take_sparse, false},
                                                 {0}};
    struct gltf *gltf = self;
    struct gltf_accessor *accessor;
    if (!GLTF_APPEND(gltf->accessor, accessor))
        return gltf_no_memory(gltf);
    accessor->view = GLTF_NONE;
    return json_pull_object(pull, members, accessor);
}

enum status gltf_take_accessors(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_accessor, self);
}

/* --- materials -------------------------------------------------------------------------------- */

static enum status take_alpha(struct json_pull *pull, void *self)
{
    static const char *const word[] = {"OPAQUE", "MASK", "BLEND", NULL};
    unsigned which;
    enum status status = json_pull_word(pull, word, &which);
    ((struct gltf_material *)self)->opaque = which == 0;
    return status;
}

static enum status take_double_sided(struct json_pull *pull, void *self)
{
    return json_pull_bool(pull, &((struct gltf_material *)self)->double_sided);
}

static enum status take_material(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {
        {"alphaMode", take_alpha, false}, {"doubleSided", take_double_sided, false}, {0}};
    struct gltf *gltf = self;
    struct gltf_material *material;
    if (!GLTF_APPEND(gltf->material, material))
        return gltf_no_memory(gltf);
    material->opaque = true;
    return json_pull_object(pull, members, material);
}

enum status gltf_take_materials(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_material, self);
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* A primitive while it is read. */
struct primitive_read {
    struct gltf *gltf;
    struct gltf_primitive primitive;
};

static enum status take_position(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct primitive_read *)self)->primitive.position);
}

static enum status take_attributes(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"POSITION", take_position, false}, {0}};
    return json_pull_object(pull, members, self);
}

static enum status take_primitive_indices(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct primitive_read *)self)->primitive.indices);
}

static enum status take_primitive_material(struct json_pull *pull, void *self)
{
    return gltf_take_id(pull, &((struct primitive_read *)self)->primitive.material);
}

static enum status take_mode(struct json_pull *pull, void *self)
{
    uint64_t mode;
    enum status status = json_pull_whole(pull, GLTF_FAN, &mode);
    ((struct primitive_read *)self)->primitive.mode = (uint32_t)mode;
    return status;
}

static enum status take_targets(struct json_pull *pull, void *self)
{
    ((struct primitive_read *)self)->gltf->notes->morphs++;
    return json_walk_skip(&pull->walk);
}

static enum status take_primitive(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"attributes", take_attributes, true},
                                                 {"indices", take_primitive_indices, false},
                                                 {"material", take_primitive_material, false},
                                                 {"mode", take_mode, false},
                                                 {"targets", take_targets, false},
                                                 {0}};
    struct gltf *gltf = self;
    struct gltf_primitive *primitive;
    struct primitive_read read = {.gltf = gltf,
                                  .primitive = {GLTF_NONE, GLTF_NONE, GLTF_NONE, GLTF_TRIANGLES}};
    enum status status = json_pull_object(pull, members, &read);
    if (status)
        return status;
    if (read.primitive.mode < GLTF_TRIANGLES) {
        gltf->notes->points_and_lines++;
        return STATUS_OK;
    }
    if (read.primitive.position == GLTF_NONE)
        return json_pull_fail_at(pull, "attributes", JSON_PULL_NONE, "has no POSITION");
    if (!GLTF_APPEND(gltf->primitive, primitive))
        return gltf_no_memory(gltf);
    *primitive = read.primitive;
    gltf->mesh.item[gltf->mesh.count - 1].count++;
    return STATUS_OK;
}

static enum status take_primitives(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_primitive, self);
}

static enum status take_mesh(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"primitives", take_primitives, true}, {0}};
    struct gltf *gltf = self;
    struct gltf_range *mesh;
    if (!GLTF_APPEND(gltf->mesh, mesh))
        return gltf_no_memory(gltf);
    mesh->first = (uint32_t)gltf->primitive.count;
    return json_pull_object(pull, members, gltf);
}

enum status gltf_take_meshes(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_mesh, self);
}

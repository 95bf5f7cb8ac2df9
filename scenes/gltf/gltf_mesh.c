/* Buffers of a glTF file, and the meshes that are made of them. */
#include "scenes/gltf/gltf.h"

#include <stdlib.h>
#include <string.h>

/* --- bytes ------------------------------------------------------------------------------------ */

/* Writes the path of a relative URI: %20 and the like become their bytes. */
static bool path_of_uri(const char *uri, char *path)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    while (*uri) {
        *path = *uri++;
        if (*path++ != '%')
            continue;
        const char *high = uri[0] ? strchr(digits, uri[0]) : NULL;
        const char *low = high && uri[1] ? strchr(digits, uri[1]) : NULL;
        long byte = low ? (high - digits) % 16 * 16 + (low - digits) % 16 : 0;
        if (byte == 0)
            return false;
        path[-1] = (char)byte;
        uri += 2;
    }
    *path = '\0';
    return true;
}

static enum status read_file(struct gltf *gltf, uint32_t at)
{
    struct gltf_buffer *buffer = &gltf->buffer.item[at];
    const char *uri = json_string_value(buffer->uri);
    char *path = alloc_zeroed(strlen(uri) + 1, 1);
    struct reason why = {""};
    size_t size = 0;
    if (!path)
        return gltf_no_memory(gltf);
    enum status status = STATUS_INPUT;
    if (!path_of_uri(uri, path))
        status = fail(&why, status, "a %% must begin two hexadecimal digits, not 00");
    else
        status = gltf->files->bytes(gltf->files->user, path, &buffer->own, &size, &why);
    buffer->size = size;
    free(path);
    if (status == STATUS_MEMORY)
        return gltf_no_memory(gltf);
    gltf->given += size;
    return status ? gltf_fail(gltf, "buffers[%u].uri: %s", at, why.text) : STATUS_OK;
}

/* The bytes of a buffer, which is read if it has not been. */
static enum status get_buffer(struct gltf *gltf, uint32_t at, const char **out)
{
    struct gltf_buffer *buffer = &gltf->buffer.item[at];
    enum status status = STATUS_OK;
    bool of_chunk = at == 0 && !buffer->uri && !buffer->own;
    if (!buffer->own && buffer->uri)
        status = read_file(gltf, at);
    if (status)
        return status;
    if (of_chunk)
        buffer->size = gltf->chunk_size;
    *out = of_chunk ? gltf->chunk : buffer->own;
    if (!*out)
        return gltf_fail(gltf, "buffers[%u]: has no uri, and the file no chunk for it", at);
    if (buffer->length > buffer->size)
        return gltf_fail(gltf, "buffers[%u].byteLength: is %llu, but there are %llu bytes", at,
                         (unsigned long long)buffer->length, (unsigned long long)buffer->size);
    return STATUS_OK;
}

enum status gltf_elements(struct gltf *gltf, uint32_t at, size_t bytes, const unsigned char **first,
                          size_t *stride)
{
    const struct gltf_accessor *accessor = &gltf->accessor.item[at];
    if (accessor->sparse)
        return gltf_fail(gltf, "accessors[%u].sparse: sparse accessors are not read", at);
    if (accessor->view == GLTF_NONE)
        return gltf_fail(gltf, "accessors[%u]: has no bufferView", at);
    if (accessor->count == 0)
        return gltf_fail(gltf, "accessors[%u].count: must be at least 1", at);
    if (accessor->view >= gltf->view.count)
        return gltf_fail(gltf, "accessors[%u].bufferView: %u, but there are %zu", at,
                         accessor->view, gltf->view.count);
    const struct gltf_view *view = &gltf->view.item[accessor->view];
    if (view->buffer >= gltf->buffer.count)
        return gltf_fail(gltf, "bufferViews[%u].buffer: %u, but there are %zu", accessor->view,
                         view->buffer, gltf->buffer.count);
    const char *buffer;
    enum status status = get_buffer(gltf, view->buffer, &buffer);
    if (status)
        return status;
    uint64_t length = gltf->buffer.item[view->buffer].length;
    if (view->offset > length || view->length > length - view->offset)
        return gltf_fail(gltf, "bufferViews[%u]: ends at byte %llu, but buffers[%u] at %llu",
                         accessor->view, (unsigned long long)(view->offset + view->length),
                         view->buffer, (unsigned long long)length);
    *stride = view->stride ? view->stride : bytes;
    if (*stride < bytes)
        return gltf_fail(gltf, "bufferViews[%u].byteStride: %zu, but elements have %zu bytes",
                         accessor->view, *stride, bytes);
    /* count is below 2^32 and the stride at most 252: no overflow. */
    uint64_t end = accessor->offset + (accessor->count - 1) * *stride + bytes;
    if (end > view->length)
        return gltf_fail(gltf, "accessors[%u]: ends at byte %llu, but bufferViews[%u] at %llu", at,
                         (unsigned long long)end, accessor->view, (unsigned long long)view->length);
    *first = (const unsigned char *)buffer + view->offset + accessor->offset;
    return STATUS_OK;
}

static uint32_t get_whole(const unsigned char *at, size_t bytes)
{
    uint32_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << (8 * i);
    return value;
}

/* --- primitives ------------------------------------------------------------------------------- */

/* The corners of a primitive, in their order. */
struct corners {
    uint64_t count;
    const unsigned char *first; /* NULL: corner i is vertex i */
    size_t bytes, stride;
    uint32_t accessor;
    uint64_t vertices; /* of its positions */
};

/* Bytes of an index; 0 if the component type is not one of indices. */
static size_t index_bytes(uint16_t component)
{
    return component == 5121 ? 1 : component == 5123 ? 2 : component == 5125 ? 4 : 0;
}

static enum status check_position(struct gltf *gltf, uint32_t mesh, uint32_t at,
                                  const struct gltf_primitive *primitive)
{
    uint32_t position = primitive->position;
    const unsigned char *first;
    size_t stride;
    if (position >= gltf->accessor.count)
        return gltf_fail(gltf,
                         "meshes[%u].primitives[%u].attributes.POSITION: %u, but there are %zu "
                         "accessors",
                         mesh, at, position, gltf->accessor.count);
    if (!gltf->accessor.item[position].vec3 || gltf->accessor.item[position].component != 5126)
        return gltf_fail(gltf, "accessors[%u]: positions must be VEC3 of FLOAT (5126)", position);
    return gltf_elements(gltf, position, 12, &first, &stride);
}

/* Finds the corners of a primitive. */
static enum status find_corners(struct gltf *gltf, uint32_t mesh, uint32_t at,
                                const struct gltf_primitive *primitive, struct corners *out)
{
    enum status status = check_position(gltf, mesh, at, primitive);
    if (status)
        return status;
    *out = (struct corners){.accessor = primitive->indices,
                            .vertices = gltf->accessor.item[primitive->position].count};
    out->count = out->vertices;
    if (primitive->indices == GLTF_NONE)
        return STATUS_OK;
    if (primitive->indices >= gltf->accessor.count)
        return gltf_fail(gltf, "meshes[%u].primitives[%u].indices: %u, but there are %zu accessors",
                         mesh, at, primitive->indices, gltf->accessor.count);
    const struct gltf_accessor *accessor = &gltf->accessor.item[primitive->indices];
    out->bytes = index_bytes(accessor->component);
    out->count = accessor->count;
    if (!accessor->scalar || !out->bytes)
        return gltf_fail(gltf,
                         "accessors[%u]: indices must be SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT "
                         "or UNSIGNED_INT (5121, 5123, 5125)",
                         primitive->indices);
    return gltf_elements(gltf, primitive->indices, out->bytes, &out->first, &out->stride);
}

/* Number of triangles of a primitive. */
static enum status count_triangles(const struct gltf *gltf, uint32_t mesh, uint32_t at,
                                   const struct gltf_primitive *primitive, uint64_t corners,
                                   uint64_t *out)
{
    bool list = primitive->mode == GLTF_TRIANGLES;
    *out = list ? corners / 3 : corners - 2;
    if (corners >= 3 && (!list || corners % 3 == 0))
        return STATUS_OK;
    return gltf_fail(gltf, "meshes[%u].primitives[%u]: has %llu corners, which are no %s", mesh, at,
                     (unsigned long long)corners,
                     list ? "triangles of 3 each" : "strip or fan of 3 or more");
}

/* Reads corner `i`: a vertex of the primitive's positions. */
static enum status get_corner(const struct gltf *gltf, const struct corners *corners, uint64_t i,
                              uint32_t *out)
{
    *out = (uint32_t)i;
    if (!corners->first)
        return STATUS_OK;
    *out = get_whole(corners->first + i * corners->stride, corners->bytes);
    if (*out == UINT32_MAX >> (32 - 8 * corners->bytes))
        return gltf_fail(gltf, "accessors[%u]: element %llu is %u, which would end a strip",
                         corners->accessor, (unsigned long long)i, *out);
    if (*out < corners->vertices)
        return STATUS_OK;
    return gltf_fail(gltf, "accessors[%u]: element %llu names vertex %u, but there are %llu",
                     corners->accessor, (unsigned long long)i, *out,
                     (unsigned long long)corners->vertices);
}

/* The corner that is number `c` of triangle `i`, in the order of the specification. */
static uint64_t corner_of(uint32_t mode, uint64_t i, unsigned c)
{
    if (mode == GLTF_TRIANGLES)
        return 3 * i + c;
    if (mode == GLTF_FAN)
        return c == 2 ? 0 : i + 1 + c;
    return c == 0 ? i : c == 1 ? i + 1 + i % 2 : i + 2 - i % 2;
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Appends the positions of an accessor, if the mesh does not have them yet. */
static enum status copy_positions(struct gltf *gltf, uint32_t accessor, struct scene *scene,
                                  uint32_t *next)
{
    const unsigned char *first;
    size_t stride;
    if (gltf->base_of[accessor] != GLTF_NONE)
        return STATUS_OK;
    enum status status = gltf_elements(gltf, accessor, 12, &first, &stride);
    if (status)
        return status;
    gltf->base_of[accessor] = *next;
    for (uint64_t i = 0; i < gltf->accessor.item[accessor].count; i++) {
        float *vertex = scene->vertex + 3 * (size_t)(*next)++;
        for (unsigned k = 0; k < 3; k++) {
            vertex[k] = float_from_bits(get_whole(first + i * stride + 4 * k, 4));
            if (!float_is_finite(vertex[k]))
                return gltf_fail(gltf, "accessors[%u]: element %llu: %c is not a finite number",
                                 accessor, (unsigned long long)i, "xyz"[k]);
        }
    }
    return STATUS_OK;
}

/* Sums up the vertices and triangles of a mesh and refuses too many. The accessors are marked by
 * base_of, which is unmarked again. */
static enum status measure(struct gltf *gltf, uint32_t mesh, struct world_mesh *out,
                           uint64_t *vertices, uint64_t *triangles)
{
    struct gltf_range range = gltf->mesh.item[mesh];
    const struct gltf_primitive *primitive = gltf->primitive.item + range.first;
    enum status status = STATUS_OK;
    *vertices = *triangles = 0;
    for (uint32_t i = 0; i < range.count && !status; i++) {
        struct corners corners;
        uint64_t count = 0;
        status = find_corners(gltf, mesh, i, &primitive[i], &corners);
        if (!status)
            status = count_triangles(gltf, mesh, i, &primitive[i], corners.count, &count);
        if (status)
            return status;
        *vertices += gltf->base_of[primitive[i].position] == GLTF_NONE ? corners.vertices : 0;
        gltf->base_of[primitive[i].position] = 0;
        out->geometry[i] =
            (struct geometry){.first = (uint32_t)*triangles, .count = (uint32_t)count};
        *triangles += count;
        gltf->made += 12 * count;
        if (gltf->made + 12 * *vertices > GLTF_TIMES * gltf->given)
            return gltf_fail(gltf,
                             "meshes[%u]: meshes take more than %u bytes for each of the %llu of "
                             "the file and its buffers",
                             mesh, GLTF_TIMES, (unsigned long long)gltf->given);
    }
    gltf->made += 12 * *vertices;
    for (uint32_t i = 0; i < range.count; i++)
        gltf->base_of[primitive[i].position] = GLTF_NONE;
    return STATUS_OK;
}

/* Writes the triangles of a primitive behind `triangle`. */
static enum status copy_triangles(struct gltf *gltf, uint32_t mesh, uint32_t at,
                                  const struct gltf_primitive *primitive, uint32_t count,
                                  uint32_t *triangle)
{
    struct corners corners;
    enum status status = find_corners(gltf, mesh, at, primitive, &corners);
    uint32_t base = status ? 0 : gltf->base_of[primitive->position];
    for (uint64_t i = 0; i < count && !status; i++)
        for (unsigned c = 0; c < 3 && !status; c++) {
            uint32_t vertex;
            status = get_corner(gltf, &corners, corner_of(primitive->mode, i, c), &vertex);
            triangle[3 * i + c] = base + vertex;
        }
    return status;
}

/* Sets what the materials of a mesh say. */
static enum status set_materials(const struct gltf *gltf, uint32_t mesh, struct world_mesh *out,
                                 bool *double_sided)
{
    struct gltf_range range = gltf->mesh.item[mesh];
    *double_sided = range.count > 0;
    for (uint32_t i = 0; i < range.count; i++) {
        uint32_t at = gltf->primitive.item[range.first + i].material;
        struct gltf_material material = {.opaque = true};
        if (at != GLTF_NONE && at >= gltf->material.count)
            return gltf_fail(gltf, "meshes[%u].primitives[%u].material: %u, but there are %zu",
                             mesh, i, at, gltf->material.count);
        if (at != GLTF_NONE)
            material = gltf->material.item[at];
        out->geometry[i].opaque = material.opaque;
        *double_sided = *double_sided && material.double_sided;
    }
    return STATUS_OK;
}

static enum status fill(struct gltf *gltf, uint32_t mesh, struct world_mesh *out)
{
    struct gltf_range range = gltf->mesh.item[mesh];
    const struct gltf_primitive *primitive = gltf->primitive.item + range.first;
    enum status status = STATUS_OK;
    uint32_t next = 0;
    for (uint32_t i = 0; i < range.count && !status; i++) {
        status = copy_positions(gltf, primitive[i].position, out->scene, &next);
        if (!status)
            status = copy_triangles(gltf, mesh, i, &primitive[i], out->geometry[i].count,
                                    out->scene->index + 3 * (size_t)out->geometry[i].first);
    }
    for (uint32_t i = 0; i < range.count && !status; i++)
        gltf->base_of[primitive[i].position] = GLTF_NONE;
    return status;
}

enum status gltf_make_mesh(struct gltf *gltf, uint32_t at, struct world_mesh *out,
                           bool *double_sided)
{
    uint64_t vertices, triangles;
    uint32_t count = gltf->mesh.item[at].count;
    *out = (struct world_mesh){.scene = alloc_zeroed(1, sizeof *out->scene)};
    out->geometry = alloc_zeroed(count ? count : 1, sizeof *out->geometry);
    if (!out->scene || !out->geometry)
        return gltf_no_memory(gltf);
    out->geometry_count = count ? count : 1;
    out->geometry[0].opaque = true;
    enum status status = measure(gltf, at, out, &vertices, &triangles);
    if (!status)
        status = set_materials(gltf, at, out, double_sided);
    if (status)
        return status;
    if (vertices > UINT32_MAX - 1 || triangles > UINT32_MAX - 1)
        return gltf_fail(gltf, "meshes[%u]: more than 4294967294 vertices or triangles", at);
    if (scene_make((uint32_t)vertices, (uint32_t)triangles, out->scene))
        return gltf_no_memory(gltf);
    return fill(gltf, at, out);
}

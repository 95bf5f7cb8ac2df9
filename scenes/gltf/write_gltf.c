#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "scenes/gltf/gltf.h"
#include "ref/base/decimal.h"
#include "scenes/read/world_fields.h"

#include <stdlib.h>
#include <string.h>

/* --- what the format cannot hold -------------------------------------------------------------- */

static enum status check_meshes(const struct world *world, struct reason *reason)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct world_mesh *mesh = &world->mesh[i];
        if (mesh->scene->vertex_count == 0)
            return fail(reason, STATUS_INPUT, "mesh %u: has no vertex, which glTF cannot hold", i);
        for (uint32_t k = 0; k < mesh->geometry_count; k++)
            if (mesh->geometry[k].count == 0)
                return fail(reason, STATUS_INPUT,
                            "mesh %u: geometry %u has no triangle, which glTF cannot hold", i, k);
    }
    return STATUS_OK;
}

/* --- the buffer: the vertices of each mesh, then its indices ---------------------------------- */

static uint64_t vertex_bytes(const struct world_mesh *mesh)
{
    return 12 * (uint64_t)mesh->scene->vertex_count;
}

static uint64_t index_bytes(const struct world_mesh *mesh)
{
    return 12 * (uint64_t)mesh->scene->tri_count;
}

static uint64_t buffer_bytes(const struct world *world)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        bytes += vertex_bytes(&world->mesh[i]) + index_bytes(&world->mesh[i]);
    return bytes;
}

static unsigned char *put_u32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *at++ = (unsigned char)(value >> (8 * i) & 0xFF);
    return at;
}

static void fill_buffer(const struct world *world, unsigned char *at)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct scene *scene = world->mesh[i].scene;
        for (size_t k = 0; k < 3 * (size_t)scene->vertex_count; k++)
            at = put_u32(at, float_bits(scene->vertex[k]));
        for (size_t k = 0; k < 3 * (size_t)scene->tri_count; k++)
            at = put_u32(at, scene->index[k]);
    }
}

/* --- the JSON --------------------------------------------------------------------------------- */

static void put_number(FILE *stream, const char *before, float x)
{
    char text[DECIMAL_TEXT];
    decimal_write_float(x, text);
    fprintf(stream, "%s%s", before, text);
}

/* Each instance is a node and a root of the scene. */
static void put_scene(const struct world *world, FILE *stream)
{
    if (world->instance_count == 0)
        return;
    fputs(",\n \"scene\": 0,\n \"scenes\": [{\"nodes\": [", stream);
    for (uint32_t i = 0; i < world->instance_count; i++)
        fprintf(stream, "%s%u", i == 0 ? "" : i % 16 ? ", " : ",\n  ", i);
    fputs("]}]", stream);
}

/* True if the matrix is the one that is left out, to the bit. */
static bool is_default(const struct instance *instance)
{
    const struct instance plain = instance_default();
    return memcmp(instance->m, plain.m, sizeof plain.m) == 0;
}

static void put_node(const struct instance *instance, FILE *stream)
{
    const char *comma = "";
    fputc('{', stream);
    if (instance->mesh != WORLD_NO_MESH) {
        fprintf(stream, "\"mesh\": %u", instance->mesh);
        comma = ", ";
    }
    if (!is_default(instance)) {
        fprintf(stream, "%s\"matrix\": [", comma);
        for (int i = 0; i < 16; i++)
            put_number(stream, i ? ", " : "",
                       i % 4 < 3 ? instance->m[i % 4][i / 4]
                       : i == 15 ? 1.0f
                                 : 0.0f);
        fputc(']', stream);
        comma = ", ";
    }
    const struct instance plain = instance_default();
    if (instance->mesh == WORLD_NO_MESH || instance->custom != plain.custom ||
        instance->mask != plain.mask || instance->flags != plain.flags) {
        fprintf(stream, "%s\"extras\": {\"raydiff\": {", comma);
        put_instance_members(instance, true, stream);
        fputs("}}", stream);
    }
    fputc('}', stream);
}

static void put_nodes(const struct world *world, FILE *stream)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        fputs(i ? ",\n  " : ",\n \"nodes\": [\n  ", stream);
        put_node(&world->instance[i], stream);
    }
    fputs(world->instance_count ? "]" : "", stream);
}

/* Accessors are numbered mesh by mesh: the positions, then the indices of each geometry. */
static void put_meshes(const struct world *world, FILE *stream)
{
    uint32_t accessor = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct world_mesh *mesh = &world->mesh[i];
        fputs(i ? ",\n  " : ",\n \"meshes\": [\n  ", stream);
        fputs("{\"primitives\": [", stream);
        for (uint32_t k = 0; k < mesh->geometry_count; k++)
            fprintf(stream, "%s{\"attributes\": {\"POSITION\": %u}, \"indices\": %u%s}",
                    k ? ", " : "", accessor, accessor + 1 + k,
                    mesh->geometry[k].opaque ? "" : ", \"material\": 0");
        fputs("]}", stream);
        accessor += 1 + mesh->geometry_count;
    }
    fputs(world->mesh_count ? "]" : "", stream);
}

static void put_material(const struct world *world, FILE *stream)
{
    bool any = false;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        for (uint32_t k = 0; k < world->mesh[i].geometry_count; k++)
            any = any || !world->mesh[i].geometry[k].opaque;
    fputs(any ? ",\n \"materials\": [{\"alphaMode\": \"MASK\"}]" : "", stream);
}

/* The bounds that a reader of glTF expects of positions. */
static void put_bounds(const struct scene *scene, FILE *stream)
{
    struct box box = box_empty();
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        box_add_point(&box, scene->vertex + 3 * (size_t)i);
    for (int k = 0; k < 6; k++)
        put_number(stream,
                   k == 0   ? ", \"min\": ["
                   : k == 3 ? "], \"max\": ["
                            : ", ",
                   k < 3 ? box.lo[k] : box.hi[k - 3]);
    fputs("]", stream);
}

static void put_accessors(const struct world *world, FILE *stream)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct world_mesh *mesh = &world->mesh[i];
        fputs(i ? ",\n  " : ",\n \"accessors\": [\n  ", stream);
        fprintf(stream,
                "{\"bufferView\": %u, \"componentType\": 5126, \"count\": %u, \"type\": \"VEC3\"",
                2 * i, mesh->scene->vertex_count);
        put_bounds(mesh->scene, stream);
        fputc('}', stream);
        for (uint32_t k = 0; k < mesh->geometry_count; k++)
            fprintf(stream,
                    ",\n  {\"bufferView\": %u, \"byteOffset\": %llu, \"componentType\": 5125, "
                    "\"count\": %llu, \"type\": \"SCALAR\"}",
                    2 * i + 1, 12 * (unsigned long long)mesh->geometry[k].first,
                    3 * (unsigned long long)mesh->geometry[k].count);
    }
    fputs(world->mesh_count ? "]" : "", stream);
}

/* View 2 i has the positions of mesh i, view 2 i + 1 its indices. */
static void put_views(const struct world *world, FILE *stream)
{
    unsigned long long offset = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const unsigned long long vertices = vertex_bytes(&world->mesh[i]);
        const unsigned long long indices = index_bytes(&world->mesh[i]);
        fputs(i ? ",\n  " : ",\n \"bufferViews\": [\n  ", stream);
        fprintf(stream,
                "{\"buffer\": 0, \"byteOffset\": %llu, \"byteLength\": %llu, \"target\": 34962},\n"
                "  {\"buffer\": 0, \"byteOffset\": %llu, \"byteLength\": %llu, \"target\": 34963}",
                offset, vertices, offset + vertices, indices);
        offset += vertices + indices;
    }
    fputs(world->mesh_count ? "]" : "", stream);
}

/* The whole JSON; `buffer` is what a data: URI holds, or NULL: the chunk. */
static void put_json(const struct world *world, const unsigned char *buffer, FILE *stream)
{
    const uint64_t bytes = buffer_bytes(world);
    fputs("{\"asset\": {\"version\": \"2.0\", \"generator\": \"raydiff\"}", stream);
    put_scene(world, stream);
    put_nodes(world, stream);
    put_meshes(world, stream);
    put_material(world, stream);
    put_accessors(world, stream);
    put_views(world, stream);
    if (filter_is_told(&world->filter)) {
        fputs(",\n \"extras\": {\"raydiff\": {\"filter\": ", stream);
        put_filter(&world->filter, stream);
        fputs("}}", stream);
    }
    if (bytes)
        fprintf(stream, ",\n \"buffers\": [{\"byteLength\": %llu", (unsigned long long)bytes);
    if (bytes && buffer) {
        fputs(",\n  \"uri\": \"data:application/octet-stream;base64,", stream);
        base64_encode(buffer, (size_t)bytes, stream);
        fputc('"', stream);
    }
    fputs(bytes ? "}]}\n" : "}\n", stream);
}

/* --- files ------------------------------------------------------------------------------------ */

/* Checks the world and makes its buffer, which the caller frees. */
static enum status make_buffer(const struct world *world, unsigned char **out,
                               struct reason *reason)
{
    *out = NULL;
    enum status status = check_meshes(world, reason);
    if (status)
        return status;
    *out = alloc_zeroed((size_t)buffer_bytes(world), 1);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "no memory for a buffer of %llu bytes",
                    (unsigned long long)buffer_bytes(world));
    fill_buffer(world, *out);
    return STATUS_OK;
}

enum status write_gltf(const struct world *world, FILE *stream, struct reason *reason)
{
    unsigned char *buffer;
    enum status status = make_buffer(world, &buffer, reason);
    if (!status)
        put_json(world, buffer, stream);
    free(buffer);
    return status;
}

/* "glTF" and the words that follow: version, length, and those of the first chunk. */
static void put_words(const uint32_t *word, size_t count, FILE *stream)
{
    for (size_t i = 0; i < count; i++) {
        unsigned char bytes[4];
        put_u32(bytes, word[i]);
        fwrite(bytes, 1, sizeof bytes, stream);
    }
}

enum status write_glb(const struct world *world, FILE *stream, struct reason *reason)
{
    char *json = NULL;
    size_t size = 0;
    unsigned char *buffer;
    enum status status = make_buffer(world, &buffer, reason);
    if (status)
        return status;
    FILE *text = open_memstream(&json, &size);
    if (text) {
        put_json(world, NULL, text);
        while (ftell(text) % 4 != 0)
            fputc(' ', text);
    }
    const uint64_t bytes = buffer_bytes(world);
    if (!text || fclose(text) != 0)
        status = fail(reason, STATUS_MEMORY, "no memory for the JSON of a world");
    else if (28 + size + bytes > UINT32_MAX)
        status = fail(reason, STATUS_INPUT, "GLB cannot hold %llu bytes; .gltf can",
                      (unsigned long long)(28 + size + bytes));
    if (!status) {
        const uint32_t chunks = bytes ? 28 : 20;
        put_words((const uint32_t[]){0x46546C67u, 2, (uint32_t)(chunks + size + bytes),
                                     (uint32_t)size, 0x4E4F534Au},
                  5, stream);
        fwrite(json, 1, size, stream);
        if (bytes)
            put_words((const uint32_t[]){(uint32_t)bytes, 0x004E4942u}, 2, stream);
        fwrite(buffer, 1, (size_t)bytes, stream);
    }
    free(json);
    free(buffer);
    return status;
}

#define _GNU_SOURCE /* memmem */
#include "scenes/read/world_fields.h"
#include "scenes/read/world_formats.h"

#include <stdlib.h>
#include <string.h>

/* A mesh while it is read. */
struct mesh_read {
    json_t *spec; /* or NULL */
    float *vertex;
    uint32_t *index;
    size_t vertex_numbers, vertex_capacity, index_count, index_capacity;
    bool has_vertices, has_indices;
    struct geometry *geometry;
    size_t geometry_count, geometry_capacity;
};

/* The file while it is read. */
struct world_read {
    const struct world_files *files;
    struct world *world;
    size_t mesh_capacity, instance_capacity;
    struct mesh_read mesh;
    uint64_t referred; /* triangles of meshes from elsewhere */
};

static enum status no_memory(const struct json_pull *pull)
{
    return fail(pull->walk.reason, STATUS_MEMORY, "%s: no memory", pull->walk.name);
}

/* --- meshes ----------------------------------------------------------------------------------- */

static enum status take_spec(struct json_pull *pull, void *self)
{
    return json_pull_text(pull, &((struct world_read *)self)->mesh.spec);
}

static enum status take_coordinate(struct json_pull *pull, void *self)
{
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    if (array_reserve(&mesh->vertex, &mesh->vertex_capacity, mesh->vertex_numbers + 1,
                      sizeof *mesh->vertex))
        return no_memory(pull);
    return json_pull_float(pull, &mesh->vertex[mesh->vertex_numbers++]);
}

static enum status take_vertices(struct json_pull *pull, void *self)
{
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    mesh->has_vertices = true;
    enum status status = json_pull_array(pull, take_coordinate, self);
    if (!status && (mesh->vertex_numbers % 3 != 0 || mesh->vertex_numbers / 3 > UINT32_MAX - 1))
        status = json_pull_fail(pull, "has %zu numbers, which is no count of vertices times 3",
                                mesh->vertex_numbers);
    return status;
}

static enum status take_corner(struct json_pull *pull, void *self)
{
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    uint64_t index;
    if (array_reserve(&mesh->index, &mesh->index_capacity, mesh->index_count + 1,
                      sizeof *mesh->index))
        return no_memory(pull);
    enum status status = json_pull_whole(pull, UINT32_MAX - 2, &index);
    mesh->index[mesh->index_count++] = (uint32_t)index;
    return status;
}

static enum status take_indices(struct json_pull *pull, void *self)
{
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    mesh->has_indices = true;
    enum status status = json_pull_array(pull, take_corner, self);
    if (!status && (mesh->index_count % 3 != 0 || mesh->index_count / 3 > UINT32_MAX - 1))
        status = json_pull_fail(pull, "has %zu numbers, which is no count of triangles times 3",
                                mesh->index_count);
    return status;
}

static enum status take_count(struct json_pull *pull, void *self)
{
    uint64_t count;
    enum status status = json_pull_whole(pull, UINT32_MAX, &count);
    ((struct geometry *)self)->count = (uint32_t)count;
    return status;
}

static enum status take_opaque(struct json_pull *pull, void *self)
{
    return json_pull_bool(pull, &((struct geometry *)self)->opaque);
}

static enum status take_geometry(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {
        {"count", take_count, true}, {"opaque", take_opaque, false}, {0}};
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    if (array_reserve(&mesh->geometry, &mesh->geometry_capacity, mesh->geometry_count + 1,
                      sizeof *mesh->geometry))
        return no_memory(pull);
    struct geometry *geometry = &mesh->geometry[mesh->geometry_count++];
    *geometry = (struct geometry){.opaque = true};
    return json_pull_object(pull, members, geometry);
}

static enum status take_geometries(struct json_pull *pull, void *self)
{
    struct mesh_read *mesh = &((struct world_read *)self)->mesh;
    enum status status = json_pull_array(pull, take_geometry, self);
    if (!status && mesh->geometry_count == 0)
        status = json_pull_fail(pull, "at least one geometry is needed");
    return status;
}

/* Opens the scene that a mesh is named by. */
static enum status open_spec(struct json_pull *pull, struct world_read *read, struct scene *scene)
{
    struct reason why = {""};
    const char *spec = json_string_value(read->mesh.spec);
    if (read->mesh.has_vertices || read->mesh.has_indices)
        return json_pull_fail(pull, "has a \"scene\", and vertices or indices of its own");
    enum status status = read->files->scene(read->files->user, spec, scene, &why);
    if (status == STATUS_MEMORY)
        return fail(pull->walk.reason, status, "%s: %s", pull->walk.name, why.text);
    if (status)
        return json_pull_fail_at(pull, "scene", JSON_PULL_NONE, why.text);
    read->referred += scene->tri_count;
    if (read->referred <= WORLD_REFERRED_MOST)
        return STATUS_OK;
    scene_free(scene);
    return json_pull_fail(pull, "meshes from elsewhere have %llu triangles by here, over %u",
                          (unsigned long long)read->referred, WORLD_REFERRED_MOST);
}

/* Moves the vertices and triangles that stand in the file. */
static enum status move_arrays(struct json_pull *pull, struct mesh_read *mesh, struct scene *scene)
{
    if (!mesh->has_vertices || !mesh->has_indices)
        return json_pull_fail(pull, "needs a \"scene\", or \"vertices\" and \"indices\"");
    uint32_t vertices = (uint32_t)(mesh->vertex_numbers / 3);
    for (size_t i = 0; i < mesh->index_count; i++)
        if (mesh->index[i] >= vertices)
            return json_pull_fail_at(pull, "indices", i, "names a vertex that does not exist");
    if (scene_make(vertices, (uint32_t)(mesh->index_count / 3), scene))
        return no_memory(pull);
    if (mesh->vertex_numbers)
        memcpy(scene->vertex, mesh->vertex, mesh->vertex_numbers * sizeof *mesh->vertex);
    if (mesh->index_count)
        memcpy(scene->index, mesh->index, mesh->index_count * sizeof *mesh->index);
    return STATUS_OK;
}

/* Gives a mesh its geometries: those of the file, or one of all triangles. */
static enum status set_geometries(struct json_pull *pull, struct mesh_read *from,
                                  struct world_mesh *mesh)
{
    uint64_t next = 0;
    if (from->geometry_count == 0) {
        if (array_reserve(&from->geometry, &from->geometry_capacity, 1, sizeof *from->geometry))
            return no_memory(pull);
        from->geometry[from->geometry_count++] =
            (struct geometry){.count = mesh->scene->tri_count, .opaque = true};
    }
    for (size_t i = 0; i < from->geometry_count && next <= UINT32_MAX; i++) {
        from->geometry[i].first = (uint32_t)next;
        next += from->geometry[i].count;
    }
    if (next != mesh->scene->tri_count) {
        char rule[100];
        snprintf(rule, sizeof rule, "have %llu triangles, but the mesh has %u",
                 (unsigned long long)next, mesh->scene->tri_count);
        return json_pull_fail_at(pull, "geometries", JSON_PULL_NONE, rule);
    }
    mesh->geometry = alloc_copy(from->geometry, from->geometry_count, sizeof *from->geometry);
    mesh->geometry_count = (uint32_t)from->geometry_count;
    return mesh->geometry ? STATUS_OK : no_memory(pull);
}

/* Appends the mesh that was read to the world. */
static enum status add_mesh(struct json_pull *pull, struct world_read *read)
{
    struct world *world = read->world;
    if (array_reserve(&world->mesh, &read->mesh_capacity, (size_t)world->mesh_count + 1,
                      sizeof *world->mesh))
        return no_memory(pull);
    struct world_mesh *mesh = &world->mesh[world->mesh_count++];
    *mesh = (struct world_mesh){.scene = alloc_zeroed(1, sizeof *mesh->scene)};
    if (!mesh->scene)
        return no_memory(pull);
    enum status status = read->mesh.spec ? open_spec(pull, read, mesh->scene)
                                         : move_arrays(pull, &read->mesh, mesh->scene);
    return status ? status : set_geometries(pull, &read->mesh, mesh);
}

static void free_mesh(struct mesh_read *mesh)
{
    json_decref(mesh->spec);
    free(mesh->vertex);
    free(mesh->index);
    free(mesh->geometry);
    *mesh = (struct mesh_read){0};
}

static enum status take_mesh(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"scene", take_spec, false},
                                                 {"vertices", take_vertices, false},
                                                 {"indices", take_indices, false},
                                                 {"geometries", take_geometries, false},
                                                 {0}};
    struct world_read *read = self;
    enum status status = json_pull_object(pull, members, read);
    if (!status)
        status = add_mesh(pull, read);
    free_mesh(&read->mesh);
    return status;
}

static enum status take_meshes(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_mesh, self);
}

/* --- instances -------------------------------------------------------------------------------- */

static enum status take_mesh_index(struct json_pull *pull, void *self)
{
    struct instance *instance = self;
    bool none;
    uint64_t mesh = WORLD_NO_MESH;
    enum status status = json_pull_null(pull, &none);
    if (!status && !none)
        status = json_pull_whole(pull, WORLD_NO_MESH - 1, &mesh);
    instance->mesh = (uint32_t)mesh;
    return status;
}

static enum status take_cell(struct json_pull *pull, void *self)
{
    struct instance *instance = self;
    size_t i = json_pull_index(pull);
    if (i >= 12)
        return json_pull_fail(pull, "is one more than 12 numbers");
    return json_pull_float(pull, &instance->m[i / 4][i % 4]);
}

/* The elements that are not given keep a value that no transform has. */
static enum status take_transform(struct json_pull *pull, void *self)
{
    struct instance *instance = self;
    for (int i = 0; i < 12; i++)
        instance->m[i / 4][i % 4] = float_from_bits(0x7FC00000u);
    enum status status = json_pull_array(pull, take_cell, instance);
    if (!status && !float_is_finite(instance->m[2][3]))
        status = json_pull_fail(pull, "must be 12 numbers, row by row");
    return status;
}

static enum status take_instance(struct json_pull *pull, void *self)
{
    static const struct json_member members[] = {{"mesh", take_mesh_index, true},
                                                 {"transform", take_transform, false},
                                                 INSTANCE_MEMBERS,
                                                 {0}};
    struct world_read *read = self;
    struct world *world = read->world;
    if (world->instance_count == UINT32_MAX - 1)
        return json_pull_fail(pull, "is one more than 4294967294");
    if (array_reserve(&world->instance, &read->instance_capacity, (size_t)world->instance_count + 1,
                      sizeof *world->instance))
        return no_memory(pull);
    world->instance[world->instance_count] = instance_default();
    return json_pull_object(pull, members, &world->instance[world->instance_count++]);
}

static enum status take_instances(struct json_pull *pull, void *self)
{
    return json_pull_array(pull, take_instance, self);
}

/* --- the file --------------------------------------------------------------------------------- */

static enum status take_version(struct json_pull *pull, void *self)
{
    (void)self;
    uint64_t version;
    enum status status = json_pull_whole(pull, UINT32_MAX, &version);
    if (!status && version != 1)
        status = json_pull_fail(pull, "is %llu; this version reads 1", (unsigned long long)version);
    return status;
}

static enum status take_world_filter(struct json_pull *pull, void *self)
{
    return take_filter(pull, &((struct world_read *)self)->world->filter);
}

enum status read_world(const char *name, const char *bytes, size_t size,
                       const struct world_files *files, struct world *out, struct reason *reason)
{
    static const struct json_member members[] = {{"raydiff_world", take_version, true},
                                                 {"meshes", take_meshes, true},
                                                 {"instances", take_instances, true},
                                                 {"filter", take_world_filter, false},
                                                 {0}};
    *out = (struct world){0};
    struct world_read read = {.files = files, .world = out};
    struct json_pull pull = json_pull_make(name, bytes, size, reason);
    struct reason why = {""};
    pull.closed = true;
    enum status status = json_pull_file(&pull, members, &read);
    free_mesh(&read.mesh);
    if (!status && (status = world_finish(out, &why)) != STATUS_OK)
        status =
            fail(reason, status == STATUS_LIMIT ? STATUS_INPUT : status, "%s: %s", name, why.text);
    if (status)
        world_free(out);
    return status;
}

/* The byte behind the text that begins at `at`, a quotation mark. */
static const char *skip_text(const char *at, const char *end)
{
    for (at++; at < end && *at != '"'; at++)
        if (*at == '\\' && at + 1 < end)
            at++;
    return at < end ? at + 1 : end;
}

/* True if the next byte that is no white space is a colon. */
static bool is_key(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || *at == '\n' || *at == '\t' || *at == '\r'))
        at++;
    return at < end && *at == ':';
}

bool is_world(const char *bytes, size_t size)
{
    static const char key[] = "\"raydiff_world\"";
    const size_t length = sizeof key - 1;
    const char *end = bytes + size, *next;
    size_t depth = 0;
    if (!memmem(bytes, size, key, length))
        return false;
    for (const char *at = bytes; at < end; at = next) {
        next = *at == '"' ? skip_text(at, end) : at + 1;
        if (*at == '{' || *at == '[')
            depth++;
        else if (*at == '}' || *at == ']')
            depth--;
        else if (depth == 1 && (size_t)(next - at) == length && memcmp(at, key, length) == 0 &&
                 is_key(next, end))
            return true;
    }
    return false;
}

#include "gpu/engines/rayquery_build.h"

#include "gpu/accel/accel_input.h"

#include <stdlib.h>
#include <string.h>

/* The meshes of a world as the device is given them; owns the buffers. */
struct meshes {
    struct vk_accel_mesh *mesh;
    struct vk_accel_geometry *geometry; /* of all meshes, in order */
    struct vk_accel_form *form;         /* of each geometry, if the variant has forms */
    struct vk_accel_instance *instance, *before;
    uint32_t count;
};

/* --- what an update finds --------------------------------------------------------------------- */

void rayquery_forget(struct rayquery_past *past)
{
    for (uint32_t i = 0; i < past->mesh_count && past->vertex; i++)
        free(past->vertex[i]);
    free(past->vertex);
    free(past->instance);
    *past = (struct rayquery_past){.vertex = NULL};
}

enum status rayquery_keep(const struct world *world, struct rayquery_past *past,
                          struct reason *reason)
{
    rayquery_forget(past);
    past->mesh_count = world->mesh_count;
    past->instance_count = world->instance_count;
    past->vertex = alloc_zeroed(world->mesh_count, sizeof *past->vertex);
    past->instance = alloc_copy(world->instance, world->instance_count, sizeof *past->instance);
    bool room = past->vertex && (past->instance || !world->instance);
    for (uint32_t i = 0; i < world->mesh_count && room; i++) {
        const struct scene *scene = world->mesh[i].scene;
        if (scene->vertex_count == 0)
            continue;
        past->vertex[i] = alloc_copy(scene->vertex, 3 * (size_t)scene->vertex_count, sizeof(float));
        room = past->vertex[i] != NULL;
    }
    if (room)
        return STATUS_OK;
    rayquery_forget(past);
    return fail(reason, STATUS_MEMORY, "vulkan: no memory for what %u instances were",
                world->instance_count);
}

/* --- structures ------------------------------------------------------------------------------- */

bool rayquery_is_plain(const struct accel_variant *variant)
{
    const struct vk_accel_how *how = &variant->how;
    return !accel_has_form(variant) && !how->fast_trace && !how->fast_build && !how->low_memory &&
           !how->allow_update && !how->allow_compaction && !how->update && !how->copy &&
           !how->where;
}

static void free_meshes(struct vk *vk, struct meshes *meshes)
{
    for (uint32_t i = 0; i < meshes->count; i++) {
        vk_buffer_free(vk, meshes->mesh[i].vertices);
        vk_buffer_free(vk, meshes->mesh[i].indices);
        vk_buffer_free(vk, meshes->mesh[i].before);
        vk_buffer_free(vk, meshes->mesh[i].transforms);
    }
    free(meshes->mesh);
    free(meshes->geometry);
    free(meshes->form);
    free(meshes->instance);
    free(meshes->before);
}

static enum status make_room(const struct world *world, struct meshes *out, struct reason *reason)
{
    uint64_t geometries = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        geometries += world->mesh[i].geometry_count;
    out->mesh = alloc_zeroed(world->mesh_count, sizeof *out->mesh);
    out->geometry = alloc_zeroed(geometries, sizeof *out->geometry);
    out->form = alloc_zeroed(geometries, sizeof *out->form);
    out->instance = alloc_zeroed(world->instance_count, sizeof *out->instance);
    out->before = alloc_zeroed(world->instance_count, sizeof *out->before);
    if (!out->mesh || !out->geometry || !out->form || !out->instance || !out->before)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances",
                    world->instance_count);
    out->count = world->mesh_count;
    return STATUS_OK;
}

/* A mesh as it is: three floats a vertex, its own indices. */
static enum status upload_plain(struct vk *vk, const struct scene *scene, struct vk_accel_mesh *to,
                                struct reason *reason)
{
    enum status status =
        vk_buffer_make_of(vk, scene->vertex, 12ull * scene->vertex_count, &to->vertices, reason);
    if (!status)
        status =
            vk_buffer_make_of(vk, scene->index, 12ull * scene->tri_count, &to->indices, reason);
    return status;
}

/* A mesh in the form of the variant. */
static enum status upload_form(struct vk *vk, const struct world_mesh *from, const float *earlier,
                               const struct accel_variant *variant, struct vk_accel_mesh *to,
                               struct vk_accel_geometry *geometry, struct vk_accel_form *form,
                               struct reason *reason)
{
    const uint32_t count = from->geometry_count;
    struct accel_input input = {.part_count = 0};
    struct accel_part *part = alloc_zeroed(count, sizeof *part);
    if (!part)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u geometries", count);
    for (uint32_t g = 0; g < count; g++)
        part[g] = (struct accel_part){from->geometry[g].first, from->geometry[g].count};
    enum status status =
        accel_input_make(from->scene, earlier, part, count, variant, &input, reason);
    for (uint32_t g = 0; g < count && !status; g++) {
        form[g] = input.form[g];
        geometry[g].form = &form[g];
        geometry[g].count = input.count[g];
    }
    if (!status)
        status = vk_buffer_make_of(vk, input.vertices, input.vertex_bytes, &to->vertices, reason);
    if (!status)
        status = vk_buffer_make_of(vk, input.before, input.vertex_bytes, &to->before, reason);
    if (!status)
        status = vk_buffer_make_of(vk, input.indices, input.index_bytes, &to->indices, reason);
    if (!status && input.transform_bytes)
        status =
            vk_buffer_make_of(vk, input.transforms, input.transform_bytes, &to->transforms, reason);
    accel_input_free(&input);
    free(part);
    return status;
}

static enum status upload_meshes(struct vk *vk, const struct world *world,
                                 const struct rayquery_past *past,
                                 const struct accel_variant *variant, struct meshes *out,
                                 struct reason *reason)
{
    /* Vertices before an update are made with the form, too. */
    const bool forms = accel_has_form(variant) || variant->how.update != VK_ACCEL_UPDATE_NONE;
    enum status status = make_room(world, out, reason);
    uint32_t next = 0;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        const struct world_mesh *from = &world->mesh[i];
        struct vk_accel_mesh *to = &out->mesh[i];
        to->vertex_count = from->scene->vertex_count;
        to->geometry = out->geometry + next;
        to->geometry_count = from->geometry_count;
        for (uint32_t g = 0; g < from->geometry_count; g++)
            out->geometry[next + g] = (struct vk_accel_geometry){
                from->geometry[g].first, from->geometry[g].count, from->geometry[g].opaque, NULL};
        status = forms ? upload_form(vk, from, past ? past->vertex[i] : NULL, variant, to,
                                     out->geometry + next, out->form + next, reason)
                       : upload_plain(vk, from->scene, to, reason);
        next += from->geometry_count;
    }
    return status;
}

_Static_assert(VK_ACCEL_NO_MESH == WORLD_NO_MESH, "a null reference");

static struct vk_accel_instance instance_of(const struct instance *from)
{
    struct vk_accel_instance to = {
        .mesh = from->mesh, .custom = from->custom, .mask = from->mask, .flags = from->flags};
    memcpy(to.transform, from->m, sizeof from->m);
    return to;
}

static enum status build_world(struct vk *vk, const struct world *world,
                               const struct rayquery_past *past,
                               const struct accel_variant *variant, struct vk_accel **out,
                               struct reason *reason)
{
    struct meshes meshes = {0};
    enum status status = upload_meshes(vk, world, past, variant, &meshes, reason);
    for (uint32_t i = 0; i < world->instance_count && !status; i++) {
        meshes.instance[i] = instance_of(&world->instance[i]);
        if (past)
            meshes.before[i] = instance_of(&past->instance[i]);
    }
    const struct vk_accel_world built = {.mesh = meshes.mesh,
                                         .instance = meshes.instance,
                                         .mesh_count = world->mesh_count,
                                         .instance_count = world->instance_count,
                                         .before = past ? meshes.before : NULL,
                                         .how = &variant->how};
    if (!status)
        status = vk_accel_make_world(vk, &built, out, reason);
    free_meshes(vk, &meshes);
    return status;
}

/* The structures through bytes: built on a device, freed, and read on `vk`. */
static enum status build_and_serialise(struct vk *vk, struct vk *on, const struct world *world,
                                       const struct rayquery_past *past,
                                       const struct accel_variant *variant, struct vk_accel **out,
                                       struct vk_accel_bytes **bytes, struct reason *reason)
{
    struct vk_accel *built = NULL;
    enum status status = build_world(on, world, past, variant, &built, reason);
    if (!status)
        status = vk_accel_save(on, built, bytes, reason);
    vk_accel_free(on, built);
    if (on == vk)
        return status ? status : vk_accel_load(vk, *bytes, out, reason);
    struct reason message = {""};
    if (vk_close(on, &message) && !status)
        status = fail(reason, STATUS_DEVICE, "vulkan: %s", message.text);
    return status ? status : vk_accel_load(vk, *bytes, out, reason);
}

enum status rayquery_build(struct vk *vk, const struct vk_options *options,
                           const struct world *world, const struct rayquery_past *past,
                           const struct accel_variant *variant, struct vk_accel **out,
                           struct reason *reason)
{
    struct vk_accel_bytes *bytes = NULL;
    struct vk *on = vk;
    *out = NULL;
    if (variant->how.copy != VK_ACCEL_COPY_SERIALISE &&
        variant->how.copy != VK_ACCEL_COPY_SERIALISE_NEW)
        return build_world(vk, world, past, variant, out, reason);
    enum status status = STATUS_OK;
    if (variant->how.copy == VK_ACCEL_COPY_SERIALISE_NEW)
        status = vk_open(options, &on, reason);
    if (!status)
        status = build_and_serialise(vk, on, world, past, variant, out, &bytes, reason);
    vk_accel_bytes_free(bytes);
    return status;
}

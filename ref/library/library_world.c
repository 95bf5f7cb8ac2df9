/* The public library: worlds. */
#include "ref/library/library.h"

#include <stdlib.h>
#include <string.h>

enum status library_masks(const struct raydiff_oracle *oracle, const uint32_t *mask, size_t count,
                          struct reason *reason)
{
    struct reason why = {""};
    if (mask && !oracle->is_world)
        return fail(reason, STATUS_INPUT, "masks: there are no instances to meet");
    for (size_t i = 0; mask && i < count; i++)
        if (ray_mode_check(library_mode(mask, i), &why))
            return fail(reason, STATUS_INPUT, "ray %zu: %s", i, why.text);
    return STATUS_OK;
}

static enum status copy_mesh(const struct raydiff_mesh *from, uint32_t i, struct world_mesh *out,
                             struct reason *reason)
{
    const struct raydiff_case what = {from->vertex, from->index, from->vertex_count,
                                      from->triangle_count, NULL};
    struct reason why = {""};
    out->scene = alloc_zeroed(1, sizeof *out->scene);
    out->geometry = alloc_zeroed(1, sizeof *out->geometry);
    if (!out->scene || !out->geometry)
        return fail(reason, STATUS_MEMORY, "no memory for a world");
    enum status status = library_scene(&what, out->scene, &why);
    if (status)
        return fail(reason, status, "mesh %u: %s", i, why.text);
    out->geometry[0] = (struct geometry){.count = from->triangle_count, .opaque = true};
    out->geometry_count = 1;
    return STATUS_OK;
}

static enum status copy_world(const struct raydiff_mesh *mesh, uint32_t mesh_count,
                              const struct raydiff_instance *instance, uint32_t instance_count,
                              struct world *out, struct reason *reason)
{
    enum status status = mesh_count ? library_given(mesh, "meshes", reason) : STATUS_OK;
    if (!status && instance_count)
        status = library_given(instance, "instances", reason);
    if (status)
        return status;
    out->mesh = alloc_zeroed(mesh_count, sizeof *out->mesh);
    out->instance = alloc_zeroed(instance_count, sizeof *out->instance);
    if (!out->mesh || !out->instance)
        return fail(reason, STATUS_MEMORY, "no memory for a world");
    out->mesh_count = mesh_count;
    out->instance_count = instance_count;
    for (uint32_t i = 0; i < mesh_count && !status; i++)
        status = copy_mesh(&mesh[i], i, &out->mesh[i], reason);
    for (uint32_t i = 0; i < instance_count && !status; i++) {
        struct instance *to = &out->instance[i];
        memcpy(to->m, instance[i].transform, sizeof to->m);
        to->mesh = instance[i].mesh;
        to->mask = instance[i].mask;
        if (to->mesh == WORLD_NO_MESH) /* worlds have such instances, the interface has not */
            status = fail(reason, STATUS_INPUT, "instance %u: mesh %u, but the world has %u", i,
                          to->mesh, mesh_count);
    }
    return status ? status : world_finish(out, reason);
}

enum raydiff_error raydiff_oracle_make_world(const struct raydiff_mesh *mesh, uint32_t mesh_count,
                                             const struct raydiff_instance *instance,
                                             uint32_t instance_count, struct raydiff_oracle **out,
                                             struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    enum status status = library_given(out, "out", &reason);
    if (status)
        return library_end(modes, status, &reason, why);
    *out = NULL;
    struct raydiff_oracle *oracle = alloc_zeroed(1, sizeof *oracle);
    if (!oracle)
        return library_end(modes, fail(&reason, STATUS_MEMORY, "no memory for an oracle"), &reason,
                           why);
    oracle->is_world = true;
    status = copy_world(mesh, mesh_count, instance, instance_count, &oracle->world, &reason);
    if (!status)
        status = oracle_make_world(&oracle->world, &oracle->oracle, &reason);
    if (status)
        raydiff_oracle_free(oracle);
    else
        *out = oracle;
    return library_end(modes, status, &reason, why);
}

enum raydiff_error raydiff_placed(const struct raydiff_oracle *oracle, uint32_t number,
                                  uint32_t *instance, uint32_t *triangle, struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct place place = {.prim = number};
    enum status status = library_given(instance && triangle ? oracle : NULL, "argument", &reason);
    if (!status && number >= library_triangles(oracle))
        status = fail(&reason, STATUS_INPUT, "triangle %u: there are %u", number,
                      library_triangles(oracle));
    if (!status && oracle->is_world)
        place = world_place(&oracle->world, number);
    if (instance)
        *instance = status ? 0 : place.instance;
    if (triangle)
        *triangle = status ? 0 : place.prim;
    return library_end(modes, status, &reason, why);
}

uint32_t raydiff_first_of(const struct raydiff_oracle *oracle, uint32_t instance)
{
    const uint32_t instances = oracle && oracle->is_world ? oracle->world.instance_count : 1;
    if (!oracle || instance > instances)
        return RAYDIFF_NOTHING;
    if (instance == instances)
        return library_triangles(oracle);
    return oracle->is_world ? oracle->world.first[instance] : 0;
}

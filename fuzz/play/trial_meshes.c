/* A trial's world as engines take it, and what no reader may let through. */
#include "fuzz/play/trial_world.h"

#include <stdlib.h>
#include <string.h>

/* Copies the triangles of a mesh with the vertices that they name. `to` has room for a number of
 * each vertex of the scene. */
static enum status take_mesh(const struct scene *scene, uint32_t first, uint32_t count,
                             uint32_t *to, struct scene *out)
{
    const uint32_t *corner = scene->index + 3 * (size_t)first;
    uint32_t used = 0;
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        to[corner[i]] = 1;
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        used += to[i];
    enum status status = scene_make(used, count, out);
    used = 0;
    for (uint32_t i = 0; i < scene->vertex_count && !status; i++)
        if (to[i]) {
            memcpy(out->vertex + 3 * (size_t)used, scene->vertex + 3 * (size_t)i, 12);
            to[i] = used++;
        }
    for (size_t i = 0; i < 3 * (size_t)count && !status; i++)
        out->index[i] = to[corner[i]];
    memset(to, 0, sizeof *to * scene->vertex_count);
    return status;
}

/* The same, borrowed: with all vertices of the scene. */
static void lend_mesh(const struct scene *scene, uint32_t first, uint32_t count, struct scene *out)
{
    *out = (struct scene){.vertex = scene->vertex,
                          .vertex_count = scene->vertex_count,
                          .index = scene->index + 3 * (size_t)first,
                          .tri_count = count};
}

static void number_geometries(const struct trial_world *world, struct trial_meshes *out)
{
    struct geometry *to = out->world.mesh ? out->world.mesh[0].geometry : NULL;
    uint32_t next = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++) {
        const struct trial_geometry *one = &world->geometry[i];
        struct world_mesh *mesh = &out->world.mesh[one->mesh];
        if (i == 0 || world->geometry[i - 1].mesh != one->mesh)
            *mesh = (struct world_mesh){&out->scene[one->mesh], &to[i], 0}, next = 0;
        to[i] = (struct geometry){next, one->count, one->opaque};
        next += one->count;
        mesh->geometry_count++;
    }
}

/* `lent`: the scenes and the instances are borrowed (free_lent). */
static enum status make(const struct trial_world *world, const struct scene *scene, bool lent,
                        struct trial_meshes *out, struct reason *reason)
{
    uint32_t meshes = trial_world_meshes(world);
    uint32_t *to = lent ? NULL : alloc_zeroed(scene->vertex_count, sizeof *to);
    *out = (struct trial_meshes){.world = {.mesh = alloc_zeroed(meshes, sizeof *out->world.mesh),
                                           .instance_count = world->instance_count,
                                           .mesh_count = meshes,
                                           .filter = world->filter,
                                           .borrows = true},
                                 .scene = alloc_zeroed(meshes, sizeof *out->scene)};
    struct geometry *geometry =
        meshes && out->world.mesh ? alloc_zeroed(world->geometry_count, sizeof *geometry) : NULL;
    if (geometry)
        out->world.mesh[0].geometry = geometry;
    out->world.instance =
        lent ? world->instance : alloc_zeroed(world->instance_count, sizeof *out->world.instance);
    bool room = out->world.mesh && out->scene && (geometry || !meshes) && out->world.instance &&
                (to || lent);
    for (uint32_t i = 0, first, count; i < meshes && room; i++) {
        trial_world_mesh(world, i, &first, &count);
        if (lent)
            lend_mesh(scene, first, count, &out->scene[i]);
        else
            room = take_mesh(scene, first, count, to, &out->scene[i]) == STATUS_OK;
    }
    free(to);
    if (!room)
        return fail(reason, STATUS_MEMORY, "no memory for a world of %u instances",
                    world->instance_count);
    if (!lent && world->instance_count > 0)
        memcpy(out->world.instance, world->instance,
               sizeof *world->instance * world->instance_count);
    number_geometries(world, out);
    return world_finish(&out->world, reason);
}

/* Frees all but what was lent. Geometries are one array, which the first mesh has. */
static void free_lent(struct trial_meshes *meshes)
{
    struct world *world = &meshes->world;
    if (world->mesh && world->mesh_count)
        free(world->mesh[0].geometry);
    free(world->mesh);
    free(world->first);
    free(meshes->scene);
    *meshes = (struct trial_meshes){0};
}

enum status trial_meshes_make(const struct trial_world *world, const struct scene *scene,
                              struct trial_meshes *out, struct reason *reason)
{
    enum status status = make(world, scene, false, out, reason);
    if (status)
        trial_meshes_free(out);
    return status;
}

void trial_meshes_free(struct trial_meshes *meshes)
{
    for (uint32_t i = 0; i < meshes->world.mesh_count && meshes->scene; i++)
        scene_free(&meshes->scene[i]);
    free(meshes->world.instance);
    free_lent(meshes);
}

/* --- checking --------------------------------------------------------------------------------- */

static enum status check_geometries(const struct trial_world *world, const struct scene *scene,
                                    struct reason *reason)
{
    uint64_t sum = 0;
    uint32_t next = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++) {
        const struct trial_geometry *one = &world->geometry[i];
        if (one->mesh != next && !(i > 0 && one->mesh + 1 == next))
            return fail(reason, STATUS_INPUT,
                        "geometry %u is of mesh %u: meshes are numbered from 0, in order", i,
                        one->mesh);
        next = one->mesh + 1;
        sum += one->count;
    }
    if (sum != scene->tri_count)
        return fail(reason, STATUS_INPUT, "its geometries have %llu triangles, the trial has %u",
                    (unsigned long long)sum, scene->tri_count);
    return STATUS_OK;
}

enum status trial_world_check(const struct trial_world *world, const struct scene *scene,
                              uint32_t rays, struct reason *reason)
{
    struct trial_meshes lent;
    if (world->geometry_count > FUZZ_GEOMETRIES_MOST || world->instance_count > FUZZ_INSTANCES_MOST)
        return fail(reason, STATUS_LIMIT, "a trial has at most %u geometries and %u instances",
                    FUZZ_GEOMETRIES_MOST, FUZZ_INSTANCES_MOST);
    enum status status = check_geometries(world, scene, reason);
    if (status)
        return status;
    status = make(world, scene, true, &lent, reason);
    uint32_t placed = status ? 0 : world_tri_count(&lent.world);
    free_lent(&lent);
    if (!status && placed > FUZZ_PLACED_MOST)
        status = fail(reason, STATUS_LIMIT, "a trial has at most %u placed triangles, not %u",
                      FUZZ_PLACED_MOST, placed);
    for (uint32_t i = 0; i < rays && !status; i++) {
        struct reason why;
        status = ray_mode_check(world->mode[i], &why);
        if (status)
            (void)fail(reason, status, "ray %u: %.200s", i, why.text);
    }
    return status;
}

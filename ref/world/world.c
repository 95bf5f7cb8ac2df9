#include "ref/world/world.h"

#include "ref/integers/oracle_grid.h"

#include <stdlib.h>
#include <string.h>

enum status world_of_scene(const struct scene *scene, struct world *out, struct reason *reason)
{
    *out = (struct world){.mesh_count = 1, .instance_count = 1, .borrows = true};
    out->mesh = alloc_zeroed(1, sizeof *out->mesh);
    out->instance = alloc_zeroed(1, sizeof *out->instance);
    struct geometry *geometry = alloc_zeroed(1, sizeof *geometry);
    if (!out->mesh || !out->instance || !geometry) {
        free(geometry);
        world_free(out);
        return fail(reason, STATUS_MEMORY, "no memory for a world");
    }
    *geometry = (struct geometry){.count = scene->tri_count, .opaque = true};
    /* Only scenes of worlds that own them are changed or freed. */
    out->mesh[0] = (struct world_mesh){(struct scene *)scene, geometry, 1};
    out->instance[0] =
        (struct instance){.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF};
    enum status status = world_finish(out, reason);
    if (status)
        world_free(out);
    return status;
}

void world_free(struct world *world)
{
    for (uint32_t i = 0; i < world->mesh_count && world->mesh; i++) {
        if (!world->borrows && world->mesh[i].scene) {
            scene_free(world->mesh[i].scene);
            free(world->mesh[i].scene);
        }
        free(world->mesh[i].geometry);
    }
    free(world->mesh);
    free(world->instance);
    free(world->first);
    *world = (struct world){0};
}

/* --- rules ------------------------------------------------------------------------------------ */

static enum status check_mesh(const struct world_mesh *mesh, uint32_t at, struct reason *reason)
{
    struct reason why = {""};
    uint32_t next = 0;
    enum status status = scene_check(mesh->scene, &why);
    if (status)
        return fail(reason, status, "mesh %u: %s", at, why.text);
    if (mesh->geometry_count == 0)
        return fail(reason, STATUS_INPUT, "mesh %u: at least one geometry is needed", at);
    for (uint32_t i = 0; i < mesh->geometry_count; i++) {
        const struct geometry *geometry = &mesh->geometry[i];
        if (geometry->first != next || geometry->count > mesh->scene->tri_count - next)
            return fail(reason, STATUS_INPUT,
                        "mesh %u: geometry %u has triangles from %u on, %u of them: geometries "
                        "cover the mesh's %u in order, each once",
                        at, i, geometry->first, geometry->count, mesh->scene->tri_count);
        next += geometry->count;
    }
    if (next != mesh->scene->tri_count)
        return fail(reason, STATUS_INPUT, "mesh %u: its geometries cover %u of %u triangles", at,
                    next, mesh->scene->tri_count);
    return STATUS_OK;
}

/* The product of three numbers on the grid, added to `sum` or taken from it. */
static void add_term(const struct oracle_wide *a, const struct oracle_wide *b,
                     const struct oracle_wide *c, bool minus, struct oracle_wide *sum)
{
    struct oracle_wide two, three;
    wide_mul(a, b, &two);
    wide_mul(&two, c, &three);
    if (minus)
        wide_sub(sum, &three, sum);
    else
        wide_add(sum, &three, sum);
}

int instance_det_sign(const float m[3][4])
{
    struct odd odd[9];
    struct oracle_wide x[3][3], det;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            odd[3 * i + j] = odd_of(m[i][j]);
    struct oracle_grid grid = grid_of(odd, 9);
    for (int i = 0; i < 9; i++)
        grid_wide(grid, odd[i], &x[i / 3][i % 3]);
    wide_set(0, &det);
    for (int j = 0; j < 3; j++) {
        int k = (j + 1) % 3, l = (j + 2) % 3;
        add_term(&x[0][j], &x[1][k], &x[2][l], false, &det);
        add_term(&x[0][j], &x[1][l], &x[2][k], true, &det);
    }
    return det.sign;
}

static enum status check_transform(const struct instance *instance, uint32_t at,
                                   struct reason *reason)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!float_is_finite(instance->m[i][j]))
                return fail(reason, STATUS_INPUT,
                            "instance %u: row %d, column %d of its transform is not finite", at, i,
                            j);
    if (instance_det_sign(instance->m) == 0)
        return fail(reason, STATUS_INPUT,
                    "instance %u: its transform is singular: the determinant is exactly 0", at);
    return STATUS_OK;
}

enum status world_check_instance(const struct world *world, uint32_t at, struct reason *reason)
{
    const struct instance *instance = &world->instance[at];
    const uint32_t both = ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE;
    if (instance->mesh != WORLD_NO_MESH && instance->mesh >= world->mesh_count)
        return fail(reason, STATUS_INPUT, "instance %u: mesh %u, but the world has %u", at,
                    instance->mesh, world->mesh_count);
    if (instance->custom > ABI_CUSTOM_MOST)
        return fail(reason, STATUS_INPUT, "instance %u: custom index %u is over %u (24 bits)", at,
                    instance->custom, ABI_CUSTOM_MOST);
    if (instance->mask > 0xFF)
        return fail(reason, STATUS_INPUT, "instance %u: mask %u is over 255 (8 bits)", at,
                    instance->mask);
    if (instance->flags & ~ABI_INSTANCE_FLAGS)
        return fail(reason, STATUS_INPUT, "instance %u: flags 0x%X are unknown", at,
                    instance->flags & ~ABI_INSTANCE_FLAGS);
    if ((instance->flags & both) == both)
        return fail(reason, STATUS_INPUT,
                    "instance %u: it is forced to be opaque and not to be opaque: one of the two",
                    at);
    return check_transform(instance, at, reason);
}

static enum status check_filter(const struct filter_rule *filter, struct reason *reason)
{
    if (filter->kind > FILTER_CELLS)
        return fail(reason, STATUS_INPUT, "filter: kind %u is unknown", (unsigned)filter->kind);
    if (filter->share > 256)
        return fail(reason, STATUS_INPUT, "filter: a share of %u of 256 is over 256",
                    filter->share);
    return STATUS_OK;
}

static enum status number_triangles(struct world *world, struct reason *reason)
{
    uint64_t next = 0;
    free(world->first);
    world->first = alloc_zeroed((size_t)world->instance_count + 1, sizeof *world->first);
    if (!world->first)
        return fail(reason, STATUS_MEMORY, "no memory for %u instances", world->instance_count);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct scene *scene = world_scene(world, i);
        next += scene ? scene->tri_count : 0;
        if (next > UINT32_MAX - 1)
            return fail(reason, STATUS_LIMIT,
                        "instance %u: the world has %llu placed triangles by then, over 2^32 - 2",
                        i, (unsigned long long)next);
        world->first[i + 1] = (uint32_t)next;
    }
    return STATUS_OK;
}

enum status world_finish(struct world *world, struct reason *reason)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        enum status status = check_mesh(&world->mesh[i], i, reason);
        if (status)
            return status;
    }
    for (uint32_t i = 0; i < world->instance_count; i++) {
        enum status status = world_check_instance(world, i, reason);
        if (status)
            return status;
    }
    enum status status = check_filter(&world->filter, reason);
    return status ? status : number_triangles(world, reason);
}

enum status ray_mode_check(struct ray_mode mode, struct reason *reason)
{
    uint32_t opacity = mode.flags & (ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE | ABI_RAY_CULL_OPAQUE |
                                     ABI_RAY_CULL_NO_OPAQUE);
    uint32_t facing =
        mode.flags & (ABI_RAY_SKIP_TRIANGLES | ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT);
    if (mode.mask > 0xFF)
        return fail(reason, STATUS_INPUT, "ray mask %u is over 255 (8 bits)", mode.mask);
    if (mode.flags & ~ABI_RAY_FLAGS)
        return fail(reason, STATUS_INPUT, "ray flags 0x%X are unknown",
                    mode.flags & ~ABI_RAY_FLAGS);
    if (opacity & (opacity - 1))
        return fail(reason, STATUS_INPUT,
                    "ray flags 0x%X: at most one of opaque, no opaque, cull opaque, cull no opaque",
                    mode.flags);
    if (facing & (facing - 1))
        return fail(reason, STATUS_INPUT,
                    "ray flags 0x%X: at most one of cull back, cull front, skip triangles",
                    mode.flags);
    return STATUS_OK;
}

/* --- places ----------------------------------------------------------------------------------- */

uint32_t world_instance_of(const struct world *world, uint32_t prim)
{
    /* The last that begins at or before it: those before it of the same number are empty. */
    uint32_t from = 0, to = world->instance_count;
    while (to - from > 1) {
        uint32_t middle = from + (to - from) / 2;
        if (world->first[middle] <= prim)
            from = middle;
        else
            to = middle;
    }
    return from;
}

struct place world_place(const struct world *world, uint32_t prim)
{
    uint32_t instance = world_instance_of(world, prim);
    return world_place_in(world, instance, prim - world->first[instance]);
}

struct place world_place_in(const struct world *world, uint32_t instance, uint32_t prim)
{
    struct place place = {
        .instance = instance, .mesh = world->instance[instance].mesh, .prim = prim};
    const struct world_mesh *mesh = &world->mesh[place.mesh];
    uint32_t from = 0, to = mesh->geometry_count;
    while (to - from > 1) {
        uint32_t middle = from + (to - from) / 2;
        if (mesh->geometry[middle].first <= place.prim)
            from = middle;
        else
            to = middle;
    }
    place.geometry = from;
    place.tri = place.prim - mesh->geometry[from].first;
    return place;
}

bool instance_is_identity(const struct instance *instance)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (instance->m[i][j] != (i == j ? 1.0f : 0.0f))
                return false;
    return true;
}

/* --- what a ray may meet ---------------------------------------------------------------------- */

bool world_is_opaque(const struct instance *instance, bool geometry_opaque, struct ray_mode mode)
{
    if (mode.flags & ABI_RAY_OPAQUE)
        return true;
    if (mode.flags & ABI_RAY_NO_OPAQUE)
        return false;
    if (instance->flags & ABI_INSTANCE_FORCE_OPAQUE)
        return true;
    if (instance->flags & ABI_INSTANCE_FORCE_NO_OPAQUE)
        return false;
    return geometry_opaque;
}

bool world_culls(const struct instance *instance, bool opaque, bool front, struct ray_mode mode)
{
    if (mode.flags & (opaque ? ABI_RAY_CULL_OPAQUE : ABI_RAY_CULL_NO_OPAQUE))
        return true;
    if (instance->flags & ABI_INSTANCE_CULL_DISABLE)
        return false;
    return (mode.flags & (front ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK)) != 0;
}

/* Mixes one more number into a hash, by the finaliser of MurmurHash3: a bijection of words. */
static uint32_t mix(uint32_t hash, uint32_t number)
{
    hash ^= number;
    hash ^= hash >> 16;
    hash *= 0x85EBCA6Bu;
    hash ^= hash >> 13;
    hash *= 0xC2B2AE35u;
    return hash ^ (hash >> 16);
}

/* The cell of a coordinate: 0 .. ABI_FILTER_GRID - 1. */
static uint32_t cell_of(float x)
{
    float scaled = x * (float)ABI_FILTER_GRID; /* exact: the grid is a power of two */
    if (!(scaled >= 1.0f))
        return 0;
    return scaled < (float)ABI_FILTER_GRID ? (uint32_t)scaled : ABI_FILTER_GRID - 1;
}

bool filter_passes(const struct filter_rule *filter, const struct place *place, float u, float v)
{
    if (filter->kind == FILTER_ALL || filter->kind == FILTER_NONE)
        return filter->kind == FILTER_ALL;
    uint32_t hash = mix(mix(mix(filter->seed, place->instance), place->geometry), place->tri);
    if (filter->kind == FILTER_CELLS)
        hash = mix(hash, cell_of(u) * ABI_FILTER_GRID + cell_of(v));
    return (hash & 0xFF) < filter->share;
}

/* What instances may be: inactive, masked, of any flags, of meshes of several geometries. */
#include "scenes/worlds/placer.h"

#include <stdlib.h>

/* Cuts a mesh into geometries, one in three of them not opaque, the last one empty. */
static enum status cut_mesh(struct placer *placer, struct world_mesh *mesh, uint32_t count,
                            struct reason *reason)
{
    struct geometry *geometry = alloc_zeroed(count, sizeof *geometry);
    if (!geometry)
        return fail(reason, STATUS_MEMORY, "no memory for %u geometries", count);
    uint32_t next = 0, all = mesh->scene->tri_count;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t size = i + 2 >= count ? all - next : rng_below(&placer->rng, all - next + 1);
        geometry[i] = (struct geometry){next, size, rng_below(&placer->rng, 3) != 0};
        next += size;
    }
    free(mesh->geometry);
    mesh->geometry = geometry;
    mesh->geometry_count = count;
    return STATUS_OK;
}

/* Flags of which at most one forces. */
static uint32_t draw_flags(struct placer *placer)
{
    static const uint32_t forced[] = {0, 0, ABI_INSTANCE_FORCE_OPAQUE,
                                      ABI_INSTANCE_FORCE_NO_OPAQUE};
    uint32_t facing =
        rng_below(&placer->rng, 4); /* CULL_DISABLE and FLIP_FACING are bits 0 and 1 */
    return facing | forced[rng_below(&placer->rng, ARRAY_COUNT(forced))];
}

/* One instance in eight has no mesh, one in eight mask 0, one in four a large custom index. */
static void draw_instance(struct placer *placer, uint32_t i)
{
    double t[3];
    struct linear turn = placer_rotation(placer);
    uint32_t mesh = rng_below(&placer->rng, placer->world->mesh_count);
    uint32_t idle = rng_below(&placer->rng, 8);
    for (int k = 0; k < 3; k++)
        t[k] = (double)rng_range(&placer->rng, -2, 2);
    struct instance *instance = placer_add(placer, idle == 0 ? WORLD_NO_MESH : mesh, &turn, t);
    instance->flags = draw_flags(placer);
    instance->mask = 1 + rng_below(&placer->rng, 255);
    if (idle == 1)
        instance->mask = 0;
    instance->custom = rng_below(&placer->rng, 4) ? rng_below(&placer->rng, ABI_CUSTOM_MOST + 1)
                                                  : ABI_CUSTOM_MOST - i % 2;
}

static enum status make_mixed(struct placer *placer, const double *value, struct reason *reason)
{
    uint32_t count = (uint32_t)value[0];
    struct scene none = {0};
    enum status status = placer_start(placer, 3, count, reason);
    if (!status)
        status =
            placer_generated(placer, "sphere", (const double[GENERATOR_PARAMS]){4, 1}, 1, reason);
    if (!status)
        status = placer_box(placer, reason);
    if (!status && scene_make(0, 0, &none))
        status = fail(reason, STATUS_MEMORY, "no memory for a mesh");
    if (!status)
        status = placer_mesh(placer, &none, reason);
    if (!status)
        status = cut_mesh(placer, &placer->world->mesh[0], 5, reason);
    if (status)
        return status;
    for (uint32_t i = 0; i < count; i++)
        draw_instance(placer, i);
    const uint32_t seed = (uint32_t)rng_u64(&placer->rng);
    placer->world->filter =
        (struct filter_rule){(enum filter_kind)(uint32_t)value[1], seed, (uint32_t)value[2]};
    return STATUS_OK;
}

const struct world_generator gen_mixed = {
    .name = "mixed",
    .summary = "instances with random masks, flags and custom indices, some inactive; a mesh of "
               "several geometries, a box, an empty mesh",
    .param = {{"count", "instances", 32, 1, PLACER_INSTANCES_MOST, true},
              {"filter", "0 all, 1 none, 2 triangles, 3 cells", 3, 0, 3, true},
              {"share", "of 256 candidates that pass", 128, 0, 256, true}},
    .make = make_mixed,
};

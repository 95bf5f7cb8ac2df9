#include "ref/two_level/packed_world.h"

#include "ref/store.h"
#include "ref/world/object_ray.h"

#include <stdlib.h>
#include <string.h>

/* --- records ---------------------------------------------------------------------------------- */

static enum status record_make(const struct world *world, uint32_t at, struct instance_record *out,
                               struct reason *reason)
{
    const struct instance *instance = &world->instance[at];
    struct reason why = {""};
    *out = (struct instance_record){
        .first = world->first[at],
        .mesh = WORLD_NO_MESH,
        .custom_mask = instance->custom | instance->mask << 24,
        .flags = instance->flags | (instance_is_identity(instance) ? ABI_INSTANCE_IDENTITY : 0),
    };
    if (!world_is_active(world, at))
        return STATUS_OK;
    out->mesh = instance->mesh;
    for (int k = 0; k < 3; k++)
        out->t[k] = instance->m[k][3];
    if (transform_inverse(instance->m, out->w, &why))
        return fail(reason, STATUS_LIMIT, "instance %u: %s", at, why.text);
    return STATUS_OK;
}

enum status world_records_make(const struct world *world, struct instance_record **out,
                               struct reason *reason)
{
    struct instance_record *record = alloc_zeroed(world->instance_count, sizeof *record);
    enum status status = STATUS_OK;
    if (!record)
        status = fail(reason, STATUS_MEMORY, "no memory for %u instances", world->instance_count);
    for (uint32_t i = 0; i < world->instance_count && !status; i++)
        status = record_make(world, i, &record[i], reason);
    if (status)
        free(record);
    *out = status ? NULL : record;
    return status;
}

/* --- trees ------------------------------------------------------------------------------------ */

static enum status pack_levels(const struct world *world, const struct world_trees *trees,
                               const struct layout *top, const struct layout *bottom,
                               const struct tri_store *store, struct packed_world *out,
                               struct reason *reason)
{
    struct reason why = {""};
    enum status status =
        packed_make_stored(top, tri_stores[0], &trees->top, &trees->items, &out->top, &why);
    if (status)
        return fail(reason, status, "top level, whose triangles are instances: %s", why.text);
    out->bottom = alloc_zeroed(world->mesh_count, sizeof *out->bottom);
    if (!out->bottom)
        return fail(reason, STATUS_MEMORY, "no memory for %u trees", world->mesh_count);
    out->mesh_count = world->mesh_count;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        status = packed_make_stored(bottom, store, &trees->bottom[i], world->mesh[i].scene,
                                    &out->bottom[i], &why);
        if (status)
            return fail(reason, status, "mesh %u: %s", i, why.text);
        out->split = out->split || out->bottom[i].split;
    }
    return STATUS_OK;
}

/* Only meshes that a ray can get to count. */
static enum status find_stack(struct packed_world *packed, struct reason *reason)
{
    uint32_t bottom = 0, mesh = 0, most = packed_world_stack_most(packed);
    for (uint32_t i = 0; i < packed->instance_count; i++) {
        uint32_t of = packed->record[i].mesh;
        if (of != WORLD_NO_MESH && packed->bottom[of].stack_need > bottom) {
            bottom = packed->bottom[of].stack_need;
            mesh = of;
        }
    }
    packed->stack_need = packed->top.stack_need + bottom;
    if (packed->stack_need <= most)
        return STATUS_OK;
    return fail(reason, STATUS_LIMIT,
                "the traversal stack holds %u entries, the top level needs %u and mesh %u %u; use "
                "builder median or a larger --leaf",
                most, packed->top.stack_need, mesh, bottom);
}

enum status packed_world_make(const struct world *world, const struct world_trees *trees,
                              const struct layout *top, const struct layout *bottom,
                              const struct tri_store *store, struct packed_world *out,
                              struct reason *reason)
{
    *out = (struct packed_world){.instance_count = world->instance_count};
    enum status status = world_records_make(world, &out->record, reason);
    if (!status) {
        out->box = alloc_copy(trees->box, world->instance_count, sizeof *out->box);
        if (!out->box)
            status = fail(reason, STATUS_MEMORY, "no memory for %u boxes", world->instance_count);
    }
    if (!status)
        status = pack_levels(world, trees, top, bottom, store, out, reason);
    if (!status)
        status = find_stack(out, reason);
    if (status)
        packed_world_free(out);
    return status;
}

void packed_world_free(struct packed_world *packed)
{
    for (uint32_t i = 0; i < packed->mesh_count; i++)
        packed_free(&packed->bottom[i]);
    free(packed->bottom);
    packed_free(&packed->top);
    free(packed->record);
    free(packed->box);
    *packed = (struct packed_world){0};
}

uint64_t packed_world_bytes(const struct packed_world *packed)
{
    uint64_t bytes = packed_node_bytes(&packed->top) + packed_item_bytes(&packed->top) +
                     packed->instance_count * sizeof *packed->record;
    for (uint32_t i = 0; i < packed->mesh_count; i++)
        bytes += packed_node_bytes(&packed->bottom[i]) + packed_item_bytes(&packed->bottom[i]);
    return bytes;
}

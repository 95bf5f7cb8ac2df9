#include "ref/two_level/packed_world.h"

#include "ref/store.h"
#include "ref/tree/subtree.h"
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

/* --- parts ------------------------------------------------------------------------------------ */

/* A part, and which of all it is. */
struct part_of {
    uint32_t mesh, node, at;
};

static int part_order(const void *left, const void *right)
{
    const struct part_of *a = left, *b = right;
    int order = order_numbers(a->mesh, b->mesh);
    order = order ? order : order_numbers(a->node, b->node);
    return order ? order : order_numbers(a->at, b->at);
}

/* All parts, those of one tree one after the other. Caller frees; NULL if out of memory. */
static struct part_of *sorted_parts(const struct world *world, const struct world_parts *parts)
{
    struct part_of *of = alloc_zeroed(parts->count, sizeof *of);
    for (uint32_t i = 0; i < parts->count && of; i++)
        of[i] =
            (struct part_of){world->instance[parts->part[i].instance].mesh, parts->part[i].node, i};
    if (of)
        qsort(of, parts->count, sizeof *of, part_order);
    return of;
}

static bool begins_tree(const struct part_of *of, uint32_t at)
{
    return at == 0 || of[at].mesh != of[at - 1].mesh || of[at].node != of[at - 1].node;
}

/* --- entries ---------------------------------------------------------------------------------- */

/* The records of the entries, behind those of the instances that out->record has; mesh is set by
 * pack_parts. */
static enum status entries_make(const struct world *world, const struct world_trees *trees,
                                struct packed_world *out, struct reason *reason)
{
    const uint32_t instances = world->instance_count, parts = trees->parts.count;
    const uint32_t count = instances + parts;
    struct instance_record *record;
    enum status status = world_records_make(world, &record, reason);
    if (status)
        return status;
    out->record = alloc_zeroed(count, sizeof *out->record);
    out->instance = alloc_zeroed(count, sizeof *out->instance);
    out->box = alloc_copy(trees->box, count, sizeof *out->box);
    if (!out->record || !out->instance || !out->box)
        status = fail(reason, STATUS_MEMORY, "no memory for %u boxes", count);
    for (uint32_t i = 0; i < count && !status; i++) {
        out->instance[i] = i < instances ? i : trees->parts.part[i - instances].instance;
        out->record[i] = record[out->instance[i]];
    }
    free(record);
    out->entry_count = count;
    out->share = trees->parts.share;
    out->reach = trees->parts.reach;
    return status;
}

/* --- trees ------------------------------------------------------------------------------------ */

/* How the trees of the meshes are packed. */
struct bottom_pack {
    const struct world *world;
    const struct world_trees *trees;
    const struct layout *layout;
    const struct tri_store *store;
    const struct part_of *part; /* sorted_parts */
};

static enum status pack_meshes(const struct bottom_pack *how, struct packed_world *out,
                               struct reason *reason)
{
    struct reason why = {""};
    for (uint32_t i = 0; i < out->mesh_count; i++) {
        enum status status = packed_make_stored(how->layout, how->store, &how->trees->bottom[i],
                                                how->world->mesh[i].scene, &out->bottom[i], &why);
        if (status)
            return fail(reason, status, "mesh %u: %s", i, why.text);
        out->mesh[i] = i;
        out->split = out->split || out->bottom[i].split;
    }
    return STATUS_OK;
}

static enum status pack_part(const struct bottom_pack *how, const struct part_of *part,
                             struct packed *out, struct reason *reason)
{
    struct reason why = {"no memory"};
    struct bvh bvh;
    enum status status = subtree_make(&how->trees->bottom[part->mesh], part->node, &bvh);
    if (!status)
        status = packed_make_stored(how->layout, how->store, &bvh,
                                    how->world->mesh[part->mesh].scene, out, &why);
    bvh_free(&bvh);
    if (status)
        (void)fail(reason, status, "part %u of mesh %u: %s", part->node, part->mesh, why.text);
    return status;
}

static enum status pack_parts(const struct bottom_pack *how, struct packed_world *out,
                              struct reason *reason)
{
    uint32_t tree = out->mesh_count - 1;
    for (uint32_t i = 0; i < how->trees->parts.count; i++) {
        const struct part_of *part = &how->part[i];
        enum status status = STATUS_OK;
        if (begins_tree(how->part, i)) {
            out->mesh[++tree] = part->mesh;
            status = pack_part(how, part, &out->bottom[tree], reason);
        }
        if (status)
            return status;
        out->record[out->instance_count + part->at].mesh = tree;
    }
    return STATUS_OK;
}

static enum status pack_bottoms(const struct bottom_pack *how, struct packed_world *out,
                                struct reason *reason)
{
    uint64_t count = how->world->mesh_count;
    for (uint32_t i = 0; i < how->trees->parts.count; i++)
        count += begins_tree(how->part, i);
    if (count >= UINT32_MAX)
        return fail(reason, STATUS_LIMIT, "a world has fewer than 2^32 - 1 trees, this one %llu",
                    (unsigned long long)count);
    out->bottom = alloc_zeroed(count, sizeof *out->bottom);
    out->mesh = alloc_zeroed(count, sizeof *out->mesh);
    if (!out->bottom || !out->mesh)
        return fail(reason, STATUS_MEMORY, "no memory for %llu trees", (unsigned long long)count);
    out->mesh_count = how->world->mesh_count;
    out->tree_count = (uint32_t)count;
    enum status status = pack_meshes(how, out, reason);
    return status ? status : pack_parts(how, out, reason);
}

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
    struct part_of *part = sorted_parts(world, &trees->parts);
    const struct bottom_pack how = {world, trees, bottom, store, part};
    status = part ? pack_bottoms(&how, out, reason)
                  : fail(reason, STATUS_MEMORY, "no memory for %u parts", trees->parts.count);
    free(part);
    return status;
}

enum status packed_world_stack(struct packed_world *packed, struct reason *reason)
{
    uint32_t bottom = 0, tree = 0, most = packed_world_stack_most(packed);
    for (uint32_t i = 0; i < packed->entry_count; i++) {
        uint32_t of = packed->record[i].mesh;
        if (of != WORLD_NO_MESH && packed->bottom[of].stack_need > bottom) {
            bottom = packed->bottom[of].stack_need;
            tree = of;
        }
    }
    packed->stack_need = packed->top.stack_need + bottom;
    if (packed->stack_need <= most)
        return STATUS_OK;
    return fail(reason, STATUS_LIMIT,
                "the traversal stack holds %u entries, the top level needs %u and mesh %u %u; use "
                "builder median or a larger --leaf",
                most, packed->top.stack_need, packed->mesh[tree], bottom);
}

enum status packed_world_make(const struct world *world, const struct world_trees *trees,
                              const struct layout *top, const struct layout *bottom,
                              const struct tri_store *store, struct packed_world *out,
                              struct reason *reason)
{
    *out = (struct packed_world){.instance_count = world->instance_count};
    enum status status = entries_make(world, trees, out, reason);
    if (!status)
        status = pack_levels(world, trees, top, bottom, store, out, reason);
    if (!status)
        status = packed_world_stack(out, reason);
    if (status)
        packed_world_free(out);
    return status;
}

void packed_world_free(struct packed_world *packed)
{
    for (uint32_t i = 0; i < packed->tree_count; i++)
        packed_free(&packed->bottom[i]);
    free(packed->bottom);
    free(packed->mesh);
    packed_free(&packed->top);
    free(packed->record);
    free(packed->instance);
    free(packed->box);
    *packed = (struct packed_world){0};
}

uint64_t packed_world_bytes(const struct packed_world *packed)
{
    uint64_t bytes = packed_node_bytes(&packed->top) + packed_item_bytes(&packed->top) +
                     packed->entry_count * sizeof *packed->record;
    for (uint32_t i = 0; i < packed->tree_count; i++)
        bytes += packed_node_bytes(&packed->bottom[i]) + packed_item_bytes(&packed->bottom[i]);
    return bytes;
}

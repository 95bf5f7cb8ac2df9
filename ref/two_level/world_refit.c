/* Refits of both levels of a world. */
#include "ref/packed/refit.h"
#include "ref/two_level/world_life.h"

#include <stdlib.h>
#include <string.h>

static enum status same_numbers(const struct world_trees *trees, const struct world *world,
                                struct reason *reason)
{
    if (trees->instance_count != world->instance_count || trees->mesh_count != world->mesh_count)
        return fail(reason, STATUS_INPUT,
                    "the trees are of %u instances and %u meshes, the world has %u and %u",
                    trees->instance_count, trees->mesh_count, world->instance_count,
                    world->mesh_count);
    if (trees->parts.count > 0)
        return fail(reason, STATUS_LIMIT,
                    "rebuild: a top level with parts of instances is not refitted");
    return STATUS_OK;
}

/* An instance that is not active has an empty box. */
static enum status same_activity(const struct world_trees *trees, const struct world *world,
                                 struct reason *reason)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const bool was = trees->box[i].lo[0] <= trees->box[i].hi[0];
        if (was != world_is_active(world, i))
            return fail(reason, STATUS_LIMIT, "rebuild: instance %u was%s active, and is%s now", i,
                        was ? "" : " not", was ? " not" : "");
    }
    return STATUS_OK;
}

/* What a refit changes of a world's trees. */
struct world_bounds {
    struct box *entry; /* of each entry */
    struct scene items;
    struct box *top, **bottom; /* of each node */
};

static void bounds_free(struct world_bounds *bounds, uint32_t meshes)
{
    for (uint32_t i = 0; i < meshes && bounds->bottom; i++)
        free(bounds->bottom[i]);
    free(bounds->bottom);
    free(bounds->top);
    free(bounds->entry);
    scene_free(&bounds->items);
}

static enum status find_bounds(const struct world_trees *trees, const struct world *world,
                               struct world_bounds *out, struct reason *reason)
{
    struct reason why = {""};
    enum status status = world_boxes_make(world, trees->boxes, &out->entry, &why);
    if (status)
        return fail(reason, status, "rebuild: %s", why.text);
    status = world_items_make(world, &trees->parts, out->entry, &out->items, reason);
    out->bottom = alloc_zeroed(world->mesh_count, sizeof *out->bottom);
    if (!status)
        out->top = bvh_exact_bounds(&trees->top, &out->items);
    if (!status && (!out->bottom || !out->top))
        status = STATUS_MEMORY;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        const struct bvh *bottom = &trees->bottom[i];
        const struct scene *scene = world->mesh[i].scene;
        if (bottom->tri_count != scene->tri_count)
            return fail(reason, STATUS_INPUT,
                        "mesh %u: the tree holds %u triangles, the scene has %u", i,
                        bottom->tri_count, scene->tri_count);
        if (bvh_is_split(bottom))
            return fail(reason, STATUS_LIMIT,
                        "rebuild: mesh %u: the tree is split, its boxes of parts of triangles "
                        "cannot be refitted",
                        i);
        out->bottom[i] = bvh_exact_bounds(bottom, scene);
        status = out->bottom[i] ? STATUS_OK : STATUS_MEMORY;
    }
    return status ? fail(reason, status, "no memory to refit the trees of %u meshes",
                         world->mesh_count)
                  : STATUS_OK;
}

static void take_bounds(struct bvh *bvh, const struct box *bounds)
{
    for (uint32_t i = 0; i < bvh->node_count; i++)
        bvh->node[i].bounds = bounds[i];
}

enum status world_trees_refit(struct world_trees *trees, const struct world *world,
                              struct reason *reason)
{
    struct world_bounds bounds = {.top = NULL};
    enum status status = same_numbers(trees, world, reason);
    if (!status)
        status = same_activity(trees, world, reason);
    if (!status)
        status = find_bounds(trees, world, &bounds, reason);
    if (!status) {
        const struct scene items = trees->items;
        struct box *entry = trees->box;
        trees->items = bounds.items;
        bounds.items = items;
        trees->box = bounds.entry;
        bounds.entry = entry;
        take_bounds(&trees->top, bounds.top);
        for (uint32_t i = 0; i < world->mesh_count; i++)
            take_bounds(&trees->bottom[i], bounds.bottom[i]);
    }
    bounds_free(&bounds, world->mesh_count);
    return status;
}

static enum status refit_trees(struct packed_world *packed, const struct world_trees *trees,
                               const struct world *world, struct reason *reason)
{
    struct reason why = {""};
    enum status status = packed_refit(&packed->top, &trees->items, &why);
    if (status)
        return fail(reason, status, "top level, whose triangles are instances: %s", why.text);
    for (uint32_t i = 0; i < packed->mesh_count; i++) {
        status = packed_refit(&packed->bottom[i], world->mesh[i].scene, &why);
        if (status)
            return fail(reason, status, "mesh %u: %s", i, why.text);
    }
    return STATUS_OK;
}

enum status packed_world_refit(struct packed_world *packed, const struct world_trees *trees,
                               const struct world *world, struct reason *reason)
{
    struct instance_record *record = NULL;
    enum status status = refit_trees(packed, trees, world, reason);
    if (!status)
        status = world_records_make(world, &record, reason);
    if (status)
        return status;
    free(packed->record);
    packed->record = record;
    memcpy(packed->box, trees->box, packed->entry_count * sizeof *packed->box);
    return packed_world_stack(packed, reason);
}

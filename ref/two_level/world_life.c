#include "ref/two_level/world_life.h"

#include <stdlib.h>

void world_life_free(struct world_life *life)
{
    packed_world_free(&life->packed);
    world_trees_free(&life->trees);
    *life = (struct world_life){0};
}

enum status world_life_begin(const struct world_recipe *recipe, const struct world *world,
                             struct world_life *out, struct reason *reason)
{
    *out = (struct world_life){.fate = LIFE_BUILT};
    enum status status = world_trees_make(world, recipe->build, &out->trees, reason);
    if (!status)
        status = packed_world_make(world, &out->trees, recipe->top, recipe->bottom, recipe->store,
                                   &out->packed, reason);
    if (status)
        world_life_free(out);
    return status;
}

static bool copy_bvh(const struct bvh *from, struct bvh *out)
{
    *out = *from;
    out->node = alloc_copy(from->node, from->node_count, sizeof *out->node);
    out->prim = alloc_copy(from->prim, from->prim_count, sizeof *out->prim);
    return !out->node == !from->node && !out->prim == !from->prim;
}

static bool copy_packed(const struct packed *from, struct packed *out)
{
    const size_t items = from->item ? from->item_count : 0;
    *out = *from;
    out->word = alloc_copy(from->word, from->word_count, sizeof *from->word);
    out->item = from->item ? alloc_copy(from->item, items, sizeof *from->item) : NULL;
    out->item_room = items;
    return !out->word == !from->word && !out->item == !from->item;
}

/* Of trees without parts, without their items, which a refit makes anew. What is not yet copied is
 * zero, so that all can be freed. */
static bool copy_trees(const struct world_trees *from, struct world_trees *out)
{
    *out = *from;
    out->bottom = NULL;
    out->top = (struct bvh){.node = NULL};
    out->items = (struct scene){0};
    out->mesh_count = 0;
    out->box = alloc_copy(from->box, from->instance_count, sizeof *out->box);
    bool room = (out->box || !from->box) && copy_bvh(&from->top, &out->top);
    out->bottom = room ? alloc_zeroed(from->mesh_count, sizeof *out->bottom) : NULL;
    room = room && out->bottom;
    for (uint32_t i = 0; i < from->mesh_count && room; i++) {
        room = copy_bvh(&from->bottom[i], &out->bottom[i]);
        out->mesh_count = i + 1;
    }
    return room;
}

/* Likewise. */
static bool copy_world(const struct packed_world *from, struct packed_world *out)
{
    *out = *from;
    out->top = (struct packed){.word = NULL};
    out->tree_count = 0;
    out->record = alloc_copy(from->record, from->entry_count, sizeof *out->record);
    out->instance = alloc_copy(from->instance, from->entry_count, sizeof *out->instance);
    out->box = alloc_copy(from->box, from->entry_count, sizeof *out->box);
    out->mesh = alloc_copy(from->mesh, from->tree_count, sizeof *out->mesh);
    out->bottom = alloc_zeroed(from->tree_count, sizeof *out->bottom);
    bool room = !out->record == !from->record && !out->instance == !from->instance &&
                !out->box == !from->box && !out->mesh == !from->mesh && out->bottom &&
                copy_packed(&from->top, &out->top);
    for (uint32_t i = 0; i < from->tree_count && room; i++) {
        room = copy_packed(&from->bottom[i], &out->bottom[i]);
        out->tree_count = i + 1;
    }
    return room;
}

static enum status refit(const struct world_life *before, const struct world *world,
                         struct world_life *out, struct reason *reason)
{
    *out = (struct world_life){.fate = LIFE_REFITTED};
    if (before->trees.parts.count > 0)
        return fail(reason, STATUS_LIMIT,
                    "rebuild: a top level with parts of instances is not refitted");
    enum status status = STATUS_OK;
    if (!copy_trees(&before->trees, &out->trees) || !copy_world(&before->packed, &out->packed))
        status = fail(reason, STATUS_MEMORY, "no memory to copy the trees of %u meshes",
                      before->trees.mesh_count);
    if (!status)
        status = world_trees_refit(&out->trees, world, reason);
    if (!status)
        status = packed_world_refit(&out->packed, &out->trees, world, reason);
    if (status)
        world_life_free(out);
    return status;
}

enum status world_life_step(const struct world_recipe *recipe, enum life_act act,
                            const struct world *world, const struct world_life *before,
                            struct world_life *out, struct reason *reason)
{
    enum status status = STATUS_LIMIT;
    if (act == LIFE_REFIT)
        status = refit(before, world, out, reason);
    if (status != STATUS_LIMIT)
        return status;
    status = world_life_begin(recipe, world, out, reason);
    if (!status)
        out->fate = act == LIFE_REFIT ? LIFE_FORCED : LIFE_REBUILT;
    return status;
}

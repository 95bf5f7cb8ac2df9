#include "ref/packed/life.h"

#include "ref/packed/refit.h"
#include "ref/store.h"

#include <stdlib.h>

const char *life_act_name(enum life_act act)
{
    return act == LIFE_REFIT ? "refit" : "rebuild";
}

void life_tree_free(struct life_tree *tree)
{
    packed_free(&tree->packed);
    bvh_free(&tree->bvh);
    *tree = (struct life_tree){0};
}

enum status life_begin(const struct life_recipe *recipe, const struct scene *scene,
                       struct life_tree *out, struct reason *reason)
{
    *out = (struct life_tree){.fate = LIFE_BUILT};
    enum status status = bvh_build(recipe->builder, scene, recipe->build, &out->bvh, reason);
    if (!status)
        status = packed_make_stored(recipe->layout, recipe->store, &out->bvh, scene, &out->packed,
                                    reason);
    if (status)
        life_tree_free(out);
    return status;
}

static enum status copy(const struct life_tree *from, struct life_tree *out, struct reason *reason)
{
    const struct packed *packed = &from->packed;
    const size_t items = packed->item ? packed->item_count : 0;
    *out = *from;
    out->bvh.node = alloc_copy(from->bvh.node, from->bvh.node_count, sizeof *out->bvh.node);
    out->bvh.prim = alloc_copy(from->bvh.prim, from->bvh.prim_count, sizeof *out->bvh.prim);
    out->packed.word = alloc_copy(packed->word, packed->word_count, sizeof *packed->word);
    out->packed.item = packed->item ? alloc_copy(packed->item, items, sizeof *packed->item) : NULL;
    out->packed.item_room = items;
    if (!out->bvh.node == !from->bvh.node && !out->bvh.prim == !from->bvh.prim &&
        !out->packed.word == !packed->word && !out->packed.item == !packed->item)
        return STATUS_OK;
    life_tree_free(out);
    return fail(reason, STATUS_MEMORY, "no memory to copy a tree of %u nodes",
                from->bvh.node_count);
}

static enum status refit(const struct life_tree *before, const struct scene *scene,
                         struct life_tree *out, struct reason *reason)
{
    enum status status = copy(before, out, reason);
    if (!status)
        status = packed_refit(&out->packed, scene, reason);
    if (!status)
        status = bvh_refit(&out->bvh, scene, reason);
    out->fate = LIFE_REFITTED;
    if (status)
        life_tree_free(out);
    return status;
}

enum status life_step(const struct life_recipe *recipe, enum life_act act,
                      const struct scene *scene, const struct life_tree *before,
                      struct life_tree *out, struct reason *reason)
{
    enum status status = STATUS_LIMIT;
    if (act == LIFE_REFIT)
        status = refit(before, scene, out, reason);
    if (status != STATUS_LIMIT)
        return status;
    status = life_begin(recipe, scene, out, reason);
    if (!status)
        out->fate = act == LIFE_REFIT ? LIFE_FORCED : LIFE_REBUILT;
    return status;
}

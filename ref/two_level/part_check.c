#include "ref/two_level/world_check_inner.h"

#include "ref/packed/packed_check.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdlib.h>

/* The triangles that the trees of parts name: those of tree mesh_count + i are prim[first[i] ..
 * first[i + 1] - 1], in rising order, each once. */
struct named {
    uint32_t *prim;
    size_t *first;
    size_t room;
};

static void named_free(struct named *named)
{
    free(named->prim);
    free(named->first);
}

/* --- trees ------------------------------------------------------------------------------------ */

/* Clears left_out[prim] for each triangle that a leaf names. Hostile words can claim more slots
 * than there are triangles; packed_check refuses them. */
static enum status mark_named(const struct packed *packed, uint32_t tri_count, bool *left_out)
{
    struct packed_walk walk;
    enum status status = packed_walk_make(packed, &walk);
    for (uint32_t i = 0; i < walk.visit_count && !status; i++) {
        struct wide node;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        uint32_t most = tri_count < WIDE_MAX ? WIDE_MAX : tri_count;
        uint32_t slots = node.child_count > 0 || node.item_count > most ? 0 : node.item_count;
        for (uint32_t s = 0; s < slots; s++) {
            uint32_t prim = packed_item(packed, &node, s);
            if (prim < tri_count)
                left_out[prim] = false;
        }
    }
    packed_walk_free(&walk);
    return status;
}

static enum status list_named(struct named *named, uint32_t at, const bool *left_out,
                              uint32_t tri_count)
{
    size_t count = named->first[at];
    for (uint32_t prim = 0; prim < tri_count; prim++) {
        if (left_out[prim])
            continue;
        if (array_reserve(&named->prim, &named->room, count + 1, sizeof *named->prim))
            return STATUS_MEMORY;
        named->prim[count++] = prim;
    }
    named->first[at + 1] = count;
    return STATUS_OK;
}

static enum status check_tree(struct world_check *check, uint32_t tree, struct named *named)
{
    const struct packed *packed = &check->packed->bottom[tree];
    const uint32_t mesh = check->packed->mesh[tree];
    const struct scene *scene = check->world->mesh[mesh].scene;
    struct reason why = {""};
    bool *left_out = alloc_zeroed(scene->tri_count, sizeof *left_out);
    enum status status = left_out ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < scene->tri_count && !status; i++)
        left_out[i] = true;
    if (!status)
        status = mark_named(packed, scene->tri_count, left_out);
    if (!status)
        status = packed->split ? fail(&why, STATUS_INPUT, "it is split")
                               : packed_check_without(packed, scene, left_out, NULL, &why);
    if (status == STATUS_INPUT) {
        check->faults.bottoms++;
        world_check_report(check, WORLD_BOTTOM, "tree %u, a part of mesh %u: %s", tree, mesh,
                           why.text);
        status = STATUS_OK;
    }
    if (!status)
        status = list_named(named, tree - check->packed->mesh_count, left_out, scene->tri_count);
    free(left_out);
    return status;
}

/* --- instances -------------------------------------------------------------------------------- */

/* Marks the triangles of a part with `stamp`, in which no other part of the instance may have
 * marked them, and checks that the part's box contains them. Returns their number. */
static uint32_t check_part(struct world_check *check, const struct named *named, uint32_t entry,
                           uint32_t stamp, uint32_t *seen)
{
    const uint32_t tree = check->packed->record[entry].mesh - check->packed->mesh_count;
    bool inside = true;
    uint32_t count = 0;
    for (size_t i = named->first[tree]; i < named->first[tree + 1]; i++) {
        const uint32_t prim = named->prim[i];
        inside = inside && world_check_placed(check, entry, prim);
        if (seen[prim] == stamp) {
            check->faults.parts++;
            world_check_report(check, WORLD_PARTS, "instance %u: triangle %u is in two parts",
                               check->packed->instance[entry], prim);
        }
        count += seen[prim] != stamp;
        seen[prim] = stamp;
    }
    return count;
}

static void check_width(struct world_check *check, uint32_t instance)
{
    const struct packed_world *packed = check->packed;
    float share, reach;
    if (braid_needs(check->world, instance, &packed->box[instance], &share, &reach) &&
        packed->share >= share && packed->reach >= reach)
        return;
    check->faults.widths++;
    world_check_report(check, WORLD_WIDTH,
                       "instance %u: parts of it need share %a, reach %a, not %a, %a", instance,
                       (double)share, (double)reach, (double)packed->share, (double)packed->reach);
}

/* Entries of an instance are neighbours. */
static void check_instances(struct world_check *check, const struct named *named, uint32_t *seen)
{
    const struct packed_world *packed = check->packed;
    uint32_t entry = packed->instance_count;
    while (entry < packed->entry_count) {
        const uint32_t instance = packed->instance[entry], stamp = entry + 1;
        const struct scene *scene = world_scene(check->world, instance);
        uint32_t count = 0;
        for (; entry < packed->entry_count && packed->instance[entry] == instance; entry++)
            count += check_part(check, named, entry, stamp, seen);
        if (count != scene->tri_count) {
            check->faults.parts++;
            world_check_report(check, WORLD_PARTS, "instance %u: its parts have %u of %u triangles",
                               instance, count, scene->tri_count);
        }
        check_width(check, instance);
    }
}

enum status world_check_parts(struct world_check *check)
{
    const struct packed_world *packed = check->packed;
    const uint32_t trees = packed->tree_count - packed->mesh_count;
    struct named named = {.first = alloc_zeroed((size_t)trees + 1, sizeof *named.first)};
    uint32_t most = 0, *seen;
    enum status status = named.first ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < check->world->mesh_count; i++)
        most = check->world->mesh[i].scene->tri_count > most
                   ? check->world->mesh[i].scene->tri_count
                   : most;
    for (uint32_t i = packed->mesh_count; i < packed->tree_count && !status; i++)
        status = check_tree(check, i, &named);
    seen = alloc_zeroed(most, sizeof *seen);
    if (!seen)
        status = STATUS_MEMORY;
    if (!status)
        check_instances(check, &named, seen);
    free(seen);
    named_free(&named);
    return status;
}

#include "ref/two_level/world_trees.h"

#include <stdlib.h>
#include <string.h>

/* Makes `tri` the triangle of a box, which begins at vertex `vertex`. */
static void put_item(struct scene *scene, uint32_t tri, uint32_t vertex, const struct box *box)
{
    float *p = scene->vertex + 3 * (size_t)vertex;
    uint32_t *index = scene->index + 3 * (size_t)tri;
    memcpy(p, box->lo, sizeof box->lo);
    memcpy(p + 3, box->hi, sizeof box->hi);
    index[0] = index[2] = vertex;
    index[1] = vertex + 1;
}

bool *world_left_out(const struct world *world, const struct world_parts *parts)
{
    bool *out = alloc_zeroed((size_t)world->instance_count + parts->count, sizeof *out);
    for (uint32_t i = 0; i < world->instance_count && out; i++)
        out[i] = !world_is_active(world, i);
    for (uint32_t i = 0; i < parts->count && out; i++)
        out[parts->part[i].instance] = true;
    return out;
}

enum status world_items_make(const struct world *world, const struct world_parts *parts,
                             const struct box *box, struct scene *out, struct reason *reason)
{
    const uint32_t count = world->instance_count + parts->count;
    bool *left_out = world_left_out(world, parts);
    struct box inside = {{0, 0, 0}, {0, 0, 0}};
    *out = (struct scene){0};
    if (!left_out || scene_make(2 * count, count, out)) {
        free(left_out);
        return fail(reason, STATUS_MEMORY, "no memory for the boxes of %u instances",
                    world->instance_count);
    }
    for (uint32_t i = count; i-- > 0;)
        if (!left_out[i])
            for (int k = 0; k < 3; k++)
                inside.lo[k] = inside.hi[k] = box[i].lo[k];
    for (uint32_t i = 0; i < count; i++)
        put_item(out, i, 2 * i, left_out[i] ? &inside : &box[i]);
    free(left_out);
    return STATUS_OK;
}

/* --- the top ---------------------------------------------------------------------------------- */

/* The entries that are not left out: their numbers and their triangles, one after the other. */
static enum status entries_make(const struct world *world, const struct world_parts *parts,
                                const struct box *box, uint32_t **number, struct scene *out)
{
    const uint32_t all = world->instance_count + parts->count;
    bool *left_out = world_left_out(world, parts);
    uint32_t count = 0;
    *out = (struct scene){0};
    *number = alloc_zeroed(all, sizeof **number);
    enum status status = left_out && *number ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < all && !status; i++)
        if (!left_out[i])
            (*number)[count++] = i;
    if (!status)
        status = scene_make(2 * count, count, out);
    for (uint32_t i = 0; i < count && !status; i++)
        put_item(out, i, 2 * i, &box[(*number)[i]]);
    free(left_out);
    return status;
}

enum status world_top_make(const struct world *world, const struct world_parts *parts,
                           const struct box *box, const struct builder *builder,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason)
{
    struct build_options whole = *options;
    struct reason why = {"no memory"};
    struct scene active;
    uint32_t *number;
    whole.split_budget = -1;
    whole.presplit = 0;
    *out = (struct bvh){.node = NULL};
    enum status status = entries_make(world, parts, box, &number, &active);
    if (!status)
        status = bvh_build(builder, &active, &whole, out, &why);
    if (!status && bvh_is_split(out)) {
        bvh_free(out);
        status = fail(&why, STATUS_INPUT, "builder %s lists items several times", builder->name);
    }
    for (uint32_t i = 0; i < out->prim_count && !status; i++)
        out->prim[i] = number[out->prim[i]];
    free(number);
    scene_free(&active);
    if (status)
        return fail(reason, status, "top level, whose items are instances: %s", why.text);
    out->tri_count = world->instance_count + parts->count;
    return STATUS_OK;
}

/* --- both ------------------------------------------------------------------------------------- */

static enum status bottoms_make(const struct world *world, const struct world_build *build,
                                struct world_trees *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    out->bottom = alloc_zeroed(world->mesh_count, sizeof *out->bottom);
    if (!out->bottom)
        return fail(reason, STATUS_MEMORY, "no memory for %u trees", world->mesh_count);
    out->mesh_count = world->mesh_count;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        struct reason why = {""};
        status = bvh_build(build->bottom, world->mesh[i].scene, &build->bottom_options,
                           &out->bottom[i], &why);
        if (status)
            (void)fail(reason, status, "mesh %u: %s", i, why.text);
    }
    return status;
}

/* Opens instances, and puts the boxes of parts behind theirs. */
static enum status parts_make(const struct world *world, const struct world_build *build,
                              struct world_trees *out, struct reason *reason)
{
    const size_t instances = world->instance_count;
    struct box *part_box, *all;
    enum status status = braid_make(world, out->bottom, out->box, build->boxes, build->braid,
                                    &out->parts, &part_box, reason);
    if (status || out->parts.count == 0)
        return status;
    all = alloc_zeroed(instances + out->parts.count, sizeof *all);
    if (all) {
        memcpy(all, out->box, instances * sizeof *all);
        memcpy(all + instances, part_box, out->parts.count * sizeof *all);
        free(out->box);
        out->box = all;
    }
    free(part_box);
    return all ? STATUS_OK
               : fail(reason, STATUS_MEMORY, "no memory for the boxes of %u parts",
                      out->parts.count);
}

enum status world_trees_make(const struct world *world, const struct world_build *build,
                             struct world_trees *out, struct reason *reason)
{
    *out = (struct world_trees){0};
    if (world->instance_count > WORLD_INSTANCES_MOST)
        return fail(reason, STATUS_LIMIT, "trees hold at most %u instances, the world has %u",
                    WORLD_INSTANCES_MOST, world->instance_count);
    out->instance_count = world->instance_count;
    out->boxes = build->boxes;
    enum status status = world_boxes_make(world, build->boxes, &out->box, reason);
    if (!status)
        status = bottoms_make(world, build, out, reason);
    if (!status)
        status = parts_make(world, build, out, reason);
    if (!status)
        status = world_items_make(world, &out->parts, out->box, &out->items, reason);
    if (!status)
        status = world_top_make(world, &out->parts, out->box, build->top, &build->top_options,
                                &out->top, reason);
    if (status)
        world_trees_free(out);
    return status;
}

void world_trees_free(struct world_trees *trees)
{
    for (uint32_t i = 0; i < trees->mesh_count; i++)
        bvh_free(&trees->bottom[i]);
    free(trees->bottom);
    bvh_free(&trees->top);
    scene_free(&trees->items);
    free(trees->box);
    world_parts_free(&trees->parts);
    *trees = (struct world_trees){0};
}

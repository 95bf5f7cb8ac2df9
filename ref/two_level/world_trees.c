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

enum status world_items_make(const struct world *world, const struct box *box, struct scene *out,
                             struct reason *reason)
{
    struct box inside = {{0, 0, 0}, {0, 0, 0}};
    if (scene_make(2 * world->instance_count, world->instance_count, out))
        return fail(reason, STATUS_MEMORY, "no memory for the boxes of %u instances",
                    world->instance_count);
    for (uint32_t i = world->instance_count; i-- > 0;)
        if (world_is_active(world, i))
            for (int k = 0; k < 3; k++)
                inside.lo[k] = inside.hi[k] = box[i].lo[k];
    for (uint32_t i = 0; i < world->instance_count; i++)
        put_item(out, i, 2 * i, world_is_active(world, i) ? &box[i] : &inside);
    return STATUS_OK;
}

/* --- the top ---------------------------------------------------------------------------------- */

/* The active instances: their numbers and their triangles, one after the other. */
static enum status active_make(const struct world *world, const struct box *box, uint32_t **number,
                               struct scene *out)
{
    uint32_t count = 0;
    *out = (struct scene){0};
    *number = alloc_zeroed(world->instance_count, sizeof **number);
    if (!*number)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world_is_active(world, i))
            (*number)[count++] = i;
    enum status status = scene_make(2 * count, count, out);
    for (uint32_t i = 0; i < count && !status; i++)
        put_item(out, i, 2 * i, &box[(*number)[i]]);
    return status;
}

static enum status top_make(const struct world *world, const struct world_build *build,
                            struct world_trees *out, struct reason *reason)
{
    struct build_options options = build->top_options;
    struct reason why = {"no memory"};
    struct scene active;
    uint32_t *number;
    options.split_budget = -1;
    enum status status = active_make(world, out->box, &number, &active);
    if (!status)
        status = bvh_build(build->top, &active, &options, &out->top, &why);
    if (!status && bvh_is_split(&out->top)) {
        (void)fail(&why, STATUS_INPUT, "builder %s lists items several times", build->top->name);
        status = STATUS_INPUT;
    }
    for (uint32_t i = 0; i < out->top.prim_count && !status; i++)
        out->top.prim[i] = number[out->top.prim[i]];
    out->top.tri_count = world->instance_count;
    free(number);
    scene_free(&active);
    if (status)
        return fail(reason, status, "top level, whose items are instances: %s", why.text);
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

enum status world_trees_make(const struct world *world, const struct world_build *build,
                             struct world_trees *out, struct reason *reason)
{
    *out = (struct world_trees){0};
    if (world->instance_count > WORLD_INSTANCES_MOST)
        return fail(reason, STATUS_LIMIT, "trees hold at most %u instances, the world has %u",
                    WORLD_INSTANCES_MOST, world->instance_count);
    out->instance_count = world->instance_count;
    enum status status = world_boxes_make(world, build->boxes, &out->box, reason);
    if (!status)
        status = world_items_make(world, out->box, &out->items, reason);
    if (!status)
        status = top_make(world, build, out, reason);
    if (!status)
        status = bottoms_make(world, build, out, reason);
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
    *trees = (struct world_trees){0};
}

#include "ref/build/top_down.h"

#include "ref/build/grow.h"
#include "ref/build/presplit.h"
#include "ref/build/room.h"

#include <stdlib.h>

/* A waiting node, and its parent. */
struct task {
    struct build_node node;
    uint32_t parent; /* NO_PARENT for the root */
    bool is_snd;
};

#define NO_PARENT UINT32_MAX

/* Nodes made so far, and waiting nodes; the last of `task` is next. */
struct top_down_progress {
    struct bvh_node *node;
    struct task *task;
    size_t node_count, node_capacity;
    size_t task_count, task_capacity;
};

static struct box range_bounds(const struct build *build, uint32_t first, uint32_t count)
{
    struct box all = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box_add_box(&all, &build->tri_box[build->prim[first + i]]);
    return all;
}

static enum status push(struct top_down_progress *progress, const struct task *task)
{
    enum status status = array_reserve(&progress->task, &progress->task_capacity,
                                       progress->task_count + 1, sizeof *progress->task);
    if (!status)
        progress->task[progress->task_count++] = *task;
    return status;
}

/* Appends the node of `task` and links it to its parent. */
static enum status emit(struct top_down_progress *progress, const struct task *task, bool leaf)
{
    enum status status = array_reserve(&progress->node, &progress->node_capacity,
                                       progress->node_count + 1, sizeof *progress->node);
    if (status)
        return status;
    uint32_t index = (uint32_t)progress->node_count++;
    progress->node[index] = (struct bvh_node){.bounds = task->node.bounds,
                                              .item_first = task->node.first,
                                              .item_count = leaf ? task->node.count : 0};
    if (task->parent != NO_PARENT) {
        struct bvh_node *parent = &progress->node[task->parent];
        *(task->is_snd ? &parent->snd : &parent->fst) = index;
    }
    return STATUS_OK;
}

/* Splits one waiting node. Its triangles keep their place in prim: as nodes are processed in
 * pre-order, a node's first triangle is also the number of items before it. */
static enum status step(const struct build_rule *rule, struct build *build,
                        struct top_down_progress *progress, struct reason *reason)
{
    struct task task = progress->task[--progress->task_count];
    uint32_t left = 0;
    enum status status = rule->split(build, &task.node, &left, reason);
    if (status)
        return status;
    status = emit(progress, &task, left == 0);
    if (status || left == 0)
        return status;
    struct task child = {.parent = (uint32_t)progress->node_count - 1};
    for (int side = 1; side >= 0 && !status; side--) {
        child.is_snd = side == 1;
        child.node.depth = task.node.depth + 1;
        child.node.first = task.node.first + (side ? left : 0);
        child.node.count = side ? task.node.count - left : left;
        child.node.bounds = range_bounds(build, child.node.first, child.node.count);
        status = push(progress, &child);
    }
    return status;
}

/* Sets an item's box and centroid. */
static void item_start(const struct build_rule *rule, struct build *build, uint32_t i,
                       const struct part *part)
{
    float v[3][3], *centroid = build->centroid + 3 * (size_t)i;
    const struct box whole = scene_tri_bounds(build->scene, part->prim);
    build->tri_box[i] = part->box;
    scene_tri(build->scene, part->prim, v);
    rule->centroid(v, centroid);
    for (int k = 0; k < 3 && !box_contains_box(&part->box, &whole); k++)
        centroid[k] = 0.5f * part->box.lo[k] + 0.5f * part->box.hi[k];
}

static enum status build_start(const struct build_rule *rule, struct build *build,
                               const struct part *part)
{
    uint32_t count = build->count;
    build->tri_box = alloc_zeroed(count, sizeof *build->tri_box);
    build->centroid = alloc_zeroed(3 * (size_t)count, sizeof *build->centroid);
    build->prim = alloc_zeroed(count, sizeof *build->prim);
    build->spare = alloc_zeroed(count, sizeof *build->spare);
    if (!build->tri_box || !build->centroid || !build->prim || !build->spare)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < count; i++) {
        const struct part item =
            part ? part[i] : (struct part){scene_tri_bounds(build->scene, i), i};
        item_start(rule, build, i, &item);
        build->prim[i] = i;
    }
    return STATUS_OK;
}

static enum status build_all(const struct build_rule *rule, struct build *build,
                             struct top_down_progress *progress, struct reason *reason)
{
    struct part *part = NULL;
    enum status status = STATUS_OK;
    build->count = build->scene->tri_count;
    if (build->options->presplit > 0)
        status = presplit_make(build->scene, build->options, 1, &part, &build->count, reason);
    if (!status)
        status = build_start(rule, build, part);
    if (!status) {
        struct build_node all = {.bounds = range_bounds(build, 0, build->count),
                                 .count = build->count};
        status = push(progress, &(struct task){.parent = NO_PARENT, .node = all});
    }
    while (!status && progress->task_count > 0)
        status = step(rule, build, progress, reason);
    for (uint32_t i = 0; i < build->count && part && !status; i++)
        build->prim[i] = part[build->prim[i]].prim;
    room_free(part);
    return status;
}

enum status build_top_down(const struct build_rule *rule, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason)
{
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (status || scene->tri_count == 0)
        return status;
    struct build build = {.scene = scene, .options = options};
    struct top_down_progress progress = {0};
    status = build_all(rule, &build, &progress, reason);
    *out = (struct bvh){.node = progress.node,
                        .prim = build.prim,
                        .node_count = (uint32_t)progress.node_count,
                        .prim_count = build.count,
                        .tri_count = build.count};
    if (!status && options->presplit > 0)
        status = presplit_merge(out, scene->tri_count);
    if (status == STATUS_MEMORY)
        (void)fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
    free(build.tri_box);
    free(build.centroid);
    free(build.spare);
    free(progress.task);
    if (status)
        bvh_free(out);
    return status;
}

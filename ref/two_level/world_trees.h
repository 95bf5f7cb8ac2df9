/* The trees of a world: one over its instances, the top, and one over the triangles of each mesh,
 * the bottom. */
#ifndef WORLD_TREES_H
#define WORLD_TREES_H

#include "ref/tree/bvh.h"
#include "ref/world/world_boxes.h"

/* How trees are built. */
struct world_build {
    const struct builder *top, *bottom;
    /* Of the top, split_budget counts as none: its items are boxes, whose parts a builder would
     * take from the triangles that stand for them. */
    struct build_options top_options, bottom_options;
    enum world_boxes boxes;
};

#define WORLD_INSTANCES_MOST (1u << 30)

/* Owns all its members (see world_trees_free). */
struct world_trees {
    struct box *box; /* of each instance in the world; empty if it is not active */
    /* The triangles that stand for the instances: number i is (lo, hi, lo) of box i, which has
     * exactly that box as its bounds, so that every builder and layout takes it; of an instance
     * that is not active a point inside the tree. */
    struct scene items;
    /* Items are numbers of instances. Those that are not active are left out, so it does not pass
     * bvh_check_form if there are any. */
    struct bvh top;
    struct bvh *bottom; /* one per mesh */
    uint32_t instance_count, mesh_count;
};

/* Builds the trees of a world that has passed world_finish. Errors, of the first level or mesh that
 * has one: STATUS_LIMIT more than WORLD_INSTANCES_MOST instances; those of world_boxes_make,
 * bvh_build; STATUS_INPUT a top that lists an instance twice. */
enum status world_trees_make(const struct world *world, const struct world_build *build,
                             struct world_trees *out, struct reason *reason) MUST_USE;

void world_trees_free(struct world_trees *trees); /* a zero one is fine */

/* Makes the triangles that stand for `count` instances. Caller frees with scene_free. Errors:
 * STATUS_MEMORY. */
enum status world_items_make(const struct world *world, const struct box *box, struct scene *out,
                             struct reason *reason) MUST_USE;

#endif

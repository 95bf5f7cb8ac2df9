/* The trees of a world: one over its instances, the top, and one over the triangles of each mesh,
 * the bottom. */
#ifndef WORLD_TREES_H
#define WORLD_TREES_H

#include "ref/two_level/braid.h"

/* How trees are built. */
struct world_build {
    const struct builder *top, *bottom;
    /* Of the top, split_budget and presplit count as none: its items are boxes, whose parts a
     * builder would take from the triangles that stand for them. */
    struct build_options top_options, bottom_options;
    enum world_boxes boxes;
    uint32_t braid; /* most entries of the top per active instance, up to BRAID_MOST; 0 and 1: each
                       instance is one entry */
};

#define WORLD_INSTANCES_MOST (1u << 30)

/* Owns all its members (see world_trees_free). */
struct world_trees {
    /* Entries: the instances, and behind them the parts of those that are opened. */
    struct world_parts parts;
    struct box *box; /* of each entry in the world; empty if the instance is not active */
    /* The triangles that stand for the entries: number i is (lo, hi, lo) of box i, which has
     * exactly that box as its bounds, so that every builder and layout takes it; of an entry that
     * is left out (world_left_out) a point inside the tree. */
    struct scene items;
    /* Items are numbers of entries. Those that are left out are in no leaf, so it does not pass
     * bvh_check_form if there are any. */
    struct bvh top;
    struct bvh *bottom; /* one per mesh */
    uint32_t instance_count, mesh_count;
    enum world_boxes boxes; /* what the boxes are made of */
};

/* Builds the trees of a world that has passed world_finish. Errors: STATUS_LIMIT more than
 * WORLD_INSTANCES_MOST instances; those of world_boxes_make; those of bvh_build, of the first mesh
 * that has one; those of braid_make; of the top, those of bvh_build and STATUS_INPUT a top that
 * lists an entry twice. */
enum status world_trees_make(const struct world *world, const struct world_build *build,
                             struct world_trees *out, struct reason *reason) MUST_USE;

void world_trees_free(struct world_trees *trees); /* a zero one is fine */

/* Which entries the top leaves out, one for each of instance_count + parts->count: instances that
 * are not active, and those that are opened. Caller frees; NULL if out of memory. */
bool *world_left_out(const struct world *world, const struct world_parts *parts) MUST_USE;

/* Makes the triangles that stand for entries. Caller frees with scene_free. Errors:
 * STATUS_MEMORY. */
enum status world_items_make(const struct world *world, const struct world_parts *parts,
                             const struct box *box, struct scene *out,
                             struct reason *reason) MUST_USE;

/* Builds the tree of the entries that are not left out. Errors: of bvh_build; STATUS_INPUT it lists
 * an entry twice; STATUS_MEMORY. */
enum status world_top_make(const struct world *world, const struct world_parts *parts,
                           const struct box *box, const struct builder *builder,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason) MUST_USE;

#endif

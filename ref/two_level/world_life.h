/* The life of the trees of a world: they are built and then, whenever instances or vertices have
 * moved, refitted or built again, both levels alike. */
#ifndef WORLD_LIFE_H
#define WORLD_LIFE_H

#include "ref/packed/life.h"
#include "ref/two_level/packed_world.h"

/* How all trees of a life are made; borrowed. */
struct world_recipe {
    const struct world_build *build;
    const struct layout *top, *bottom;
    const struct tri_store *store;
};

/* The trees after a step. Owns both (world_life_free). */
struct world_life {
    struct world_trees trees; /* what is packed, with the bounds of the world of this step */
    struct packed_world packed;
    enum life_fate fate;
};

/* Computes new boxes for the trees of a world that has moved: those of nodes in both levels, and of
 * instances. The form of all trees is kept. Errors, after which the trees are unchanged:
 * STATUS_INPUT other numbers of instances, meshes or triangles; STATUS_LIMIT "rebuild: ...": a
 * split tree, instances that are opened (ref/two_level/braid.h), another instance is active than
 * when the top was built, one reaches beyond float32; STATUS_MEMORY. */
enum status world_trees_refit(struct world_trees *trees, const struct world *world,
                              struct reason *reason) MUST_USE;

/* The same of a packed world, by packed_refit of each tree; and makes the records of the instances
 * anew. `trees` are refitted ones. A packed world without faults in world_pack_check still has
 * none, and its words are those that packed_world_make gives of these trees. Errors: those of
 * packed_refit and world_records_make, after which the packed world must not be used. */
enum status packed_world_refit(struct packed_world *packed, const struct world_trees *trees,
                               const struct world *world, struct reason *reason) MUST_USE;

/* Builds and packs. Errors: as world_trees_make and packed_world_make. On error *out is zero. */
enum status world_life_begin(const struct world_recipe *recipe, const struct world *world,
                             struct world_life *out, struct reason *reason) MUST_USE;

/* Makes the trees of the next step from those before, which stay: refitted copies, or new ones.
 * `world` has the meshes and instances of the world before, which have moved. Errors:
 * STATUS_MEMORY; of a refit STATUS_INPUT, as above; of new trees as world_life_begin. On error *out
 * is zero. */
enum status world_life_step(const struct world_recipe *recipe, enum life_act act,
                            const struct world *world, const struct world_life *before,
                            struct world_life *out, struct reason *reason) MUST_USE;

void world_life_free(struct world_life *life); /* a zero one is fine */

#endif

/* The life of a packed tree: it is built of a scene and then, whenever the vertices have moved,
 * refitted or built again. */
#ifndef LIFE_H
#define LIFE_H

#include "ref/layout.h"

#define LIFE_STEPS_MOST 8u

/* What is done after the vertices have moved. */
enum life_act { LIFE_REFIT, LIFE_REBUILD, LIFE_ACTS };

/* What was done with a tree. */
enum life_fate {
    LIFE_BUILT,
    LIFE_REFITTED,
    LIFE_REBUILT,
    LIFE_FORCED /* built again in place of a refit, which returned STATUS_LIMIT */
};

/* How all trees of a life are made; borrowed. */
struct life_recipe {
    const struct builder *builder;
    const struct build_options *build;
    const struct tri_store *store;
    const struct layout *layout;
};

/* A tree after a step. Owns both (life_tree_free). */
struct life_tree {
    struct bvh bvh; /* what is packed, with the bounds of the scene of this step */
    struct packed packed;
    enum life_fate fate;
};

/* Builds and packs. Errors: as bvh_build and packed_make_stored. On error *out is zero. */
enum status life_begin(const struct life_recipe *recipe, const struct scene *scene,
                       struct life_tree *out, struct reason *reason) MUST_USE;

/* Makes the tree of the next step from the one before, which stays: a refitted copy, or a new one.
 * `scene` has the triangles of the scene before, with other vertices. Errors: STATUS_MEMORY; of a
 * refit STATUS_INPUT, as packed_refit; of a new tree as life_begin. On error *out is zero. */
enum status life_step(const struct life_recipe *recipe, enum life_act act,
                      const struct scene *scene, const struct life_tree *before,
                      struct life_tree *out, struct reason *reason) MUST_USE;

void life_tree_free(struct life_tree *tree); /* a zero one is fine */

/* "refit" or "rebuild". */
const char *life_act_name(enum life_act act);

#endif

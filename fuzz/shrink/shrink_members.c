/* The pass over members and parameters, and the order of all passes. */
#include "fuzz/shrink/shrink_inner.h"

#include <string.h>

extern const struct shrink_pass shrink_steps, shrink_rays, shrink_ends, shrink_triangles,
    shrink_trees, shrink_pairs, shrink_repeat, shrink_tidy, shrink_merge, shrink_values,
    shrink_planes, shrink_numbers, shrink_carrying, shrink_ranks, shrink_frame, shrink_aim,
    shrink_instances, shrink_geometries, shrink_instance_members, shrink_modes, shrink_filter,
    shrink_places, shrink_world_frame;

uint32_t shrink_one(const struct fuzz_trial *trial)
{
    (void)trial;
    return 1;
}

/* Members of a table that are tried, from its first on. */
#define MEMBERS_MOST 8u
enum {
    QUERY = 3 * MEMBERS_MOST,
    EPS,
    EPS_ZERO,
    LEAF,
    LEAF_HALF,
    LEAF_LESS,
    LEAF_ONE,
    STORE,
    PASSES,
    PASSES_ONE,
    REINSERTS,
    WHOLE,
    PARTS_ROUND,
    STILL,
    MOVE_LESS,
    MOVE_ROUND,
    MOVE_SEED,
    MEMBER_CHANGES
};

static bool change_leaf(struct fuzz_trial *trial, uint32_t leaf)
{
    trial->build.leaf = leaf ? leaf : 1;
    return true;
}

/* Member `at` of a table, in *to. */
#define CHANGE_MEMBER(table, at, to)                                                               \
    for (uint32_t i = 0; (table)[i]; i++)                                                          \
        if (i == (at)) {                                                                           \
            *(to) = (table)[i];                                                                    \
            return true;                                                                           \
        }                                                                                          \
    return false

static bool change_builder(struct fuzz_trial *trial, uint32_t at)
{
    CHANGE_MEMBER(builders, at, &trial->builder);
}

static bool change_box(struct fuzz_trial *trial, uint32_t at)
{
    CHANGE_MEMBER(box_tests, at, &trial->box);
}

static bool change_tri(struct fuzz_trial *trial, uint32_t at)
{
    CHANGE_MEMBER(tri_tests, at, &trial->tri);
}

/* What the tree went through, and how its triangles lie. */
static bool change_past(struct fuzz_trial *trial, uint32_t variant)
{
    switch (variant) {
    case STORE:
        trial->store = tri_stores[0];
        return true;
    case PASSES:
        trial->build.passes = 0;
        trial->build.rotates = false;
        return true;
    case PASSES_ONE:
        trial->build.passes = trial->build.passes > 0;
        return true;
    case REINSERTS:
        trial->build.rotates = false;
        return true;
    case WHOLE:
        trial->build.presplit = 0;
        return true;
    case PARTS_ROUND:
        trial->build.presplit = trial->build.presplit > 0;
        return true;
    case STILL:
        trial->move = 0;
        trial->move_seed = 0;
        return true;
    case MOVE_LESS:
        trial->move /= 2;
        return trial->move > 0;
    case MOVE_ROUND:
        trial->move = trial->move > 0;
        return true;
    default: /* MOVE_SEED */
        trial->move_seed = 0;
        return true;
    }
}

static bool change_member(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                          uint32_t variant)
{
    static bool (*const tables[])(struct fuzz_trial *, uint32_t) = {change_builder, change_box,
                                                                    change_tri};
    (void)first, (void)count;
    if (variant < QUERY)
        return tables[variant / MEMBERS_MOST](trial, variant % MEMBERS_MOST);
    switch (variant) {
    case QUERY:
        trial->query = QUERY_CLOSEST;
        return true;
    case EPS:
        trial->build.eps = BUILD_EPS_DEFAULT;
        return true;
    case EPS_ZERO:
        trial->build.eps = 0;
        return true;
    case LEAF:
        return change_leaf(trial, BUILD_LEAF_DEFAULT);
    case LEAF_HALF:
        return change_leaf(trial, trial->build.leaf / 2);
    case LEAF_LESS:
        return change_leaf(trial, trial->build.leaf - 1);
    case LEAF_ONE:
        return change_leaf(trial, 1);
    default:
        return change_past(trial, variant);
    }
}

static const struct shrink_pass members = {"members", SHRINK_SINGLY, shrink_one, MEMBER_CHANGES,
                                           change_member};

const struct shrink_pass *const shrink_passes[] = {&shrink_steps,
                                                   &shrink_rays,
                                                   &shrink_instances,
                                                   &shrink_ends,
                                                   &shrink_triangles,
                                                   &shrink_trees,
                                                   &shrink_pairs,
                                                   &shrink_repeat,
                                                   &shrink_tidy,
                                                   &shrink_merge,
                                                   &shrink_geometries,
                                                   &shrink_filter,
                                                   &shrink_instance_members,
                                                   &shrink_modes,
                                                   &shrink_places,
                                                   &shrink_world_frame,
                                                   &shrink_aim,
                                                   &shrink_ranks,
                                                   &shrink_frame,
                                                   &shrink_planes,
                                                   &shrink_values,
                                                   &shrink_numbers,
                                                   &shrink_carrying,
                                                   &members,
                                                   NULL};

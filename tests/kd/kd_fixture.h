/* Scenes and their k-d trees, walked leaf by leaf with the voxels. */
#ifndef TESTS_KD_FIXTURE_H
#define TESTS_KD_FIXTURE_H

#include "ref/kd/kd.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"

#define KD_SCENES (BUILT_SCENES + 5u)

/* Those that are hard to build trees of, and some whose triangles lie in planes of others. */
static inline struct scene kd_scene(size_t i, const char **what)
{
    static const char *const spec[] = {"needles:n=300", "grid:n=12", "cornell", "sphere:n=12",
                                       "stack"};
    struct scene scene = {0};
    struct reason reason = {""};
    if (i < BUILT_SCENES)
        return built_scene(i, what);
    *what = spec[i - BUILT_SCENES];
    if (scene_open(*what, 1, &scene, &reason))
        fail_msg("%s: %s", *what, reason.text);
    return scene;
}

static inline struct kd_tree kd_tree_of(const struct scene *scene, const char *what)
{
    struct kd_tree tree;
    struct reason reason = {""};
    if (kd_make(scene, &tree, &reason))
        fail_msg("%s: %s", what, reason.text);
    return tree;
}

typedef void kd_leaf_fn(void *user, const struct kd_node *leaf, const struct box *voxel,
                        uint32_t depth);

/* Calls `each` for every leaf below a node; the nodes on the way are checked. */
static inline void kd_each_leaf(const struct kd_tree *tree, uint32_t number, struct box voxel,
                                uint32_t depth, kd_leaf_fn *each, void *user)
{
    assert_true(number < tree->node_count);
    const struct kd_node *node = &tree->node[number];
    uint32_t axis = node->what & 3u;
    if (axis == KD_LEAF) {
        each(user, node, &voxel, depth);
        return;
    }
    assert_true(voxel.lo[axis] < node->at && node->at < voxel.hi[axis]);
    assert_true(node->what >> 2 > number);
    for (uint32_t side = 0; side < 2; side++) {
        struct box half = voxel;
        *(side ? &half.lo[axis] : &half.hi[axis]) = node->at;
        kd_each_leaf(tree, (node->what >> 2) + side, half, depth + 1, each, user);
    }
}

#endif

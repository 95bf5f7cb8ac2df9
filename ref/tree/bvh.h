/* The canonical binary tree that every builder makes and every layout packs. */
#ifndef BVH_H
#define BVH_H

#include "ref/scene/scene.h"

/* A node. Inner: item_count == 0, children fst and snd, item_first = items emitted before it (as
 * RTRS's file has it). Leaf: fst == snd == 0, triangles prim[item_first .. +item_count-1]. */
struct bvh_node {
    struct box bounds;
    uint32_t fst;
    uint32_t snd;
    uint32_t item_first;
    uint32_t item_count;
};

/* Owns its arrays (see bvh_free). Nodes are in pre-order: node 0 is the root, fst is the own index
 * plus 1, the whole fst subtree comes before snd. An empty scene has node_count 0.
 * A split tree (bvh_is_split) has triangles in several leaves, each of which needs to contain only
 * its part of the triangle; no leaf has one twice. */
struct bvh {
    struct bvh_node *node;
    uint32_t *prim; /* triangles in leaf order: each of 0 .. tri_count - 1, once or more often */
    uint32_t node_count;
    uint32_t prim_count; /* entries of prim */
    uint32_t tri_count;  /* of the scene; at most prim_count */
};

static inline bool bvh_is_split(const struct bvh *bvh)
{
    return bvh->prim_count > bvh->tri_count;
}

struct bvh_stats {
    uint32_t node_count, leaf_count, depth /* root is 0 */, largest_leaf;
    uint32_t loose_count; /* inner nodes whose box does not contain their triangles; of a split
                             tree triangles of which a part is in no leaf's box */
};

/* 0 in the members after eps is their default. */
struct build_options {
    uint32_t leaf;      /* items per leaf: at most, aimed at (rtrs); >= 1 */
    float eps;          /* rtrs: a node whose longest side is below eps / 2 is not split */
    uint32_t bins;      /* sah_binned: bins per axis, up to 64; BUILD_BINS_DEFAULT */
    uint32_t radius;    /* ploc: neighbours compared on either side; BUILD_RADIUS_DEFAULT */
    uint32_t passes;    /* of reinsertion, by bvh_build; none */
    uint32_t threads;   /* the tree does not depend on it; all */
    float split_budget; /* sbvh: so many items more than triangles at most, in parts of these; below
                           0: none; BUILD_SPLIT_BUDGET_DEFAULT */
    float split_alpha; /* sbvh: overlap of children in parts of the root's area that is worth a look
                          for planes; below 0: any; BUILD_SPLIT_ALPHA_DEFAULT */
};

#define BUILD_LEAF_DEFAULT         4u
#define BUILD_EPS_DEFAULT          0.02f
#define BUILD_BINS_DEFAULT         16u
#define BUILD_BINS_MOST            64u
#define BUILD_RADIUS_DEFAULT       16u
#define BUILD_RADIUS_MOST          256u
#define BUILD_SPLIT_BUDGET_DEFAULT 1.0f
#define BUILD_SPLIT_BUDGET_MOST    64.0f
#define BUILD_SPLIT_ALPHA_DEFAULT  1e-5f
#define BUILD_PASSES_DEFAULT       4u /* if passes are requested without a number */

/* Whether the items prim[first .. first + count - 1] can be one leaf: no triangle is there twice.
 * True at once of trees that are not split. */
bool bvh_items_differ(const struct bvh *bvh, uint32_t first, uint32_t count);

/* A builder. `build` reads a checked scene and makes *out; 0 triangles give an empty tree.
 * Errors: STATUS_INPUT leaf is 0; STATUS_LIMIT it would never end (reason); STATUS_MEMORY. */
struct builder {
    const char *name;
    const char *summary;
    bool faithful; /* reproduces RTRS, faults included: its trees may fail bvh_check */
    enum status (*build)(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason);
    uint32_t tri_bytes; /* that building takes at least for each triangle, the tree included; of
                           sbvh for each item */
    const char *takes;  /* options of struct build_options that it reads beyond leaf and threads, as
                           the command line names them, blanks between; NULL: none */
};

/* NULL-terminated: the builders that every product of tests runs over; the first is the default. */
extern const struct builder *const builders[];

/* NULL-terminated: these, in the same order, then all others; the order of listings. */
extern const struct builder *const builders_all[];

/* Returns the builder of that name, of all, or NULL. */
const struct builder *builder_find(const char *name);

/* Bytes that building takes at least, by bvh_build, the tree included, the scene not: with leaves
 * of few triangles it can be several times as many. */
uint64_t bvh_build_bytes(const struct builder *builder, uint32_t tri_count,
                         const struct build_options *options);

/* Builds, and moves subtrees to better places, options->passes times over the tree. With passes a
 * builder that keeps to the leaf size makes leaves of one triangle first, which become leaves of up
 * to `leaf` where that costs less. Errors: those of builders; STATUS_INPUT passes for a builder
 * that is faithful, whose cut boxes would not stay; STATUS_MEMORY, before anything is done, more
 * bvh_build_bytes than ref/base/memory.h has left. */
enum status bvh_build(const struct builder *builder, const struct scene *scene,
                      const struct build_options *options, struct bvh *out,
                      struct reason *reason) MUST_USE;

/* Exact bounds of the triangles below each node of a well-formed tree, which its own box may lack;
 * node_count of them. Caller frees; NULL without memory. */
struct box *bvh_exact_bounds(const struct bvh *bvh, const struct scene *scene) MUST_USE;

/* Frees what the tree owns and zeroes it. */
void bvh_free(struct bvh *bvh);

/* Counts; a tree must be well formed (see bvh_check_form). All 0 for an empty tree, and without
 * memory. */
struct bvh_stats bvh_stats(const struct bvh *bvh, const struct scene *scene);

/* Checks the form: pre-order, children in range and after their parent, each node reached once,
 * each triangle of the scene in exactly one leaf; of a split tree at least in one, and in no leaf
 * twice. Safe on hostile data.
 * Errors: STATUS_INPUT with the node and the rule. */
enum status bvh_check_form(const struct bvh *bvh, const struct scene *scene,
                           struct reason *reason) MUST_USE;

/* bvh_check_form, and every node's box contains the exact bounds of its triangles; of a split tree
 * the leaves' boxes together cover every triangle (ref/tree/cover.h). */
enum status bvh_check(const struct bvh *bvh, const struct scene *scene,
                      struct reason *reason) MUST_USE;

#endif

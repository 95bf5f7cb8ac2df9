/* The canonical binary tree: output of every builder, input of every layout. */
#ifndef BVH_H
#define BVH_H

#include "ref/scene/scene.h"

/* A node. Inner: item_count == 0, children fst and snd, item_first = number of items before it (as
 * in RTRS's file). Leaf: fst == snd == 0, triangles prim[item_first .. +item_count-1]. */
struct bvh_node {
    struct box bounds;
    uint32_t fst;
    uint32_t snd;
    uint32_t item_first;
    uint32_t item_count;
};

/* Owns its arrays (see bvh_free). Nodes are in pre-order: node 0 is the root, fst is the node's own
 * index plus 1, the whole subtree of fst comes before snd. An empty scene has node_count 0. A split
 * tree (bvh_is_split) lists triangles in several leaves, each of which only needs to contain its
 * part of the triangle; no leaf lists a triangle twice. */
struct bvh {
    struct bvh_node *node;
    uint32_t *prim; /* triangles in leaf order: each of 0 .. tri_count - 1, at least once */
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
    uint32_t loose_count; /* inner nodes whose box does not contain their triangles; in a split tree
                             the triangles with a part in no leaf's box */
};

/* In the members after eps 0 means the default, given at the end of each comment. */
struct build_options {
    uint32_t leaf;      /* most items per leaf; rtrs: the target; >= 1 */
    float eps;          /* rtrs: a node whose longest side is below eps / 2 is not split */
    uint32_t bins;      /* sah_binned: bins per axis, up to 64; BUILD_BINS_DEFAULT */
    uint32_t radius;    /* ploc: neighbours compared on either side; BUILD_RADIUS_DEFAULT */
    uint32_t passes;    /* optimization passes in bvh_build; none */
    bool rotates;       /* they are rotations, not reinsertion */
    uint32_t threads;   /* does not affect the tree; all */
    float split_budget; /* sbvh: most additional items, as a fraction of the triangles; below 0:
                           none; BUILD_SPLIT_BUDGET_DEFAULT */
    float presplit;     /* those that take it: most items beyond one a triangle that are made before
                           the build, as a fraction of the triangles; BUILD_PRESPLIT_MOST at most;
                           none */
    float split_alpha;  /* sbvh: least overlap of the children, as a fraction of the root's area, at
                           which planes are tried; below 0: any; BUILD_SPLIT_ALPHA_DEFAULT */
};

#define BUILD_LEAF_DEFAULT         4u
#define BUILD_EPS_DEFAULT          0.02f
#define BUILD_BINS_DEFAULT         16u
#define BUILD_BINS_MOST            64u
#define BUILD_RADIUS_DEFAULT       16u
#define BUILD_RADIUS_MOST          256u
#define BUILD_SPLIT_BUDGET_DEFAULT 1.0f
#define BUILD_SPLIT_BUDGET_MOST    64.0f
#define BUILD_PRESPLIT_MOST        64.0f
#define BUILD_SPLIT_ALPHA_DEFAULT  1e-5f
#define BUILD_PASSES_DEFAULT       4u /* if passes are requested without a number */

/* True if the items prim[first .. first + count - 1] can be one leaf: no triangle occurs twice.
 * Returns true immediately for trees that are not split. */
bool bvh_items_differ(const struct bvh *bvh, uint32_t first, uint32_t count);

/* What a builder that works through a stream moves: sweeps over it, and boxes read and written in
 * all of them. */
struct build_traffic {
    uint32_t sweeps;
    uint64_t boxes_read, boxes_written;
};

/* A box and the number of its node. */
#define BUILD_TRAFFIC_BYTES 28u

/* A builder. `build` reads a checked scene and makes *out; 0 triangles give an empty tree. Errors:
 * STATUS_INPUT leaf is 0; STATUS_LIMIT it would not terminate (with the reason); STATUS_MEMORY. */
struct builder {
    const char *name;
    const char *summary;
    bool faithful; /* reproduces RTRS, faults included: its trees may fail bvh_check */
    enum status (*build)(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason);
    uint32_t tri_bytes; /* least memory of a build per triangle, the tree included; sbvh: per
                           item */
    /* Counts what a build moves; NULL for a builder that is no stream. Errors: those of `build`. */
    enum status (*traffic)(const struct scene *scene, const struct build_options *options,
                           struct build_traffic *out, struct reason *reason);
    const char *takes; /* options of struct build_options that it reads besides leaf and threads,
                           named as on the command line, separated by blanks; NULL: none */
    /* Set only if a device builds: `build` then also fails with STATUS_UNSUPPORTED where there is
     * none, and with STATUS_DEVICE. Builds in C what the device builds, and compares, stage by
     * stage. Errors: STATUS_DEVICE the first difference; as build. */
    enum status (*compare)(const struct scene *scene, struct reason *reason);
    const char *twin; /* with `compare`: the builder in C that makes the same tree */
};

/* NULL-terminated: the builders that every product of tests runs over; the first is the default. */
extern const struct builder *const builders[];

/* NULL-terminated: these, in the same order, then all others, in the order of listings, then those
 * added with builder_add. */
extern const struct builder *const *const builders_all;

#define BUILDERS_ADDED_MOST 4

/* Adds a builder at the end of builders_all; it is borrowed until the program ends. Call it only
 * while no other thread reads the table. Errors: STATUS_INPUT the name is already in use;
 * STATUS_LIMIT more than BUILDERS_ADDED_MOST. */
enum status builder_add(const struct builder *builder, struct reason *reason) MUST_USE;

/* Returns the builder of that name among all, or NULL. */
const struct builder *builder_find(const char *name);

/* True if the builder reads that option, one of `takes`. */
bool builder_takes(const struct builder *builder, const char *option);

/* Returns the least number of bytes that bvh_build needs, including the tree but not the scene.
 * With leaves of few triangles it can be several times as much. */
uint64_t bvh_build_bytes(const struct builder *builder, uint32_t tri_count,
                         const struct build_options *options);

/* "rotate" or "reinsert": what options->passes are. */
static inline const char *build_optimization(const struct build_options *options)
{
    return options->rotates ? "rotate" : "reinsert";
}

/* Builds, then moves subtrees to better places in options->passes passes over the tree
 * (ref/builders/reinsert.h, rotate.h). With passes, a builder that respects the leaf size first
 * makes leaves of one triangle; these are merged into leaves of up to `leaf` where that costs less.
 * Errors: those of builders; STATUS_INPUT passes with a faithful builder, whose cut boxes would not
 * be kept; STATUS_MEMORY, checked first: bvh_build_bytes exceeds the memory left
 * (ref/base/memory.h). */
enum status bvh_build(const struct builder *builder, const struct scene *scene,
                      const struct build_options *options, struct bvh *out,
                      struct reason *reason) MUST_USE;

/* Returns the exact bounds of the triangles below each node of a well-formed tree, node_count of
 * them; a node's own box may be too small. Caller frees; NULL if out of memory. */
struct box *bvh_exact_bounds(const struct bvh *bvh, const struct scene *scene) MUST_USE;

/* Frees the tree's arrays and zeroes it. */
void bvh_free(struct bvh *bvh);

/* Counts nodes; the tree must be well formed (see bvh_check_form). *out is all 0 for an empty tree,
 * and after STATUS_MEMORY. */
enum status bvh_count(const struct bvh *bvh, const struct scene *scene, struct bvh_stats *out,
                      struct reason *reason) MUST_USE;

/* Checks the form: pre-order, children in range and after their parent, each node reached once,
 * each triangle of the scene in exactly one leaf; in a split tree in at least one, and in no leaf
 * twice. Safe on hostile data. Errors: STATUS_INPUT with the node and the rule. */
enum status bvh_check_form(const struct bvh *bvh, const struct scene *scene,
                           struct reason *reason) MUST_USE;

/* Runs bvh_check_form and checks that every node's box contains the exact bounds of its triangles;
 * in a split tree, that the leaves' boxes together cover every triangle (ref/tree/cover.h). */
enum status bvh_check(const struct bvh *bvh, const struct scene *scene,
                      struct reason *reason) MUST_USE;

#endif

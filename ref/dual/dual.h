/* Dual-split trees: a binary tree of boxes, stored as two planes a node. */
#ifndef DUAL_H
#define DUAL_H

#include "ref/engine.h"
#include "ref/trace/trace.h"

/* After Lin, Shkurko, Mallett and Yuksel 2019, "Dual-Split Trees": a node splits, which gives the
 * lower child an upper plane and the upper child a lower plane on one axis, or it carves two planes
 * off what is below it, or it is a leaf. The box of a node is what all planes above leave of the
 * root's box: its implied box. The packing into words is our own:
 *
 *   split   axis, and from bit 2 on the word of the upper child; the lower child's upper plane; the
 *           upper child's lower plane; then the lower child
 *   carve   DUAL_OTHER, DUAL_CARVES, from bit 3 on a side in 3 bits, from bit 6 on another; the
 *           plane of the first side; that of the other; then the only child
 *   leaf    DUAL_OTHER, and from bit 3 on how many items; the first item, as in struct wide
 *
 * Planes are float32. Side k is the lower bound of axis k, side 3 + k the upper one. */
#define DUAL_OTHER       3u
#define DUAL_CARVES      4u
#define DUAL_NODE_WORDS  3u
#define DUAL_LEAF_WORDS  2u
#define DUAL_SHIFT       2
#define DUAL_COUNT_SHIFT 3
#define DUAL_SIDES       6u
#define DUAL_WORDS_MOST  ((uint32_t)1 << 30)
#define DUAL_COUNT_MOST  ((uint32_t)1 << 29)
#define DUAL_DEPTH_MOST  ABI_STACK_MAX /* splits above a leaf: what may wait on the stack */

/* Owns `word`. A tree without triangles has no words. */
struct dual_tree {
    uint32_t *word; /* the root is at word 0 */
    struct box box; /* the root's implied box */
    uint32_t word_count, split_count, carve_count, leaf_count;
    uint32_t depth; /* splits above the deepest leaf */
};

/* What is carved. */
enum dual_carving {
    DUAL_BY_COST, /* what costs less: ref/dual/dual_cost.h */
    DUAL_ALL,     /* until every implied box is the node's own */
};

/* Makes the tree of a binary packed tree. A node's box is the decoded one with those below it, and
 * lies in its implied box; leaves have the items of the packed tree. Errors: STATUS_UNSUPPORTED a
 * wide layout; STATUS_LIMIT the decoded words are no tree, one of more than DUAL_DEPTH_MOST levels,
 * or more than DUAL_WORDS_MOST words; STATUS_MEMORY. On error *out is zero. */
enum status dual_make(const struct packed *packed, enum dual_carving carving, struct dual_tree *out,
                      struct reason *reason) MUST_USE;

/* A zero tree is allowed. */
void dual_free(struct dual_tree *tree);

static inline uint64_t dual_node_bytes(const struct dual_tree *tree)
{
    return 4 * (uint64_t)tree->word_count;
}

/* Checks a tree, hostile words too, against the packed tree that it was made of: nodes follow one
 * another without a gap, each leaf of the packed tree is there once with its items, its box and
 * (unless the packed tree is split) its triangles lie in its implied box, exactly. Errors:
 * STATUS_INPUT with the word and the rule; STATUS_MEMORY. */
enum status dual_check(const struct dual_tree *tree, const struct packed *packed,
                       const struct scene *scene, struct reason *reason) MUST_USE;

/* Traces a ray for job->query, closest or any, with job->tri, through a tree that was made of
 * job->packed. Boxes are tested as by slab_watertight, whatever job->box; hits as in trace_ray.
 *   counts  added to: planes under boxes; may be NULL */
void dual_ray(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
              struct hit *out, struct trace_counts *counts);

/* Finds every triangle that the ray hits; `out`, `count` and twice found ones as trace_ray_all. */
void dual_ray_all(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
                  uint32_t capacity, struct hit *out, uint32_t *count, struct trace_counts *counts);

/* As dual_ray, closest hits, and calls `read` for each node that is read: its word, and how many.
 * Items are read through job->packed. */
typedef void dual_read_fn(void *reader, uint32_t word, uint32_t words);
struct hit dual_watched(const struct dual_tree *tree, const struct job *job, const struct ray *ray,
                        dual_read_fn *read, void *reader);

#endif

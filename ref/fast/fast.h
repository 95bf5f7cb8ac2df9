/* A tree made to be traced fast: 8-wide nodes of 128 bytes, bounds of 16 bits in the scene's frame,
 * leaves of up to 8 triangles that share their vertices (ref/fast/block.h). Woop's test on them has
 * the operations of tri_woop, so that a hit has its bits; boxes are tested as CONTRIBUTING,
 * "Boxes", proves it for the fast ones. Nothing but nodes and blocks is read. */
#ifndef FAST_H
#define FAST_H

#include "ref/abi.h"
#include "ref/tree/bvh.h"

#define FAST_WIDTH 8u
#define FAST_STACK 256u /* entries of the traversal's stack */
#define FAST_PAIRS 8u   /* MB; larger trees are traced in pairs of rays (ref/fast/fast_pair.h) */

/* A node. Those of a tree are aligned to their size. Bound q of axis k is lo[k] + step[k] * q of
 * the tree. Absent children have reference 0, lower bounds 65535 and upper bounds 0. */
struct fast_node {
    uint16_t bound[2][3][FAST_WIDTH]; /* lower and upper; axis; child */
    uint32_t ref[FAST_WIDTH];
};
_Static_assert(sizeof(struct fast_node) == 128, "two lines");

/* A reference is the number of a node, or of a leaf: this bit, in bits 27 to 30 its vertices less
 * one, in bits 0 to 26 the first word of its block. */
#define FAST_LEAF       0x80000000u
#define FAST_LEAF_COUNT 27
#define FAST_LEAF_WORDS 0x08000000u

/* Owns its arrays (see fast_free). Without triangles it has no nodes. */
struct fast_tree {
    _Alignas(16) float lo[4]; /* of the frame; the fourth is 0 */
    _Alignas(16) float step[4];
    _Alignas(16) float extent[4]; /* step * 65535, rounded up */
    float reach;                  /* rays whose origin is farther go the careful way */
    struct box bounds;
    struct fast_node *node;
    uint32_t *block;
    uint64_t block_words;
    uint32_t node_count;
    uint32_t stack_need;
    bool in_pairs; /* kernels take two rays at once: the tree is larger than caches */
};

/* Makes the tree from a binary one whose form was checked: the cheapest collapse (ref/tree/wide_tree.h).
 * Errors: STATUS_LIMIT a traversal could need more than FAST_STACK entries, or the blocks are
 * larger than 512 MB; STATUS_MEMORY. On error *out is zero. */
enum status fast_make(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                      struct reason *reason) MUST_USE;

void fast_free(struct fast_tree *tree);

/* Bytes that a traversal reads. */
static inline uint64_t fast_bytes(const struct fast_tree *tree)
{
    return sizeof(struct fast_node) * (uint64_t)tree->node_count + 4 * tree->block_words;
}

/* The traversal for one kind of processor. All give the same hits, but where triangles are hit at
 * the same t; of any hits they may find different ones. */
struct fast_kernel {
    const char *name;
    bool (*runs)(void); /* on this processor */
    void (*closest)(const struct fast_tree *tree, const struct ray *ray, size_t count,
                    struct hit *hit);
    void (*any)(const struct fast_tree *tree, const struct ray *ray, size_t count, struct hit *hit);
};

/* NULL-terminated, the fastest first; the last runs everywhere. */
extern const struct fast_kernel *const fast_kernels[];

/* The first that runs here. */
const struct fast_kernel *fast_kernel_best(void);

/* Every triangle that the ray hits, as trace_ray_all (ref/trace/trace.h) lists them; returns how many. */
uint32_t fast_all(const struct fast_tree *tree, const struct ray *ray, uint32_t capacity,
                  struct hit *hit);

/* What kernels leave to it: rays out of contract, and those at the ends of it, whose numbers could
 * overflow in a kernel. Plain, with slab_watertight on the decoded boxes. */
void fast_careful(const struct fast_tree *tree, const struct ray *ray, bool any, struct hit *hit);

/* The same, and calls `read` for all that a kernel would read of nodes and blocks, which it visits
 * in the same order but for children whose entry distances differ by their rounding alone (of any
 * hits: nearest first): whole nodes, corners and vertices of a block, and the number of a triangle
 * that becomes the nearest. */
typedef void fast_read_fn(void *reader, const void *at, size_t bytes);
void fast_watched(const struct fast_tree *tree, const struct ray *ray, bool any, fast_read_fn *read,
                  void *reader, struct hit *hit);

#endif

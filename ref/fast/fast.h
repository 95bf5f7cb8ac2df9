/* A tree for fast traversal: 8-wide nodes of 128 bytes, 16-bit bounds in the scene's frame, and
 * leaves of up to 8 triangles that share vertices (ref/fast/block.h). The triangle test performs
 * the operations of tri_woop, so hits have the same bits. The box test is proved in
 * docs/numerics.md, "Boxes", fast. A traversal reads nothing but nodes and blocks. */
#ifndef FAST_H
#define FAST_H

#include "ref/abi.h"
#include "ref/fast/tiny_form.h"
#include "ref/tree/bvh.h"

#define FAST_WIDTH      8u
#define FAST_SMALL_NODE 80u  /* bytes of a node of ref/fast/small_tree.h */
#define FAST_STACK      256u /* entries of the traversal's stack */
#define FAST_PAIRS      8u   /* MB; from this size on, two rays at once: kernel/fast_pair.h */

/* Triangles side by side over which rays are alike, measured on dragons: beyond it rays in turns
 * are faster than packets. */
#define FAST_PACKET_TRIS 24.0f

/* A node, aligned to its size in a tree. Code q of axis k is the bound lo[k] + step[k] * q of the
 * tree. Absent children have reference 0, lower bounds 65535 and upper bounds 0. */
struct fast_node {
    uint16_t bound[2][3][FAST_WIDTH]; /* lower and upper; axis; child */
    uint32_t ref[FAST_WIDTH];
};
_Static_assert(sizeof(struct fast_node) == 128, "two lines");

/* A reference is the number of a node, or a leaf: bit 31 set, in bits 27 to 30 its vertex count
 * less one, in bits 0 to 26 the first word of its block. */
#define FAST_LEAF       0x80000000u
#define FAST_LEAF_COUNT 27
#define FAST_LEAF_WORDS 0x08000000u

/* Owns its arrays (see fast_free). A tree without triangles has no nodes. */
struct fast_tree {
    _Alignas(16) float lo[4]; /* of the frame; the fourth element is 0 */
    _Alignas(16) float step[4];
    _Alignas(16) float extent[4]; /* step * 65536 */
    float reach;                  /* rays with a farther origin are traced by fast_careful */
    struct box bounds;
    struct fast_node *node;
    struct fast_small_node *small; /* or these: ref/fast/small_tree.h */
    bool is_tiny;                  /* its blocks are those of ref/fast/tiny_block.h */
    struct tiny_form tiny;
    uint32_t *block;
    uint64_t block_words;
    uint32_t node_count;
    uint32_t stack_need;
    bool in_packets;    /* kernels with 16 lanes trace rays together that are alike:
                        kernel/fast_packet.h */
    float packet_width; /* as far apart such rays may be in the scene's middle */
    bool in_stream;     /* the same kernels trace the other rays in turns: kernel/fast_stream.h */
    bool in_pairs;      /* kernels trace two rays at once: the tree is larger than caches */
};

/* Makes the tree from a binary one whose form has been checked, by the cheapest collapse
 * (ref/tree/wide_tree.h). Errors: STATUS_LIMIT a traversal could need more than FAST_STACK entries,
 * or the blocks are larger than 512 MB; STATUS_MEMORY. On error *out is zero. */
enum status fast_make(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                      struct reason *reason) MUST_USE;

/* The same in the form of ref/fast/small_tree.h, of which most meshes take less than 14 bytes a
 * triangle. The blocks may take 8192 MB. */
enum status fast_make_small(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                            struct reason *reason) MUST_USE;

/* The same with leaves of up to 48 triangles, whose vertices lie on the scene's grid; on one of 12
 * bits most meshes take 6 bytes a triangle. Errors: STATUS_UNSUPPORTED also a scene without a grid
 * of at most QUANTISE_BITS_MOST bits (ref/scene/quantise.h). */
enum status fast_make_tiny(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                           struct reason *reason) MUST_USE;

/* As fast_make, for items that are not triangles, each in a leaf of its own: its reference is
 * FAST_LEAF and the item's number, below 2^31. There are no blocks.
 *   items  triangles with the items' bounds, which are of the same numbers */
enum status fast_make_items(const struct bvh *bvh, const struct scene *items, struct fast_tree *out,
                            struct reason *reason) MUST_USE;

void fast_free(struct fast_tree *tree);

/* Bytes of a node. */
static inline size_t fast_node_bytes(const struct fast_tree *tree)
{
    return tree->small ? FAST_SMALL_NODE : sizeof(struct fast_node);
}

/* Bytes of nodes and blocks. */
static inline uint64_t fast_bytes(const struct fast_tree *tree)
{
    return fast_node_bytes(tree) * (uint64_t)tree->node_count + 4 * tree->block_words;
}

struct fast_world;
struct packed;
struct ray_mode;

/* The traversal for one kind of processor. Closest hits are the same in all kernels, except where
 * several triangles are hit at the same t. Any-hit queries may find different hits. */
struct fast_kernel {
    const char *name;
    bool (*runs)(void); /* returns true if this processor can run it */
    void (*closest)(const struct fast_tree *tree, const struct ray *ray, size_t count,
                    struct hit *hit);
    void (*any)(const struct fast_tree *tree, const struct ray *ray, size_t count, struct hit *hit);
    /* Traces rays through a world (ref/fast/fast_world.h); hits and tags as those of
     * trace_world_ray (ref/trace/trace_world.h). `mode` may be NULL: ray_mode_all() for all. */
    void (*world)(const struct fast_world *fast, const struct ray *ray, const struct ray_mode *mode,
                  size_t count, bool any, struct hit *hit, uint32_t *tag);
};

/* NULL-terminated, fastest first. The last one runs everywhere. Those for small and tiny trees
 * trace no worlds: their `world` is NULL. */
extern const struct fast_kernel *const fast_kernels[], *const fast_small_kernels[],
                                                           *const fast_tiny_kernels[];

/* The first kernel that runs on this processor. */
const struct fast_kernel *fast_kernel_best(void);
const struct fast_kernel *fast_small_kernel_best(void);
const struct fast_kernel *fast_tiny_kernel_best(void);

/* The forms of trees. */
struct fast_form {
    const char *name;
    enum status (*make)(const struct bvh *bvh, const struct scene *scene, struct fast_tree *out,
                        struct reason *reason);
    const struct fast_kernel *const *kernels;
    const struct fast_kernel *(*kernel)(void); /* the first that runs here */
};

extern const struct fast_form fast_forms[3]; /* fast, fast_small, fast_tiny */

/* The form of the trees that engine fast makes of a packed tree, or fast_small: tiny ones where the
 * storage is `quantised`, which has moved the vertices onto a grid, else small ones. */
const struct fast_form *fast_form_of(bool small, const struct packed *packed);

/* Finds all triangles that the ray hits, written as trace_ray_all (ref/trace/trace.h) does. Returns
 * their number, which may be over `capacity`. */
uint32_t fast_all(const struct fast_tree *tree, const struct ray *ray, uint32_t capacity,
                  struct hit *hit);

/* Traces a ray that a kernel does not: out of contract, or near its limits, where numbers in a
 * kernel could overflow. Scalar code, with slab_watertight on the decoded boxes. */
void fast_careful(const struct fast_tree *tree, const struct ray *ray, bool any, struct hit *hit);

/* As fast_careful, and calls `read` for all that a kernel would read: whole nodes, corners and
 * vertices of a block, and the number of each triangle that becomes the nearest. The order is a
 * kernel's except among children whose entry distances differ only by rounding. In an any-hit query
 * it is nearest first. */
typedef void fast_read_fn(void *reader, const void *at, size_t bytes);
void fast_watched(const struct fast_tree *tree, const struct ray *ray, bool any, fast_read_fn *read,
                  void *reader, struct hit *hit);

#endif

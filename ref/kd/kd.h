/* A k-d tree by the surface area heuristic, and rays through it. Space is divided by planes, so
 * that a triangle lies in every leaf whose voxel it reaches. */
#ifndef KD_H
#define KD_H

#include "ref/kd/accel.h"
#include "ref/scene/scene.h"

/* 8 bytes. Inner: the plane, its axis and the left child; the right one is next to it. Leaf: the
 * first of its items and how many. */
struct kd_node {
    union {
        float at;
        uint32_t first;
    };
    uint32_t what; /* its lowest two bits: the axis or KD_LEAF; above them the child or the count */
};

#define KD_LEAF 3u

/* Deeper than any tree: 8 + 1.3 log2 of KD_TRIS_MOST is 45. */
#define KD_DEPTH_MOST 46
#define KD_TRIS_MOST  ((uint32_t)1 << 29)

/* Owns its arrays. A scene without triangles has no nodes. */
struct kd_tree {
    struct kd_node *node; /* the root is the first */
    uint32_t *item;       /* numbers of triangles, leaf by leaf */
    struct tri_accel *tri;
    struct box box; /* of the scene: the root's voxel */
    uint32_t node_count, item_count, tri_count;
    uint32_t depth; /* of the deepest leaf; the root's is 0 */
};

/* Builds the tree of a scene whose vertices are finite. The same scene makes the same tree. Errors:
 * STATUS_LIMIT more than KD_TRIS_MOST triangles, or more items than fit; STATUS_MEMORY, before
 * anything is built where it is known that the tree takes more than is left. */
enum status kd_make(const struct scene *scene, struct kd_tree *out, struct reason *reason) MUST_USE;

/* A zero tree is allowed. */
void kd_free(struct kd_tree *tree);

static inline uint64_t kd_node_bytes(const struct kd_tree *tree)
{
    return (uint64_t)tree->node_count * sizeof *tree->node;
}

/* The lists of leaves and the triangles. */
static inline uint64_t kd_item_bytes(const struct kd_tree *tree)
{
    return (uint64_t)tree->item_count * sizeof *tree->item +
           (uint64_t)tree->tri_count * sizeof *tree->tri;
}

/* Work done, added up over rays. */
struct kd_counts {
    uint64_t planes; /* of inner nodes */
    uint64_t tris;   /* triangle tests; a triangle in two leaves may be tested twice */
    uint64_t leaves;
};

/* Hits of one ray, in no order; a triangle as often as it was found. Owns its array. */
struct kd_list {
    struct hit *hit;
    size_t count, capacity;
};

/* The nearest hit, the first of equal ones that is found. */
struct hit kd_closest(const struct kd_tree *tree, const struct ray *ray, struct kd_counts *counts);

/* The first hit that is found. */
struct hit kd_any(const struct kd_tree *tree, const struct ray *ray, struct kd_counts *counts);

/* Every hit. Errors: STATUS_MEMORY. */
enum status kd_all(const struct kd_tree *tree, const struct ray *ray, struct kd_list *list,
                   struct kd_counts *counts) MUST_USE;

/* As kd_closest, and calls `read` for each node, item and triangle that is read: which array, the
 * number there, and the bytes of one. */
enum kd_read { KD_READ_NODE, KD_READ_ITEM, KD_READ_TRI };
typedef void kd_read_fn(void *reader, enum kd_read array, ptrdiff_t number, size_t bytes);
struct hit kd_watched(const struct kd_tree *tree, const struct ray *ray, kd_read_fn *read,
                      void *reader);

#endif

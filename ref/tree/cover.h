/* Whether a tree finds every point of every triangle, exactly. In a split tree a node's box need
 * not contain its triangles. What must hold: each point of a triangle lies in every box on the way
 * from the root to some leaf that lists the triangle. So the triangle must be covered by the union,
 * over the leaves that list it, of their regions: what all boxes on the way have in common.
 *
 * What regions leave of a triangle's bounds falls apart into half-open boxes; each is tested
 * against the triangle (ref/tree/cover_exact.h). No tolerance: a box one ulp too small is found. */
#ifndef COVER_H
#define COVER_H

#include "ref/scene/scene.h"

/* A node of any tree; an inner one has no items. Children come after their parent, whose index is
 * `parent`; node 0 is the root. */
struct cover_node {
    struct box box;
    uint32_t parent;
    uint32_t item_first, item_count;
};

struct cover_tree {
    const struct cover_node *node;
    const uint32_t
        *item; /* triangles of the scene, in any order; what is out of range is skipped */
    uint32_t node_count;
};

/* What was found. */
struct cover_faults {
    uint32_t prims; /* triangles that lose a part */
    uint32_t prim;  /* the first of them, and the deepest node whose region has some of the part */
    uint32_t node;
};

/* Checks every triangle that some leaf lists; those in no leaf are ignored. A NaN bound is a
 * box without anything in it. Takes memory for a copy of the items and 24 bytes a node. What is
 * left of a triangle in more than 2^16 parts counts as lost: no tree that was built comes near.
 * Errors: STATUS_MEMORY. */
enum status cover_check(const struct cover_tree *tree, const struct scene *scene,
                        struct cover_faults *out) MUST_USE;

#endif

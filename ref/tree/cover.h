/* Checks exactly that a tree finds every point of every triangle. In a split tree a node's box need
 * not contain its triangles. Instead, each point of a triangle must lie in every box on the path
 * from the root to some leaf that lists the triangle. A leaf's region is the intersection of all
 * boxes on its path. So the regions of the leaves that list a triangle must together cover the
 * triangle.
 *
 * The uncovered rest of a triangle's bounds is divided into half-open boxes; each is tested against
 * the triangle (ref/tree/cover_exact.h). No tolerance: a box one ulp too small is found. */
#ifndef COVER_H
#define COVER_H

#include "ref/scene/scene.h"

/* A node of any tree; inner nodes have no items. Children come after their parent, whose index is
 * `parent`; node 0 is the root. */
struct cover_node {
    struct box box;
    uint32_t parent;
    uint32_t item_first, item_count;
};

struct cover_tree {
    const struct cover_node *node;
    const uint32_t
        *item; /* triangles of the scene, in any order; out-of-range numbers are skipped */
    uint32_t node_count;
};

/* Result of a check. */
struct cover_faults {
    uint32_t prims; /* triangles with an uncovered part */
    uint32_t prim;  /* the first of them, and the deepest node whose region still has some of the
                       part */
    uint32_t node;
};

/* Checks every triangle that some leaf lists; those in no leaf are ignored. A box with a NaN bound
 * is empty. Needs memory for a copy of the items and 24 bytes per node. A triangle whose uncovered
 * rest exceeds 2^16 parts counts as uncovered; no built tree comes near. Errors: STATUS_MEMORY. */
enum status cover_check(const struct cover_tree *tree, const struct scene *scene,
                        struct cover_faults *out) MUST_USE;

#endif

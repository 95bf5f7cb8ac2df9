/* Measures of a tree's quality that need no rays. */
#ifndef TREE_QUALITY_H
#define TREE_QUALITY_H

#include "ref/tree/bvh.h"

/* Costs of a visit of a node and of a test of a triangle. */
#define QUALITY_NODE     1.0
#define QUALITY_TRIANGLE 1.0

struct tree_quality {
    struct bvh_stats stats;
    double sah;       /* see tree_sah */
    double leaf_fill; /* triangles per leaf */
};

/* The surface area heuristic's cost (Goldsmith and Salmon 1987): expected cost of a line that meets
 * the root's box, QUALITY_NODE for each inner node and QUALITY_TRIANGLE for each triangle of each
 * leaf whose box it meets. It is the sum of area times cost over the root's area. 0 for an empty
 * tree, or if the root has no area. In double: areas of finite boxes do not overflow. */
double tree_sah(const struct bvh *bvh);

/* End-point overlap (Aila, Karras and Laine 2013, On quality metrics of bounding volume
 * hierarchies, section 4): the cost of a ray that ends on a surface in boxes of triangles
 * elsewhere. For each node it takes the area of all triangle parts in the node's closed box whose
 * triangles are not in the node's leaves. The result is the sum of these areas times the cost
 * (above), over the area of all triangles. Parts are cut in double, once per level; a split
 * triangle belongs to every node with a reference to it. most: scenes with more triangles are
 * sampled, about `most` triangles evenly by number, and the result is an estimate; 0: all. Set to 0
 * for an empty tree and for triangles without area. Uses all threads; the result does not depend on
 * their number. The recursion is as deep as the tree. Errors: STATUS_MEMORY. */
enum status tree_overlap(const struct bvh *bvh, const struct scene *scene, uint32_t most,
                         double *out) MUST_USE;

/* A node of any tree: the items prim[item_first .. item_end - 1] are below it. A leaf has no
 * children. */
struct overlap_node {
    struct box box;
    size_t child_first; /* children: child[child_first .. child_first + child_count - 1] */
    uint32_t child_count;
    uint32_t item_first, item_end;
};

struct overlap_tree {
    const struct overlap_node *node; /* node 0 is the root */
    const uint32_t *child;
    const uint32_t *prim; /* triangles of the scene */
    uint32_t node_count, prim_count, tri_count;
};

/* As tree_overlap for a tree of any width, whose triangles may be in no leaf. *out becomes NaN if a
 * block of 256 triangles visits `visits` nodes. */
enum status overlap_measure(const struct overlap_tree *tree, const struct scene *scene,
                            uint32_t most, uint64_t visits, double *out) MUST_USE;

/* Computes the measures of a well-formed tree of the scene. Errors: STATUS_MEMORY. */
enum status tree_quality(const struct bvh *bvh, const struct scene *scene, struct tree_quality *out,
                         struct reason *reason) MUST_USE;

#endif

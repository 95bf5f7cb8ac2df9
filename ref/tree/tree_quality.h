/* How good a tree is, in numbers that need no rays. */
#ifndef TREE_QUALITY_H
#define TREE_QUALITY_H

#include "ref/tree/bvh.h"

/* What a ray's visit of a node costs, and a test of a triangle. */
#define QUALITY_NODE     1.0
#define QUALITY_TRIANGLE 1.0

struct tree_quality {
    struct bvh_stats stats;
    double sah;       /* see tree_sah */
    double leaf_fill; /* triangles per leaf */
};

/* The surface area heuristic's cost (Goldsmith and Salmon 1987): expected cost of a line that meets
 * the root's box, QUALITY_NODE for each inner node and QUALITY_TRIANGLE for each triangle of each
 * leaf whose box it meets: the sum of area times cost over the root's area. 0 for an empty tree, or
 * one whose root has no area. In double: areas of finite boxes do not overflow. */
double tree_sah(const struct bvh *bvh);

/* End-point overlap (Aila, Karras and Laine 2013, On quality metrics of bounding volume
 * hierarchies, section 4): what a ray pays that ends on a surface in boxes of triangles elsewhere.
 * The sum over nodes of the area of those triangles' parts in the closed box that are not in the
 * node's leaves, times the cost (above), over the area of all triangles. Parts are cut in double,
 * once for each level; a split triangle is every node's that has a reference to it. most: of scenes
 * with more triangles than that about so many are taken, evenly by number, and the result is an
 * estimate; 0: all are. Set to 0 for an empty tree and for triangles without area. By all threads;
 * the result does not depend on how many; recursion is as deep as the tree. Errors: STATUS_MEMORY.
 */
enum status tree_overlap(const struct bvh *bvh, const struct scene *scene, uint32_t most,
                         double *out) MUST_USE;

/* The numbers of a well-formed tree of the scene. */
struct tree_quality tree_quality(const struct bvh *bvh, const struct scene *scene);

#endif

/* How good a tree is, in numbers that need no rays. */
#ifndef TREE_QUALITY_H
#define TREE_QUALITY_H

#include "ref/bvh.h"

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

/* The numbers of a well-formed tree of the scene. */
struct tree_quality tree_quality(const struct bvh *bvh, const struct scene *scene);

#endif

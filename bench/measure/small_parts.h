/* What the bytes of a small tree hold. */
#ifndef SMALL_PARTS_H
#define SMALL_PARTS_H

#include "ref/fast/small_tree.h"

enum small_part { PART_NODES, PART_HEADS, PART_CORNERS, PART_VERTICES, PART_PRIMS, PART_ENDS };
#define SMALL_PARTS 6

/* Bytes by part; PART_ENDS is what fills the last words of blocks. */
struct small_parts {
    double held[SMALL_PARTS];
    /* Least bytes of a code of leaf by leaf, if a leaf is any of those with its header: vertices
     * at any place in their ranges, triangles with any three different corners, in the order of
     * their numbers, which are any that lie in their range. Nodes and headers as they are held. */
    double least[SMALL_PARTS];
};

struct small_parts small_parts_count(const struct fast_tree *tree);

extern const char *const small_part_names[SMALL_PARTS];

#endif

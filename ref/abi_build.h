/* Further definitions shared by C and the shaders that build trees; the rules of ref/abi.h hold. */
#ifndef ABI_BUILD_H
#define ABI_BUILD_H

#include "ref/abi.h"

#define ABI_HPLOC_CLUSTERS 16 /* a range of more places is merged until so many are left */
#define ABI_HPLOC_RADIUS   8  /* neighbours compared on either side */

/* Descriptor bindings of all shaders that build. */
#define ABI_BUILD_VERTICES 0 /* U32[]: bits, 3 per vertex */
#define ABI_BUILD_INDICES  1 /* U32[]: 3 per triangle */
#define ABI_BUILD_KEYS     2 /* uvec4[]: code high, code low, triangle; sorted in turns with */
#define ABI_BUILD_OTHERS   3 /* the same; then clusters: link, their number, links of the node */
#define ABI_BUILD_COUNTS   4 /* U32[]: 16 digits of each block of keys */
#define ABI_BUILD_LINKS    5 /* U32[]: ABI_BUILD_LINK_WORDS per inner node, then leaves' parents */
#define ABI_BUILD_BOXES    6 /* U32[]: 6 per node, inner nodes first */
#define ABI_BUILD_STATE    7 /* U32[]: ABI_STATE_* below */
#define ABI_BUILD_BINDINGS 8

/* Words of an inner node in ABI_BUILD_LINKS. */
#define ABI_LINK_CHILD       0 /* and 1: a leaf has bit 31 */
#define ABI_LINK_PARENT      2
#define ABI_LINK_VISITS      3 /* children that are done */
#define ABI_LINK_FIRST       4 /* places of its range; of wide trees: triangles of its subtree */
#define ABI_LINK_LAST        5
#define ABI_BUILD_LINK_WORDS 6
#define ABI_LINK_LEAF        0x80000000u
#define ABI_LINK_NONE        0x7FFFFFFFu /* the root's parent */

/* Bindings of the shader that refits; vertices, indices, boxes and state are as above. */
#define ABI_REFIT_NODES  2 /* U32[]: the packed nodes, which get their bounds */
#define ABI_REFIT_ITEMS  3 /* U32[]: triangles of leaves that have them apart */
#define ABI_REFIT_LEAVES 4 /* U32[]: nodes that wait for no other: of binary layouts the leaves */
#define ABI_REFIT_LINKS                                                                            \
    5 /* U32[]: per node its parent, or ABI_LINK_NONE, and visits, which begin \
                               at 2 less the children that it waits for */
#define ABI_REFIT_F32     0u /* values of refit_push.kind */
#define ABI_REFIT_RF16    1u
#define ABI_REFIT_OUTWARD 0u /* of other layouts: bounds are rounded outward */
#define ABI_REFIT_NEAREST 1u /* or to the nearest */
#define ABI_REFIT_BEYOND  0  /* word of the state: bounds that the layout cannot hold */

/* Words of ABI_BUILD_STATE. */
#define ABI_STATE_LO    0 /* 3: bounds of the scene, as numbers in the order of the floats */
#define ABI_STATE_HI    3
#define ABI_STATE_ROOT  6 /* a link */
#define ABI_STATE_LEVEL 7 /* of a wide tree: two levels, even and odd ones */
#define ABI_STATE_WORDS 19

/* Words of a level. */
#define ABI_LEVEL_FIRST  0 /* node */
#define ABI_LEVEL_COUNT  1 /* nodes */
#define ABI_LEVEL_ITEMS  2 /* of the levels before */
#define ABI_LEVEL_GROUPS 3 /* 3: workgroups of a dispatch with an invocation for each node */
#define ABI_LEVEL_WORDS  6

/* Bindings of the shaders that make wide trees, which have at most 8 children; keys, links, boxes
 * and state are as above, counts at first those of H-PLOC's nodes. */
#define ABI_WIDE_PACKED 0 /* U32[]: records of a layout */
#define ABI_WIDE_ITEMS  1 /* U32[]: triangles */
#define ABI_WIDE_NODES  3 /* U32[]: ABI_WIDE_WORDS per node */
#define ABI_WIDE_SUMS   4 /* U32[]: nodes below each workgroup's, then items */

/* Words of a wide node. */
#define ABI_WIDE_ROOT  0 /* link of its subtree */
#define ABI_WIDE_KINDS 1 /* four bits for each child: 0 none, 1 to 14 items of a leaf, 15 a node */
#define ABI_WIDE_FIRST 2 /* its first child that is a node */
#define ABI_WIDE_ITEM  3 /* place of the first item of its leaves */
#define ABI_WIDE_BEFORE                                                                            \
    4                    /* children that are nodes, and in the upper half items, of the nodes
                             before it in its workgroup */
#define ABI_WIDE_LINKS 8 /* 8: links of its children */
#define ABI_WIDE_WORDS 16
#define ABI_WIDE_NODE  15u /* the kind of a child */
#define ABI_WIDE_MOST  8u

/* Values of axis_bits where wide nodes are encoded: the layout. */
#define ABI_WIDE_CWBVH80 0u
#define ABI_WIDE_TINY8   1u

/* Keys that one workgroup sorts in a pass, and bits of a digit. */
#define ABI_BUILD_GROUP 64u /* invocations of every workgroup */
#define ABI_BUILD_EACH  16u /* keys of an invocation */
#define ABI_BUILD_DIGIT 4u

/* Push constants. Of wide trees: axis_bits is the layout, shift the most triangles of a leaf,
 * swapped whether the level is odd (of build_adopt: whether links stand in the counts), blocks the
 * most nodes. */
struct build_push {
    U32 count;     /* triangles */
    U32 axis_bits; /* of a code: 10 or 21 */
    U32 shift;     /* of the digit to sort by; from 32: of the high word */
    U32 swapped;   /* 1: keys are read from ABI_BUILD_OTHERS and written to ABI_BUILD_KEYS */
    U32 blocks;    /* of ABI_BUILD_GROUP * ABI_BUILD_EACH keys */
};
ABI_SIZE(struct build_push, 20)

/* Those of the shaders that refit. */
struct refit_push {
    U32 count; /* nodes that wait for no other */
    U32 kind;  /* of binary layouts which one, of others how they round: ABI_REFIT_* */
    U32 width; /* of the grid family: children of a node, ABI_NUMBER_*, ABI_FRAME_*; of amd64:
                  records, then ulps that bounds are grown by */
    U32 number;
    U32 frame;
};
ABI_SIZE(struct refit_push, 20)

#endif

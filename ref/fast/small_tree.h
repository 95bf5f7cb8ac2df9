/* Small trees: the form of ref/fast/fast.h in about half its bytes, of which a dragon takes less
 * than 14 a triangle. Nodes have 80 bytes, and leaves are blocks of ref/fast/small_block.h. Every
 * bound is still a code of the scene's frame, so that the proof of the box test is the same. Tiny
 * trees have the same nodes; their leaves are blocks of ref/fast/tiny_block.h. */
#ifndef SMALL_TREE_H
#define SMALL_TREE_H

#include "ref/fast/fast.h"
#include "ref/fast/small_block.h"
#include "ref/fast/tiny_block.h"

/* A node. The bounds of its children along an axis are base + (q << shift) for q of 8 bits: codes
 * of the scene's frame, at most 65536. The children that are nodes stand in a row from first[0] on,
 * and the blocks of those that are leaves from word first[1] on. */
struct fast_small_node {
    uint8_t bound[2][3][FAST_WIDTH]; /* q: lower and upper; axis; child */
    uint16_t base[3];
    uint16_t shifts; /* of axis k in bits 4 k on; in bits 12 on the number of children */
    uint32_t first[2];
    uint16_t ref[FAST_WIDTH]; /* from the first node or word on; bit 15 set: a leaf */
};
_Static_assert(sizeof(struct fast_small_node) == FAST_SMALL_NODE, "parts of two lines, always");

#define SMALL_LEAF   0x8000u
#define SMALL_OFFSET 0x7FFFu
_Static_assert((FAST_WIDTH - 1) * SMALL_WORDS <= SMALL_OFFSET, "a node reaches all its blocks");
_Static_assert((FAST_WIDTH - 1) * TINY_WORDS <= SMALL_OFFSET, "a node reaches all its blocks");
_Static_assert(TINY_BEYOND >= SMALL_BEYOND, "the larger one is left behind the blocks");

static inline uint32_t small_children(const struct fast_small_node *node)
{
    return node->shifts >> 12;
}

/* A bound as a code of the scene's frame. */
static inline uint32_t small_code(const struct fast_small_node *node, int side, int k, uint32_t i)
{
    return node->base[k] + ((uint32_t)node->bound[side][k][i] << (node->shifts >> 4 * k & 15u));
}

/* The number of a node, or FAST_LEAF and the first word of a block. */
static inline uint32_t small_ref(const struct fast_small_node *node, uint32_t i)
{
    uint32_t offset = node->ref[i] & SMALL_OFFSET;
    return node->ref[i] & SMALL_LEAF ? FAST_LEAF | (node->first[1] + offset)
                                     : node->first[0] + offset;
}

#endif

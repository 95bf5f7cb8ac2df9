/* Nodes of small and tiny trees (ref/fast/small_tree.h) as a traversal reads them, and the groups
 * of triangles of their leaves. Included by ref/fast/kernel/walk_small.h and
 * ref/fast/kernel/walk_tiny.h, for kernels that define as well:
 *   bytes      8 bytes as floats */
#include "ref/fast/small_tree.h"

typedef struct fast_small_node walk_node;

INLINE const walk_node *node_at(const struct fast_tree *tree, uint32_t ref)
{
    return &tree->small[ref];
}

#define PLACE_LINES 3 /* to prefetch: most leaves */

/* Where a node or a leaf begins.
 *   base   of nodes and of blocks */
INLINE const char *place_of(const char *const base[2], uint32_t ref)
{
    const uint32_t leaf = ref >> 31;
    return base[leaf] + (uint64_t)(ref & ~FAST_LEAF) * (sizeof(walk_node) - 76 * leaf);
}
_Static_assert(sizeof(walk_node) - 76 == sizeof(uint32_t), "a node or a word");

/* The references of the children, written to `own`. */
INLINE const uint32_t *node_refs(const walk_node *node, uint32_t own[FAST_WIDTH])
{
    short8 from;
    memcpy(&from, node->ref, sizeof from);
    const int8 ref = __builtin_convertvector(from, int8), leaf = ref << 16 >> 31;
    const int32_t first[2] = {(int32_t)node->first[0], (int32_t)(node->first[1] | FAST_LEAF)};
    const int8 base = (~leaf & first[0]) | (leaf & first[1]);
    const int8 all = base + (ref & (int32_t)SMALL_OFFSET);
    memcpy(own, &all, sizeof all);
    return own;
}

INLINE uint32_t node_children(const walk_node *node)
{
    return small_children(node);
}

/* A bound as a code. */
INLINE float node_code(const walk_node *node, int side, int k, uint32_t i)
{
    return (float)small_code(node, side, k, i);
}

/* The codes of 8 bounds, which are exact. */
INLINE float8 codes_of(const uint8_t *row, float8 unit, float8 base)
{
    return fma8(bytes(row), unit, base);
}

/* Returns the bits of the children that the ray meets in its range, and sets their entry
 * distances. */
INLINE uint32_t test_node(const struct walk_ray *r, const walk_node *node, float8 *entry)
{
    const uint8_t *row = node->bound[0][0];
    const int4 base = {node->base[0], node->base[1], node->base[2], 0};
    const int4 shift = (all4i(node->shifts) >> (int4){0, 4, 8, 0}) & 15;
    const float4 from = __builtin_convertvector(base, float4);
    const float4 unit = (float4)((shift + 127) << 23); /* 2^shift */
    const float8 ux = lane8(unit, 0), uy = lane8(unit, 1), uz = lane8(unit, 2);
    const float8 bx = lane8(from, 0), by = lane8(from, 1), bz = lane8(from, 2);
    float8 nx = fma8(codes_of(row + r->near_row[0], ux, bx), r->scale[0], r->near[0]);
    float8 ny = fma8(codes_of(row + r->near_row[1], uy, by), r->scale[1], r->near[1]);
    float8 nz = fma8(codes_of(row + r->near_row[2], uz, bz), r->scale[2], r->near[2]);
    float8 fx = fma8(codes_of(row + r->far_row[0], ux, bx), r->scale[0], r->far[0]);
    float8 fy = fma8(codes_of(row + r->far_row[1], uy, by), r->scale[1], r->far[1]);
    float8 fz = fma8(codes_of(row + r->far_row[2], uz, bz), r->scale[2], r->far[2]);
    *entry = max8(max8(nx, ny), max8(nz, r->tmin));
    return not_above(*entry, min8(min8(fx, fy), min8(fz, r->tbest))) &
           (0xFFu >> (FAST_WIDTH - small_children(node)));
}

/* The triangles of a group that are there. */
INLINE uint32_t leaf_there(const struct leaf_rows *rows, uint32_t number)
{
    const uint32_t left = rows->tris - GROUP * number;
    return left >= GROUP ? ~0u : (1u << left) - 1;
}

/* What prim_of takes beside the tree, the block and the lane: the first triangle of the group. */
INLINE uint32_t leaf_part(const struct leaf_rows *rows, uint32_t number)
{
    (void)rows;
    return GROUP * number;
}

/* Leaves of tiny trees (ref/fast/tiny_block.h) as a traversal reads them. Included by
 * ref/fast/kernel/walk.h, for kernels that define as well:
 *   triplets    the corners of a group of triangles, from its first byte on, 15 bits each
 *   unpacked    16 numbers of a row, from a bit on, plus another number, as floats
 *   corners32   the lanes of two rows of 16 by codes of 5 bits */
#include "ref/fast/kernel/walk_small_both.h"

/* The leaf of a ray without hits: one triangle, of a single point. */
static const uint32_t leaf_none[TINY_WORDS + TINY_BEYOND] __attribute__((unused)) = {0};

/* The vertices of a leaf along an axis. */
INLINE leaf_row tiny_leaf_row(const struct tiny_form *form, const uint32_t *block, uint32_t axis)
{
    const uint32_t head = block[0], width = tiny_width(head, axis);
    const uint32_t first = tiny_row(form, head, axis);
    const uint32_t least = (uint32_t)tiny_least(form, block, axis);
    const float step = form->grid.step[axis];
    const leaf_row row = {
        {unpacked(block, first, width, least), unpacked(block, first + 16 * width, width, least)}};
    return (leaf_row){{row.half[0] * step, row.half[1] * step}};
}

/* Returns the number of groups of triangles. */
INLINE uint32_t leaf_open(const struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                          struct leaf_rows *rows)
{
    const uint32_t *block = tree->block + (leaf & ~FAST_LEAF), tris = tiny_tris(block[0]);
    leaf_row row[3];
    for (int k = 0; k < 3; k++)
        row[k] = row_minus(tiny_leaf_row(&tree->tiny, block, r->axis[k]), r->o[k]);
    rows->x = row_minus_row(row[0], row_times(row[2], r->shear[0]));
    rows->y = row_minus_row(row[1], row_times(row[2], r->shear[1]));
    rows->az = row[2];
    rows->block = block;
    rows->vertices = tiny_vertices(block[0]);
    rows->tris = tris;
    return (tris + GROUP - 1) / GROUP;
}

/* The corners of a group, and those of its triangles that are there. */
INLINE uint32_t leaf_codes(const struct leaf_rows *rows, uint32_t number, group_codes c[3])
{
    triplets((const char *)rows->block + (TINY_HEAD + TINY_CORNERS * GROUP * number) / 8, c);
    return leaf_there(rows, number);
}

INLINE uint32_t prim_of(const struct fast_tree *tree, const uint32_t *block, uint32_t part,
                        uint32_t lane)
{
    return block == leaf_none ? ABI_NO_PRIM : tiny_prim(&tree->tiny, block, part + lane, NULL);
}

/* Leaves of small trees (ref/fast/small_block.h) as a traversal reads them. Included by
 * ref/fast/kernel/walk.h, for kernels that define as well:
 *   triplets   the corners of a group of triangles, from its first 12 bits on
 *   unpacked   up to 16 ordered integers of a row, from a bit on, as floats */
#include "ref/fast/kernel/walk_small_both.h"

/* The leaf of a ray without hits: one triangle, with the number of none. */
static const uint32_t leaf_none[SMALL_WORDS] __attribute__((unused)) = {0, 0, 0, 0, ABI_NO_PRIM};

/* Returns the number of groups of triangles. */
INLINE uint32_t leaf_open(const struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                          struct leaf_rows *rows)
{
    const uint32_t *block = tree->block + (leaf & ~FAST_LEAF);
    const uint32_t head = block[0], n = small_vertices(head), tris = small_tris(head);
    float16 row[3];
    for (int k = 0; k < 3; k++) {
        const uint32_t axis = r->axis[k];
        row[k] =
            unpacked(block, small_row(head, axis), small_width(head, axis), block[1 + axis], n);
    }
    float16 az = row[2] - r->o[2];
    rows->x = row[0] - r->o[0] - r->shear[0] * az;
    rows->y = row[1] - r->o[1] - r->shear[1] * az;
    rows->az = az;
    rows->block = block;
    rows->vertices = n;
    rows->tris = tris;
    return (tris + GROUP - 1) / GROUP;
}

/* The corners of a group, and those of its triangles that are there. */
INLINE uint32_t leaf_codes(const struct leaf_rows *rows, uint32_t number, group_codes c[3])
{
    triplets(rows->block + SMALL_HEAD + GROUP * SMALL_CORNERS / 32 * number, c);
    return leaf_there(rows, number);
}

INLINE uint32_t prim_of(const struct fast_tree *tree, const uint32_t *block, uint32_t part,
                        uint32_t lane)
{
    (void)tree;
    return small_prim(block, part + lane);
}

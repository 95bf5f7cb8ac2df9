/* Nodes and leaves of ref/fast/fast.h as a traversal reads them. Included by
 * ref/fast/kernel/walk.h. */

typedef struct fast_node walk_node;

INLINE const walk_node *node_at(const struct fast_tree *tree, uint32_t ref)
{
    return &tree->node[ref];
}

#define PLACE_LINES 2 /* to prefetch: a node, or half of most leaves */

/* Where a node or a leaf begins.
 *   base   of nodes and of blocks */
INLINE const char *place_of(const char *const base[2], uint32_t ref)
{
    const uint32_t leaf = ref >> 31;
    const uint64_t place = ref & (~FAST_LEAF >> 4 * leaf); /* of a word or a node */
    return base[leaf] + (place << (7 - 5 * leaf));
}

/* The references of the children; `own` has room for them. */
INLINE const uint32_t *node_refs(const walk_node *node, uint32_t own[FAST_WIDTH])
{
    (void)own;
    return node->ref;
}

/* Children that may be met, and a bound of one of them as a code. */
INLINE uint32_t node_children(const walk_node *node)
{
    (void)node;
    return FAST_WIDTH;
}

INLINE float node_code(const walk_node *node, int side, int k, uint32_t i)
{
    return node->bound[side][k][i];
}

/* Returns the bits of the children that the ray meets in its range, and sets their entry
 * distances. */
INLINE uint32_t test_node(const struct walk_ray *r, const walk_node *node, float8 *entry)
{
    const uint16_t *row = node->bound[0][0];
    float8 nx = fma8(planes(row + r->near_row[0]), r->scale[0], r->near[0]);
    float8 ny = fma8(planes(row + r->near_row[1]), r->scale[1], r->near[1]);
    float8 nz = fma8(planes(row + r->near_row[2]), r->scale[2], r->near[2]);
    float8 fx = fma8(planes(row + r->far_row[0]), r->scale[0], r->far[0]);
    float8 fy = fma8(planes(row + r->far_row[1]), r->scale[1], r->far[1]);
    float8 fz = fma8(planes(row + r->far_row[2]), r->scale[2], r->far[2]);
    *entry = max8(max8(nx, ny), max8(nz, r->tmin));
    return not_above(*entry, min8(min8(fx, fy), min8(fz, r->tbest)));
}

/* --- leaves ----------------------------------------------------------------------------------- */

/* The leaf of a ray without hits. It has no vertices, and the number of no triangle. */
static const uint32_t leaf_none[BLOCK_CORNERS + 1] __attribute__((unused)) = {0, 0, 0, ABI_NO_PRIM};

/* Returns the number of groups of triangles. */
INLINE uint32_t leaf_open(const struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                          struct leaf_rows *rows)
{
    const uint32_t *block = tree->block + (leaf & (FAST_LEAF_WORDS - 1));
    uint32_t n = (leaf >> FAST_LEAF_COUNT & 15u) + 1;
    const uint32_t *row = block + BLOCK_CORNERS;
    float16 az = vertices(row + r->axis[2] * n, n) - r->o[2];
    rows->x = vertices(row + r->axis[0] * n, n) - r->o[0] - r->shear[0] * az;
    rows->y = vertices(row + r->axis[1] * n, n) - r->o[1] - r->shear[1] * az;
    rows->az = az;
    rows->block = block;
    rows->vertices = n;
    return 1;
}

/* The corners of a group, and those of its triangles that are there. */
INLINE uint32_t leaf_codes(const struct leaf_rows *rows, uint32_t number, group_codes c[3])
{
    (void)number;
    for (int k = 0; k < 3; k++)
        c[k] = codes(rows->block[k]);
    return ~0u; /* absent ones are never hit */
}

/* What prim_of takes beside the tree, the block and the lane. */
INLINE uint32_t leaf_part(const struct leaf_rows *rows, uint32_t number)
{
    (void)number;
    return rows->vertices;
}

INLINE uint32_t prim_of(const struct fast_tree *tree, const uint32_t *block, uint32_t part,
                        uint32_t lane)
{
    (void)tree;
    return block_prim(block, part, lane);
}

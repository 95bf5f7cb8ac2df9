/* Layout rf16: 16-byte records, two for a leaf. Inner: bits 0-15 of the tag are the record of the
 * second child, bits 16-30 that of the first. Leaf: bit 31 is set, and bits 0-3 are the number of
 * items, whose 16-bit triangle indices fill the next record. */
#include "half.glsl"

#define ORDER_NEAR

/* A node during traversal. Inner: the tag. Leaf: bit 31, the record of the items in bits 4 and up,
 * and their number in bits 0-3. */
struct node {
    uint a;
};

#define NODE_DONE node(NODE_LEAF)

node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    uvec4 record = NODE_QUAD(ref);
    half_bounds(r, record.xyz, nearer, farther);
    uint as_leaf = NODE_LEAF | (ref + 1u) << 4 | (record.w & 15u);
    return node(pick((record.w & NODE_LEAF) == 0u, record.w, as_leaf));
}

uint node_fst(node n)
{
    return n.a >> 16;
}

uint node_snd(node n)
{
    return n.a & 0xFFFFu;
}

struct leaf {
    uvec4 items;
    uint count;
};

leaf leaf_load(node n)
{
    return leaf(NODE_QUAD((n.a & ~NODE_LEAF) >> 4), n.a & 15u);
}

uint leaf_item(leaf l, uint slot)
{
    uint word = pick(slot < 4u, pick(slot < 2u, l.items.x, l.items.y),
                     pick(slot < 6u, l.items.z, l.items.w));
    uint prim = pick((slot & 1u) == 0u, word & 0xFFFFu, word >> 16);
    return prim;
}

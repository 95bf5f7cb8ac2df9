/* Layout rtrs_rf_paper: the 16-byte record as the paper's Listing 6 reads it. Bit 31 of the tag
 * marks a leaf; else bits 0-14 are the record of the first child, bits 16-30 that of the second.
 * The next record holds a leaf's eight items: two of 15 bits in the tag, then six of 16 bits; 0 is
 * empty. */
#include "half.glsl"

#define ORDER_SND
#define BITS_15 0x7FFFu

/* A node during traversal. Inner: the tag. Leaf: bit 31 and the record of the items. */
struct node {
    uint a;
};

#define NODE_DONE node(NODE_LEAF)

node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    uvec4 record = NODE_QUAD(ref);
    half_bounds_any(r, record.xyz, nearer, farther);
    return node(pick((record.w & NODE_LEAF) == 0u, record.w, NODE_LEAF | (ref + 1u)));
}

uint node_fst(node n)
{
    return n.a & BITS_15;
}

uint node_snd(node n)
{
    return (n.a >> 16) & BITS_15;
}

struct leaf {
    uvec4 items;
    uint count;
};

/* The record of the items may not exist in a tree cut to 15 bits. */
leaf leaf_load(node n)
{
    uint record = n.a & ~NODE_LEAF;
    if (record >= job.node_count)
        return leaf(uvec4(0u), 0u);
    return leaf(NODE_QUAD(record), 8u);
}

uint leaf_item(leaf l, uint slot)
{
    uint word = pick(slot < 2u, l.items.w & 0x7FFF7FFFu,
                     pick(slot < 4u, l.items.x, pick(slot < 6u, l.items.y, l.items.z)));
    uint stored = pick((slot & 1u) == 0u, word & 0xFFFFu, word >> 16);
    return pick(stored == 0u, ABI_NO_PRIM, stored);
}

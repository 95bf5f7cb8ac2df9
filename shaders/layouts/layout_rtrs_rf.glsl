/* Layout rtrs_rf: RTRS's 16-byte records as its shader reads them. Bit 31 of the tag marks a leaf;
 * else its high half is the record of the first child, its low half that of the second. The next
 * record holds a leaf's items, of which slots 0 to 5 are read (F7). Item k is triangle k - 1
 * (F2). */
#include "half.glsl"

#define ORDER_FST

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

/* The record of the items may not exist in a wrapped tree (F9). */
leaf leaf_load(node n)
{
    uint record = n.a & ~NODE_LEAF;
    if (record >= job.node_count)
        return leaf(uvec4(0u), 0u);
    return leaf(NODE_QUAD(record), 6u);
}

/* For 0, the null triangle, the result is out of range: no triangle. */
uint leaf_item(leaf l, uint slot)
{
    uint word = pick(slot < 2u, l.items.x, pick(slot < 4u, l.items.y, l.items.z));
    return pick((slot & 1u) == 0u, word & 0xFFFFu, word >> 16) - 1u;
}

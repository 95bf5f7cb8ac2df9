/* Layout mine: 32-byte nodes; see mine.c. */
#include "slab.glsl"

/* What the traversal keeps of a node. Inner: its index and the second child's. Leaf: bit 31 and the
 * number of items, and the first item. */
struct node {
    uint a;
    uint b;
};

#define NODE_DONE node(NODE_LEAF, 0u)

node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    uvec4 low = node_quad[2u * ref], high = node_quad[2u * ref + 1u];
    vec3 lo = uintBitsToFloat(low.xyz), hi = uintBitsToFloat(uvec3(low.w, high.xy));
    slab_order(r, lo, hi, nearer, farther);
    return node(pick(high.w == 0u, ref, high.w | NODE_LEAF), high.z);
}

uint node_fst(node n)
{
    return n.a + 1u;
}

uint node_snd(node n)
{
    return n.b;
}

struct leaf {
    uint first;
    uint count;
};

leaf leaf_load(node n)
{
    return leaf(n.b, n.a & ~NODE_LEAF);
}

uint leaf_item(leaf l, uint slot)
{
    uint at = l.first + slot;
    return at < job.item_count ? item_word[at] : ABI_NO_PRIM;
}

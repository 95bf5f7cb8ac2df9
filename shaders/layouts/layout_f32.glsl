/* Layout f32: 32-byte nodes, see struct node_f32. */
#include "slab.glsl"
#include "store.glsl"

#define ORDER_NEAR

/* A node during traversal. Inner: a is its index, b that of the second child. Leaf: a is bit 31 and
 * the number of items, b the first item. */
struct node {
    uint a;
    uint b;
};

#define NODE_DONE node(NODE_LEAF, 0u)

node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    uvec4 low = NODE_QUAD(2u * ref);
    uvec4 high = NODE_QUAD(2u * ref + 1u);
    slab_order(r, uintBitsToFloat(low.xyz), uintBitsToFloat(high.xyz), nearer, farther);
    return node(pick(high.w == 0u, ref, high.w | NODE_LEAF), low.w);
}

uint node_fst(node n)
{
    return n.a + 1u;
}

uint node_snd(node n)
{
    return n.b;
}

leaf leaf_load(node n)
{
    return leaf(n.b, n.a & ~NODE_LEAF);
}

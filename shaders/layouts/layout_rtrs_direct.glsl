/* Layout rtrs_direct: RTRS's 48-byte nodes, see struct node_rtrs_direct. Item slot s is the scene's
 * triangle s - 1; slot 0 is the null triangle (F2, F3). */
#include "slab.glsl"

#define ORDER_SND

/* A node during traversal. Inner: the children. Leaf: a is bit 31 and the number of items, b the
 * first slot. */
struct node {
    uint a;
    uint b;
};

#define NODE_DONE node(NODE_LEAF, 0u)

/* Child references of 2^31 and more are out of range, as 2^31 - 1 is. */
node node_load(slab_ray r, uint ref, out vec3 nearer, out vec3 farther)
{
    uvec4 head = NODE_QUAD(3u * ref);
    uvec4 lo = NODE_QUAD(3u * ref + 1u);
    uvec4 hi = NODE_QUAD(3u * ref + 2u);
    slab_order(r, uintBitsToFloat(lo.xyz), uintBitsToFloat(hi.xyz), nearer, farther);
    if (head.w > 0u)
        return node(head.w | NODE_LEAF, head.z);
    return node(pick(head.x < NODE_LEAF, head.x, NODE_LEAF - 1u), head.y);
}

uint node_fst(node n)
{
    return n.a;
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
    return l.first + slot - 1u; /* for slot 0 out of range: no triangle */
}

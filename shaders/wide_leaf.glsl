/* A node during traversal, of a wide layout whose items are in the triangle storage. Inner: a is
 * its record, b depends on the layout. Leaf: a is bit 31 and the number of items, b their place. */
#ifndef WIDE_LEAF_GLSL
#define WIDE_LEAF_GLSL

#include "slab.glsl"
#include "store.glsl"

struct node {
    uint a;
    uint b;
};

#define NODE_DONE node(NODE_LEAF, 0u)

leaf leaf_load(node n)
{
    return leaf(n.b, n.a & ~NODE_LEAF);
}

/* Returns word `at` of a quad. */
uint quad_word(uvec4 quad, uint at)
{
    return pick((at & 2u) == 0u, pick((at & 1u) == 0u, quad.x, quad.y),
                pick((at & 1u) == 0u, quad.z, quad.w));
}

#endif

/* Layout mine4: 128-byte nodes of 4 children; see mine4.c. */
#define WIDE 4u
#include "wide_leaf.glsl"

struct wide {
    uint record;
};

node node_of(uint ref)
{
    return node(ref, 0u);
}

wide wide_load(node n)
{
    return wide(n.a);
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    uint at = 2u * (WIDE * w.record + slot);
    uvec4 low = node_quad[at], high = node_quad[at + 1u];
    vec3 lo = uintBitsToFloat(low.xyz), hi = uintBitsToFloat(uvec3(low.w, high.xy));
    slab_order(r, lo, hi, nearer, farther);
    bool inner = both(high.w == 0u, high.z != 0u);
    return node(pick(inner, high.z, NODE_LEAF | high.w), pick(inner, 0u, high.z));
}

#include "wide.glsl"

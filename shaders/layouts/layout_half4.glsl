/* Layout half4: 64-byte nodes of 4 children with half float bounds, as in physics engines. See
 * ref/layouts/layout_half4.c for the words. */
#define WIDE 4u
#include "half.glsl"
#include "wide_leaf.glsl"

struct wide {
    uvec4 min_xy, min_z_max_x, max_yz;
    uvec4 child;
};

node node_of(uint ref)
{
    return node(ref, 0u);
}

wide wide_load(node n)
{
    uint at = 4u * n.a;
    return wide(NODE_QUAD(at), NODE_QUAD(at + 1u), NODE_QUAD(at + 2u), NODE_QUAD(at + 3u));
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    bool low = slot < 2u;
    uint shift = (slot & 1u) << 4;
    vec3 lo = vec3(half_normal((pick(low, w.min_xy.x, w.min_xy.y) >> shift) & 0xFFFFu),
                   half_normal((pick(low, w.min_xy.z, w.min_xy.w) >> shift) & 0xFFFFu),
                   half_normal((pick(low, w.min_z_max_x.x, w.min_z_max_x.y) >> shift) & 0xFFFFu));
    vec3 hi = vec3(half_normal((pick(low, w.min_z_max_x.z, w.min_z_max_x.w) >> shift) & 0xFFFFu),
                   half_normal((pick(low, w.max_yz.x, w.max_yz.y) >> shift) & 0xFFFFu),
                   half_normal((pick(low, w.max_yz.z, w.max_yz.w) >> shift) & 0xFFFFu));
    slab_order(r, lo, hi, nearer, farther);
    uint child = quad_word(w.child, slot);
    uint items = child >> 28, first = child & 0x0FFFFFFFu;
    bool inner = both(items == 0u, child != 0u);
    return node(pick(inner, first, NODE_LEAF | items), pick(inner, 0u, first));
}

#include "wide.glsl"

/* Layout cwbvh80: 80-byte nodes of 8 children, after Ylitie, Karras, Laine 2017. See
 * ref/layouts/layout_cwbvh80.c for the words. */
#define WIDE 8u
#include "frame_node.glsl"

/* An inner node: its five quads, and the steps of its frame. */
struct wide {
    uvec4 head;
    uvec4 base; /* first node, first item, kinds of the children */
    uvec4 lo_xy, lo_z_hi_x, hi_yz;
    vec3 step_size;
};

wide wide_load(node n)
{
    wide w;
    uint at = 5u * n.a;
    w.head = NODE_QUAD(at);
    w.base = NODE_QUAD(at + 1u);
    w.lo_xy = NODE_QUAD(at + 2u);
    w.lo_z_hi_x = NODE_QUAD(at + 3u);
    w.hi_yz = NODE_QUAD(at + 4u);
    w.step_size = frame_steps(w.head);
    return w;
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    uint shift = (slot & 3u) << 3;
    bool low = slot < 4u;
    uvec3 lo = uvec3(pick(low, w.lo_xy.x, w.lo_xy.y), pick(low, w.lo_xy.z, w.lo_xy.w),
                     pick(low, w.lo_z_hi_x.x, w.lo_z_hi_x.y));
    uvec3 hi = uvec3(pick(low, w.lo_z_hi_x.z, w.lo_z_hi_x.w), pick(low, w.hi_yz.x, w.hi_yz.y),
                     pick(low, w.hi_yz.z, w.hi_yz.w));
    frame_order(r, w.head, w.step_size, (lo >> shift) & 0xFFu, (hi >> shift) & 0xFFu, nearer,
                farther);
    uint meta = (pick(low, w.base.z, w.base.w) >> shift) & 0xFFu;
    uint inner = w.head.w >> 24;
    uint before = uint(bitCount(inner & ((1u << slot) - 1u)));
    bool is_inner = ((inner >> slot) & 1u) != 0u;
    uint items = ((meta >> 5) & 1u) + ((meta >> 6) & 1u) + (meta >> 7);
    return node(pick(is_inner, w.base.x + before, NODE_LEAF | items),
                pick(is_inner, 0u, w.base.y + (meta & 31u)));
}

#include "wide.glsl"

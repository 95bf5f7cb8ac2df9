/* Layout tiny8: 64-byte nodes of 8 children, with bounds of 6 bits in the node's frame. See
 * ref/layouts/layout_tiny8.c for the words. */
#define WIDE 8u
#include "frame_node.glsl"

struct wide {
    uvec4 head; /* origin, exponents */
    uvec4 base; /* first node, first item, kinds of the children, planes of child 0 */
    uvec4 planes1_4, planes5_8;
    vec3 step_size;
};

wide wide_load(node n)
{
    wide w;
    uint at = 4u * n.a;
    w.head = NODE_QUAD(at);
    w.base = NODE_QUAD(at + 1u);
    w.planes1_4 = NODE_QUAD(at + 2u);
    w.planes5_8 = NODE_QUAD(at + 3u);
    w.step_size = frame_steps(w.head);
    return w;
}

/* Returns the lowest bits of all nibbles that are 15. */
uint full_nibbles(uint word)
{
    return word & (word >> 1) & (word >> 2) & (word >> 3) & 0x11111111u;
}

/* The sum of the nibbles of a word. */
uint sum_nibbles(uint word)
{
    uint bytes = (word & 0x0F0F0F0Fu) + ((word >> 4) & 0x0F0F0F0Fu);
    return (bytes * 0x01010101u) >> 24;
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    uint at = (slot + 3u) & 3u;
    uint planes = pick(slot < 5u, quad_word(w.planes1_4, at), quad_word(w.planes5_8, at));
    planes = pick(slot == 0u, w.base.w, planes);
    uint top = (w.planes5_8.w >> (slot << 2)) & 15u;
    uvec3 lo = uvec3(planes, planes >> 6, planes >> 12) & 63u;
    uvec3 hi = uvec3((planes >> 18) & 63u, (planes >> 24) & 63u, (planes >> 30) | top << 2);
    frame_order(r, w.head, w.step_size, lo, hi, nearer, farther);
    uint kind = (w.base.z >> (slot << 2)) & 15u;
    uint before = w.base.z & ((1u << (slot << 2)) - 1u);
    uint nodes = full_nibbles(before);
    uint items = sum_nibbles(before & ~(nodes * 15u));
    bool inner = kind == 15u;
    return node(pick(inner, w.base.x + uint(bitCount(nodes)), NODE_LEAF | kind),
                pick(inner, 0u, w.base.y + items));
}

#include "wide.glsl"

/* Layouts gfx12: box nodes of AMD's RDNA 4, 128 bytes for 8 children. See
 * ref/layouts/layout_gfx12.c for the words. */
#define WIDE 8u
#include "wide_leaf.glsl"

/* An inner node. The last three have a byte for each child: its type and size, and what lies before
 * it. */
struct wide {
    uint at; /* first quad of the children */
    uvec2 base; /* first node, first item */
    vec3 origin, step_size;
    uvec2 kinds, nodes_before, items_before;
};

node node_of(uint ref)
{
    return node(ref, 0u);
}

/* Returns 2^(exponent - 12 - 127), or 0 where that is subnormal. */
float step_of(uint exponent)
{
    return uintBitsToFloat(pick(exponent > 12u, exponent - 12u, 0u) << 23);
}

/* Returns for each of eight bytes the sum of the bytes before it. Each sum is below 256. */
uvec2 bytes_before(uvec2 bytes)
{
    uvec2 sums = bytes * 0x01010101u;
    return uvec2(sums.x - bytes.x, sums.y - bytes.y + (sums.x >> 24) * 0x01010101u);
}

/* The highest bytes of four words. */
uint top_bytes(uint a, uint b, uint c, uint d)
{
    return (a >> 24) | (b >> 24) << 8 | (c >> 24) << 16 | (d & 0xFF000000u);
}

/* The first `count` of four bytes. */
uint bytes_below(uint count)
{
    return pick(count > 3u, 0xFFFFFFFFu, (1u << ((count & 3u) << 3)) - 1u);
}

wide wide_load(node n)
{
    uint at = 8u * n.a;
    uvec4 head = NODE_QUAD(at), frame = NODE_QUAD(at + 1u);
    uvec4 a = NODE_QUAD(at + 2u), b = NODE_QUAD(at + 3u), c = NODE_QUAD(at + 4u);
    uvec4 d = NODE_QUAD(at + 5u), e = NODE_QUAD(at + 6u), f = NODE_QUAD(at + 7u);
    uint count = (frame.z >> 28) + 1u;
    wide w;
    w.at = at + 2u;
    w.base = head.xy;
    w.origin = uintBitsToFloat(uvec3(head.w, frame.xy));
    w.step_size = vec3(step_of(frame.z & 0xFFu), step_of((frame.z >> 8) & 0xFFu),
                       step_of((frame.z >> 16) & 0xFFu));
    w.kinds = uvec2(top_bytes(a.z, b.y, c.x, c.w) & bytes_below(count),
                    top_bytes(d.z, e.y, f.x, f.w) &
                        bytes_below(pick(count > 4u, count - 4u, 0u)));
    uvec2 other = (w.kinds & 0x0F0F0F0Fu) ^ 0x05050505u; /* 0 in the byte of a node */
    uvec2 leaves = ((other | other >> 1 | other >> 2 | other >> 3) & 0x01010101u) * 15u;
    uvec2 sizes = (w.kinds >> 4) & 0x0F0F0F0Fu;
    w.nodes_before = bytes_before(sizes & ~leaves);
    w.items_before = bytes_before(sizes & leaves);
    return w;
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    /* The three words of a child begin anywhere in a quad. */
    uint quad = w.at + (3u * slot >> 2), skip = (3u * slot) & 3u;
    uvec4 first = NODE_QUAD(quad);
    uvec4 second = NODE_QUAD(pick(skip > 1u, quad + 1u, quad));
    bool even = (skip & 1u) == 0u, early = skip < 2u;
    uint x = pick(early, pick(even, first.x, first.y), pick(even, first.z, first.w));
    uint y = pick(early, pick(even, first.y, first.z), pick(even, first.w, second.x));
    uint z = pick(early, pick(even, first.z, first.w), pick(even, second.x, second.y));
    uvec3 lo = uvec3(x, x >> 12, y) & 0xFFFu, hi = uvec3(y >> 12, z, z >> 12) & 0xFFFu;
    precise vec3 lower = w.origin + vec3(lo) * w.step_size;
    precise vec3 upper = w.origin + vec3(hi + 1u) * w.step_size;
    slab_order(r, lower, upper, nearer, farther);

    uint shift = (slot & 3u) << 3;
    bool low = slot < 4u;
    uint kind = (pick(low, w.kinds.x, w.kinds.y) >> shift) & 0xFFu;
    uint nodes = (pick(low, w.nodes_before.x, w.nodes_before.y) >> shift) & 0xFFu;
    uint items = (pick(low, w.items_before.x, w.items_before.y) >> shift) & 0xFFu;
    bool inner = both((kind & 15u) == 5u, kind > 15u);
    return node(pick(inner, w.base.x + nodes, NODE_LEAF | pick((kind & 15u) == 5u, 0u, kind >> 4)),
                pick(inner, 0u, w.base.y + items));
}

#include "wide.glsl"

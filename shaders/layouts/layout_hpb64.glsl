/* Layout hpb64: 64-byte nodes of 4 children, bounds of 18 bits with a common exponent. See
 * ref/layouts/layout_hpb64.c for the bits. */
#define WIDE 4u
#include "wide_leaf.glsl"

/* An inner node. The last three have a byte for each child: its items, and what lies before it. */
struct wide {
    uvec4 a, b, c, d;
    vec3 unit;
    uint types; /* three bits each */
    uint items, nodes_before, items_before;
};

node node_of(uint ref)
{
    return node(ref, 0u);
}

/* Returns 2^(exponent - 143), which is not subnormal. */
float unit_of(uint exponent)
{
    return uintBitsToFloat(pick(exponent > 16u, exponent - 16u, 1u) << 23);
}

uint items_of(uint type)
{
    return (0x403021u >> (type << 2)) & 15u;
}

/* Returns for each of four bytes the sum of the bytes before it. */
uint bytes_before(uint bytes)
{
    return bytes * 0x01010101u - bytes;
}

wide wide_load(node n)
{
    wide w;
    uint at = 4u * n.a;
    w.a = NODE_QUAD(at);
    w.b = NODE_QUAD(at + 1u);
    w.c = NODE_QUAD(at + 2u);
    w.d = NODE_QUAD(at + 3u);
    w.unit = vec3(unit_of(w.a.y >> 24), unit_of(w.a.z & 0xFFu), unit_of((w.a.z >> 8) & 0xFFu));
    w.types = (w.a.x >> 29) | (w.a.y & 0x1FFu) << 3;
    uvec4 type = (uvec4(w.types) >> uvec4(0u, 3u, 6u, 9u)) & 7u;
    w.items = items_of(type.x) | items_of(type.y) << 8 | items_of(type.z) << 16 |
              items_of(type.w) << 24;
    uint nodes = pick(type.x == 4u, 1u, 0u) | pick(type.y == 4u, 0x100u, 0u) |
                 pick(type.z == 4u, 0x10000u, 0u);
    w.nodes_before = bytes_before(nodes);
    w.items_before = bytes_before(w.items);
    return w;
}

/* A plane of its code: units and, in bit 17, a sign. Where the cut of units made the box smaller,
 * the plane is the last number before the next unit. */
float plane_of(uint code, float unit, uint up)
{
    uint negative = code >> 17, outward = up ^ negative;
    precise float next = float((code & 0x1FFFFu) + outward) * unit;
    uint bits = floatBitsToUint(next) - outward;
    return uintBitsToFloat(bits | pick(bits != 0u, negative << 31, 0u));
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    /* The 108 bits of a child begin in words 2, 5, 9 and 12, and none at the begin of its word. */
    bool low = slot < 2u, even = (slot & 1u) == 0u;
    uint v = pick(low, pick(even, w.a.z, w.b.y), pick(even, w.c.y, w.d.x));
    uint x = pick(low, pick(even, w.a.w, w.b.z), pick(even, w.c.z, w.d.y));
    uint y = pick(low, pick(even, w.b.x, w.b.w), pick(even, w.c.w, w.d.z));
    uint z = pick(low, pick(even, w.b.y, w.c.x), pick(even, w.d.x, w.d.w));
    uint shift = (16u + 12u * slot) & 31u, back = 32u - shift;
    v = v >> shift | x << back;
    x = x >> shift | y << back;
    y = y >> shift | z << back;
    z = z >> shift | w.c.y << back; /* all that the second child needs; others have it in z */
    vec3 lower = vec3(plane_of(v & 0x3FFFFu, w.unit.x, 0u),
                      plane_of((v >> 18 | x << 14) & 0x3FFFFu, w.unit.y, 0u),
                      plane_of((x >> 4) & 0x3FFFFu, w.unit.z, 0u));
    vec3 upper = vec3(plane_of((x >> 22 | y << 10) & 0x3FFFFu, w.unit.x, 1u),
                      plane_of((y >> 8) & 0x3FFFFu, w.unit.y, 1u),
                      plane_of((y >> 26 | z << 6) & 0x3FFFFu, w.unit.z, 1u));
    slab_order(r, lower, upper, nearer, farther);

    uint at = slot << 3, items = (w.items >> at) & 0xFFu;
    uint first = (w.a.x & 0x3FFFFFu) + ((w.nodes_before >> at) & 0xFFu);
    uint item = ((w.a.x >> 22) & 127u | ((w.a.y >> 9) & 0x7FFFu) << 7) +
                ((w.items_before >> at) & 0xFFu);
    bool inner = ((w.types >> 3u * slot) & 7u) == 4u;
    return node(pick(inner, first, NODE_LEAF | items), pick(inner, 0u, item));
}

#include "wide.glsl"

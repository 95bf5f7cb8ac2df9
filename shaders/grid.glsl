/* The layouts of ref/layouts/grid.h: nodes of WIDE slots. Number format and frame are constants of
 * the pipeline. The including file defines WIDE. */
#include "half.glsl"

layout(constant_id = ABI_SPEC_LAYOUT_0) const uint NUMBER = ABI_NUMBER_U8;
layout(constant_id = ABI_SPEC_LAYOUT_1) const uint FRAME = ABI_FRAME_NODE;

/* ABI_BIND_NODES as words, since records are not a whole number of quads. */
layout(std430, set = 0, binding = ABI_BIND_NODES) readonly buffer Words { uint node_word[]; };

#define SLOT_INNER 0x80u
#define SLOT_WORDS ((WIDE + 3u) / 4u) /* words that hold a byte per slot */

/* A node during traversal. Inner: a is its record. Leaf: a is bit 31 and the number of items, b the
 * first item. */
struct node {
    uint a;
    uint b;
};

#define NODE_DONE node(NODE_LEAF, 0u)

/* A record: the offset of its codes, and what precedes them. */
struct wide {
    uint codes;
    uint child;
    uint item;
    uvec2 slots;
    vec3 origin;
    vec3 scale;
};

uint grid_code_words()
{
    uint bits = 16u;
    if (NUMBER == ABI_NUMBER_F32)
        bits = 32u;
    if (NUMBER == ABI_NUMBER_U8)
        bits = 8u;
    if (NUMBER == ABI_NUMBER_U12)
        bits = 12u;
    uint words = (6u * WIDE * bits + 31u) / 32u;
    if (NUMBER == ABI_NUMBER_U10)
        words = 2u * WIDE;
    return words;
}

node node_of(uint ref)
{
    return node(ref, 0u);
}

wide wide_load(node n)
{
    wide w;
    uint head = 2u + SLOT_WORDS + (FRAME == ABI_FRAME_NODE ? 4u : 0u);
    uint at = n.a * (head + grid_code_words());
    w.codes = at + head;
    w.child = NODE_WORD(at);
    w.item = NODE_WORD(at + 1u);
    w.slots = uvec2(NODE_WORD(at + 2u), NODE_WORD(at + 1u + SLOT_WORDS));
    w.origin = vec3(0.0);
    w.scale = vec3(1.0);
    if (FRAME != ABI_FRAME_WORLD) {
        uint frame = FRAME == ABI_FRAME_NODE ? w.codes - 4u : 0u;
        uvec3 origin = uvec3(NODE_WORD(frame), NODE_WORD(frame + 1u), NODE_WORD(frame + 2u));
        uint scale = NODE_WORD(frame + 3u);
        w.origin = uintBitsToFloat(origin);
        w.scale = uintBitsToFloat((uvec3(scale, scale >> 8, scale >> 16) & 255u) << 23);
    }
    return w;
}

/* Returns the codes of a slot's bounds on an axis, the lower one first. */
uvec2 grid_codes(uint codes, uint slot, uint axis)
{
    uint pair = 3u * slot + axis;
    uvec2 found;
    if (NUMBER == ABI_NUMBER_F32) {
        found = uvec2(NODE_WORD(codes + 2u * pair), NODE_WORD(codes + 2u * pair + 1u));
    } else if (NUMBER == ABI_NUMBER_U8) {
        uint word = NODE_WORD(codes + (pair >> 1)) >> (pair & 1u) * 16u;
        found = uvec2(word, word >> 8) & 0xFFu;
    } else if (NUMBER == ABI_NUMBER_U10) {
        uint first = 2u * axis, second = 2u * axis + 1u; /* index among the slot's six codes */
        uint low = NODE_WORD(codes + 2u * slot), high = NODE_WORD(codes + 2u * slot + 1u);
        found.x = pick(first < 3u, low >> first * 10u, high >> (first - 3u) * 10u) & 0x3FFu;
        found.y = pick(second < 3u, low >> second * 10u, high >> (second - 3u) * 10u) & 0x3FFu;
    } else if (NUMBER == ABI_NUMBER_U12) {
        uint bit = pair * 24u & 31u, word = codes + (pair * 24u >> 5);
        uint low = NODE_WORD(word) >> bit;
        uint high = NODE_WORD(word + (bit > 8u ? 1u : 0u)) << (32u - bit & 31u);
        low |= bit > 8u ? high : 0u;
        found = uvec2(low, low >> 12) & 0xFFFu;
    } else {
        uint word = NODE_WORD(codes + pair);
        found = uvec2(word, word >> 16) & 0xFFFFu;
    }
    return found;
}

/* Converts a code of the number format to float, exactly. */
float grid_number(uint code)
{
    float number;
    if (NUMBER == ABI_NUMBER_F32)
        number = uintBitsToFloat(code);
    else if (NUMBER == ABI_NUMBER_F16)
        number = half_any(code);
    else if (NUMBER == ABI_NUMBER_BF16)
        number = uintBitsToFloat(code << 16);
    else
        number = float(code);
    return number;
}

float grid_bound(uint code, float origin, float scale)
{
    float number = grid_number(code);
    precise float scaled = number * scale;
    precise float placed = origin + scaled;
    return FRAME == ABI_FRAME_WORLD ? number : placed;
}

void grid_box(wide w, uint slot, out vec3 lo, out vec3 hi)
{
    uvec2 x = grid_codes(w.codes, slot, 0u);
    uvec2 y = grid_codes(w.codes, slot, 1u);
    uvec2 z = grid_codes(w.codes, slot, 2u);
    lo = vec3(grid_bound(x.x, w.origin.x, w.scale.x), grid_bound(y.x, w.origin.y, w.scale.y),
              grid_bound(z.x, w.origin.z, w.scale.z));
    hi = vec3(grid_bound(x.y, w.origin.x, w.scale.x), grid_bound(y.y, w.origin.y, w.scale.y),
              grid_bound(z.y, w.origin.z, w.scale.z));
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    vec3 lo, hi;
    grid_box(w, slot, lo, hi);
    slab_order(r, lo, hi, nearer, farther);
    uint byte = pick(slot < 4u, w.slots.x, w.slots.y) >> (slot & 3u) * 8u & 255u;
    uint child = w.child + (byte & 7u), records = job.node_count / (1u + WIDE);
    bool inner = both(byte >= SLOT_INNER, byte < SLOT_INNER + 8u, child < records);
    uint a = pick(inner, child, NODE_LEAF);
    a = pick(byte < SLOT_INNER, NODE_LEAF | (byte >> 5) + 1u, a);
    return node(a, w.item + (byte & 31u));
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
    return at < job.item_count ? ITEM_WORD(at) : ABI_NO_PRIM;
}

#include "wide.glsl"

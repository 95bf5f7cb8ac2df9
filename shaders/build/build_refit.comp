#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new bounds into the nodes of a binary layout, as packed_refit does, for vertices that have
 * moved: an invocation begins at a leaf. Of equal bounds the one that comes first stays, as in C,
 * where 0 and -0 are equal. */
#include "ref/abi_build.h"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { build_push job; }; /* count: leaves; axis_bits: the layout */

layout(std430, set = 0, binding = ABI_BUILD_VERTICES) readonly buffer Vertices {
    uint vertex_word[];
};
layout(std430, set = 0, binding = ABI_BUILD_INDICES) readonly buffer Indices {
    uint index_word[];
};
layout(std430, set = 0, binding = ABI_REFIT_NODES) buffer Nodes { uint node_word[]; };
layout(std430, set = 0, binding = ABI_REFIT_ITEMS) readonly buffer Items { uint item_word[]; };
layout(std430, set = 0, binding = ABI_REFIT_LEAVES) readonly buffer Leaves { uint leaves[]; };
layout(std430, set = 0, binding = ABI_REFIT_LINKS) coherent buffer Links { uint links[]; };
layout(std430, set = 0, binding = ABI_BUILD_BOXES) coherent buffer Boxes { uint box_word[]; };
layout(std430, set = 0, binding = ABI_BUILD_STATE) buffer State { uint state[]; };

#include "build_wait.glsl"

#define HALF_NORMAL 0x38800000u /* 2^-14, the least magnitude that is not 0 */
#define HALF_MOST   0x477FE000u /* 65504 */

uint low[3], high[3]; /* bits */

/* A number in the order of the floats. */
uint order_of(uint bits)
{
    if (bits == 0x80000000u)
        return 0x80000000u;
    return (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
}

void grow(uint k, uint lo, uint hi)
{
    if (order_of(lo) < order_of(low[k]))
        low[k] = lo;
    if (order_of(hi) > order_of(high[k]))
        high[k] = hi;
}

void begin()
{
    for (uint k = 0u; k < 3u; k++) {
        low[k] = 0x7F800000u;
        high[k] = 0xFF800000u;
    }
}

void grow_triangle(uint triangle)
{
    for (uint c = 0u; c < 3u; c++)
        for (uint k = 0u; k < 3u; k++) {
            uint bits = vertex_word[3u * index_word[3u * triangle + c] + k];
            grow(k, bits, bits);
        }
}

void grow_node(uint ref)
{
    for (uint k = 0u; k < 3u; k++)
        grow(k, box_word[6u * ref + k], box_word[6u * ref + 3u + k]);
}

/* The half of a bound, without the sign: toward 0, or away from it. */
uint half_of(uint magnitude, bool away)
{
    if (magnitude < HALF_NORMAL)
        return away && magnitude != 0u ? 0x400u : 0u;
    return (magnitude - 0x38000000u + (away ? 0x1FFFu : 0u)) >> 13;
}

uint half_bound(uint bits, bool up)
{
    bool negative = (bits >> 31) != 0u;
    uint code = half_of(bits & 0x7FFFFFFFu, negative != up);
    return code != 0u && negative ? code | 0x8000u : code;
}

void write_node(uint ref)
{
    for (uint k = 0u; k < 3u; k++) {
        box_word[6u * ref + k] = low[k];
        box_word[6u * ref + 3u + k] = high[k];
        if (job.axis_bits == ABI_REFIT_F32) {
            node_word[8u * ref + k] = low[k];
            node_word[8u * ref + 4u + k] = high[k];
            continue;
        }
        if (max(low[k] & 0x7FFFFFFFu, high[k] & 0x7FFFFFFFu) > HALF_MOST)
            atomicAdd(state[ABI_REFIT_BEYOND], 1u);
        node_word[4u * ref + k] = half_bound(low[k], false) | half_bound(high[k], true) << 16;
    }
}

void do_leaf(uint ref)
{
    begin();
    if (job.axis_bits == ABI_REFIT_F32) {
        uint first = node_word[8u * ref + 3u], count = node_word[8u * ref + 7u];
        for (uint i = 0u; i < count; i++)
            grow_triangle(item_word[first + i]);
    } else {
        uint count = node_word[4u * ref + 3u] & 15u;
        for (uint i = 0u; i < count; i++)
            grow_triangle((node_word[4u * ref + 4u + i / 2u] >> (16u * (i & 1u))) & 0xFFFFu);
    }
    write_node(ref);
}

void do_inner(uint ref)
{
    uint tag = node_word[4u * ref + 3u];
    bool wide = job.axis_bits == ABI_REFIT_F32;
    begin();
    grow_node(wide ? ref + 1u : (tag >> 16) & 0x7FFFu);
    grow_node(wide ? node_word[8u * ref + 3u] : tag & 0xFFFFu);
    write_node(ref);
}

void main()
{
    uint node = ABI_LINK_NONE;
    if (gl_GlobalInvocationID.x < job.count) {
        uint ref = leaves[gl_GlobalInvocationID.x];
        do_leaf(ref);
        node = links[2u * ref];
    }
    while (any_on(node != ABI_LINK_NONE)) {
        if (is_second(node != ABI_LINK_NONE, 2u * node + 1u)) {
            do_inner(node);
            node = links[2u * node];
        } else {
            node = ABI_LINK_NONE;
        }
    }
}

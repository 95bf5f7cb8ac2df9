/* Refits of packed trees: bounds of triangles, and the way up from the nodes that wait for no
 * other. Of equal bounds the one that comes first stays, as in C, where 0 and -0 are equal. */
#ifndef BUILD_REFIT_GLSL
#define BUILD_REFIT_GLSL

#include "ref/abi_build.h"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { refit_push job; };

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

void do_first(uint ref); /* writes a node that waits for no other */
void do_inner(uint ref); /* one whose children are done */

void main()
{
    uint node = ABI_LINK_NONE;
    if (gl_GlobalInvocationID.x < job.count) {
        uint ref = leaves[gl_GlobalInvocationID.x];
        do_first(ref);
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

#endif

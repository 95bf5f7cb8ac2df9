/* Inputs and outputs of every shader that builds a tree; see ref/abi_build.h. All arithmetic is of
 * integers: nothing is rounded or flushed. */
#ifndef BUILD_JOB_GLSL
#define BUILD_JOB_GLSL

#include "ref/abi_build.h"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { build_push job; };

#ifndef BUILD_WIDE
layout(std430, set = 0, binding = ABI_BUILD_VERTICES) readonly buffer Vertices {
    uint vertex_word[];
};
layout(std430, set = 0, binding = ABI_BUILD_INDICES) readonly buffer Indices {
    uint index_word[];
};
layout(std430, set = 0, binding = ABI_BUILD_OTHERS) coherent buffer Others { uvec4 others[]; };
#endif
layout(std430, set = 0, binding = ABI_BUILD_KEYS) buffer Keys { uvec4 keys[]; };
layout(std430, set = 0, binding = ABI_BUILD_COUNTS) buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = ABI_BUILD_LINKS) coherent buffer Links { uint links[]; };
layout(std430, set = 0, binding = ABI_BUILD_BOXES) coherent buffer Boxes { uint box_word[]; };
layout(std430, set = 0, binding = ABI_BUILD_STATE) buffer State { uint state[]; };

/* Maps a float's bits to a number of the same order, and back. There is no -0. */
uint to_order(uint bits)
{
    return (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
}

uint from_order(uint number)
{
    return (number >> 31) != 0u ? number & 0x7FFFFFFFu : ~number;
}

#ifndef BUILD_WIDE
/* The bounds of a triangle, as such numbers. */
void triangle_bounds(uint triangle, out uvec3 lo, out uvec3 hi)
{
    lo = uvec3(0xFFFFFFFFu);
    hi = uvec3(0u);
    for (uint c = 0u; c < 3u; c++) {
        uint first = 3u * index_word[3u * triangle + c];
        for (uint k = 0u; k < 3u; k++) {
            uint bits = vertex_word[first + k];
            uint number = to_order(bits == 0x80000000u ? 0u : bits);
            lo[k] = min(lo[k], number);
            hi[k] = max(hi[k], number);
        }
    }
}
#endif

#endif

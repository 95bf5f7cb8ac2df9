#version 450
#extension GL_GOOGLE_include_directive : require
/* The conditions without branches. Invocation i has the condition a in bit 0, b in bit 1 and c in
 * bit 2; tests/base/test_vulkan_pick.c compares what is picked with C. */
#include "ref/abi.h"
#include "pick.glsl"

#define RESULTS 13u

layout(local_size_x_id = ABI_SPEC_WORKGROUP) in;
layout(std430, set = 0, binding = 0) readonly buffer In { uint unread[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { float result[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x, at = i * RESULTS;
    bool a = (i & 1u) != 0u, b = (i & 2u) != 0u, c = (i & 4u) != 0u;
    result[at] = both(a, b) ? 1.0 : 0.0;
    result[at + 1u] = both(a, b, c) ? 1.0 : 0.0;
    result[at + 2u] = float(pick(a, 2u, 12u));
    result[at + 3u] = pick(a, 3.0, 13.0);
    vec2 two = pick(a, vec2(4.0, 5.0), vec2(14.0, 15.0));
    vec3 three = pick(a, vec3(6.0, 7.0, 8.0), vec3(16.0, 17.0, 18.0));
    vec4 four = pick(a, vec4(9.0, 10.0, 11.0, 12.0), vec4(19.0, 20.0, 21.0, 22.0));
    for (uint k = 0u; k < 2u; k++)
        result[at + 4u + k] = two[k];
    for (uint k = 0u; k < 3u; k++)
        result[at + 6u + k] = three[k];
    for (uint k = 0u; k < 4u; k++)
        result[at + 9u + k] = four[k];
}

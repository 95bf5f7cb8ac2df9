#version 450
#extension GL_GOOGLE_include_directive : require
/* The square root of the rendering shaders. Invocation i takes the root of the float with code
 * first + i * stride, from an estimate that is `worse` ulp off the driver's.
 * tests/gpu/test_vulkan_sqrt.c compares the roots with C's. */
#include "ref/abi.h"
#include "sqrt.glsl"

layout(local_size_x_id = ABI_SPEC_WORKGROUP) in;
layout(push_constant) uniform Push { uint first; uint stride; int worse; };
layout(std430, set = 0, binding = 0) readonly buffer In { uint unread[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { uint root[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    root[i] = floatBitsToUint(sqrt_from(uintBitsToFloat(first + i * stride), worse));
}

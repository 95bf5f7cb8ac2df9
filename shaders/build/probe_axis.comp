#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i makes the axis of a pair of bounds. Four words each: lo, hi, most, a number between
 * them. Written: the origin, the exponent, and the planes below and above lo, hi and the
 * number. tests/layouts/test_axis_gpu.c compares them. */
#include "build_axis.glsl"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint count; };
layout(std430, set = 0, binding = 0) readonly buffer In { uvec4 given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { uvec4 made[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count)
        return;
    uvec4 g = given[i];
    node_axis axis = node_axis_make(g.x, g.y, g.z);
    made[2u * i] = uvec4(node_axis_origin(axis), uint(axis.exponent), node_axis_down(axis, g.x),
                         node_axis_up(axis, g.y));
    made[2u * i + 1u] = uvec4(node_axis_up(axis, g.x), node_axis_down(axis, g.y),
                              node_axis_down(axis, g.w), node_axis_up(axis, g.w));
}

#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i makes an axis of the grid family, in the format that is given. Four words each: lo,
 * hi, two bounds. Written: whether there is an axis, its origin and exponent, and of each bound the
 * codes of the two ways, in that axis and in the world; first whether there is one.
 * tests/layouts/test_number_gpu.c compares them. */
#include "build_number.glsl"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint count, number; };
layout(std430, set = 0, binding = 0) readonly buffer In { uint given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { uint made[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x, at = 19u * i, code;
    if (i >= count)
        return;
    number_format format = format_of(number);
    number_axis axis;
    bool there = number_axis_make(format, given[4u * i], given[4u * i + 1u], axis);
    made[at] = there ? 1u : 0u;
    made[at + 1u] = axis.origin;
    made[at + 2u] = uint(axis.exponent);
    for (uint b = 0u; b < 4u; b++) {
        uint bound = given[4u * i + 2u + b / 2u], to = at + 3u + 4u * b;
        bool up = b % 2u != 0u;
        made[to] = framed_code(format, axis.origin, axis.exponent, bound, up, code) ? 1u : 0u;
        made[to + 1u] = code;
        made[to + 2u] = world_code(format, bound, up, code) ? 1u : 0u;
        made[to + 3u] = code;
    }
}

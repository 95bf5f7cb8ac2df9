#version 450
/* Float16 conversions in both directions, measured by gpu/card/card.c. Word i is packed as a float,
 * into both halves, and unpacked as two halves. */
layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint word_count; };
layout(std430, set = 0, binding = 0) readonly buffer In { uint given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { uint result[]; };

#define RESULTS 3u

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= word_count)
        return;
    float x = uintBitsToFloat(given[i]);
    vec2 halves = unpackHalf2x16(given[i]);
    result[RESULTS * i] = packHalf2x16(vec2(x, x));
    result[RESULTS * i + 1u] = floatBitsToUint(halves.x);
    result[RESULTS * i + 2u] = floatBitsToUint(halves.y);
}

#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i writes boxes into record i of layouts cwbvh80 and tiny8: first the word whose bits
 * tell which slots are there, then six bounds for each of 8 slots; the records, of 20 and 16 words,
 * have words before. tests/layouts/test_axis_gpu.c compares them. */
#include "encode_cwbvh80.glsl"
#include "encode_tiny8.glsl"

layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint count; };
layout(std430, set = 0, binding = 0) readonly buffer In { uint given[]; };
layout(std430, set = 0, binding = 1) buffer Out { uint made[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count)
        return;
    uint box[BOX_WORDS], cwbvh80[20], tiny8[16];
    for (uint w = 0u; w < uint(BOX_WORDS); w++)
        box[w] = given[49u * i + 1u + w];
    for (uint w = 0u; w < 20u; w++)
        cwbvh80[w] = made[36u * i + w];
    for (uint w = 0u; w < 16u; w++)
        tiny8[w] = made[36u * i + 20u + w];
    encode_cwbvh80(given[49u * i], box, cwbvh80);
    encode_tiny8(given[49u * i], box, tiny8);
    for (uint w = 0u; w < 20u; w++)
        made[36u * i + w] = cwbvh80[w];
    for (uint w = 0u; w < 16u; w++)
        made[36u * i + 20u + w] = tiny8[w];
}

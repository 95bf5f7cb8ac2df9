#version 450
/* Arithmetic without NoContraction, which the build does not add to this shader. gpu/card/card.c
 * measures whether the driver contracts or rearranges it. */
layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint triple_count; };
layout(std430, set = 0, binding = 0) readonly buffer In { float given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { float result[]; };

#define RESULTS 2u

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= triple_count)
        return;
    float a = given[3u * i], b = given[3u * i + 1u], c = given[3u * i + 2u];
    result[RESULTS * i] = a * b + c;
    result[RESULTS * i + 1u] = (a - b) * c;
}

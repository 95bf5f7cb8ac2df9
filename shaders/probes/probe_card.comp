#version 450
/* Operations that the tracing shaders must not use, because drivers differ in them. gpu/card/card.c
 * measures them on its triples. */
layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint triple_count; };
layout(std430, set = 0, binding = 0) readonly buffer In { float given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { float result[]; };

#define RESULTS 5u

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= triple_count)
        return;
    float a = given[3u * i], b = given[3u * i + 1u], c = given[3u * i + 2u];
    result[RESULTS * i] = sqrt(a);
    result[RESULTS * i + 1u] = inversesqrt(a);
    result[RESULTS * i + 2u] = fma(a, b, c);
    result[RESULTS * i + 3u] = min(a, b);
    result[RESULTS * i + 4u] = max(a, b);
}

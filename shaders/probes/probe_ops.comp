#version 450
/* The float operations of the tracing shaders, on triples of the host. The build decorates them
 * with NoContraction as in those shaders; gpu/card/probe.c compares the results with C. */
layout(local_size_x_id = 0) in;
layout(push_constant) uniform Push { uint triple_count; };
layout(std430, set = 0, binding = 0) readonly buffer In { float given[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Out { float result[]; };

#define RESULTS 7u

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= triple_count)
        return;
    float a = given[3u * i], b = given[3u * i + 1u], c = given[3u * i + 2u];
    result[RESULTS * i] = a + b;
    result[RESULTS * i + 1u] = a - b;
    result[RESULTS * i + 2u] = a * b;
    result[RESULTS * i + 3u] = a / b;
    result[RESULTS * i + 4u] = 1.0 / b;
    result[RESULTS * i + 5u] = a * b + c;
    result[RESULTS * i + 6u] = a < b ? a : b;
}

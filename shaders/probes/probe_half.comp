#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i decodes a word that holds the half code i in its low half and -i in its high half,
 * as the x bounds (met in order) and as the y bounds (swapped) of a box. It writes near x, near y,
 * far x, far y by half_bounds, then the same by half_bounds_any. tests/base/test_half_gpu.c
 * compares them. */
#include "half.glsl"

void main()
{
    uint code = gl_GlobalInvocationID.x;
    if (code >= job.ray_count)
        return;
    slab_ray r = slab_ray_make(vec3(0.0), vec3(1.0, -1.0, 1.0), 0.0);
    uint other = code ^ 0x8000u;
    uvec3 bounds = uvec3(code | other << 16, code | other << 16, 0u);
    vec3 near_n, far_n, near_a, far_a;
    half_bounds(r, bounds, near_n, far_n);
    half_bounds_any(r, bounds, near_a, far_a);
    hit_quad[2u * code] = floatBitsToUint(vec4(near_n.xy, far_n.xy));
    hit_quad[2u * code + 1u] = floatBitsToUint(vec4(near_a.xy, far_a.xy));
}

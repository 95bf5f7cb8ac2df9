#version 450
#extension GL_GOOGLE_include_directive : require
/* Invocation i decodes record i of two slots as the layouts of grid.glsl do, whatever it holds, and
 * writes the 12 bounds: lower x, y, z, upper x, y, z of each slot. tests/tree/test_grid_gpu.c
 * compares them. */
#include "layout_grid2.glsl"

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= job.ray_count)
        return;
    wide w = wide_load(node_of(id));
    vec3 lo0, hi0, lo1, hi1;
    grid_box(w, 0u, lo0, hi0);
    grid_box(w, 1u, lo1, hi1);
    hit_quad[3u * id] = floatBitsToUint(vec4(lo0, hi0.x));
    hit_quad[3u * id + 1u] = floatBitsToUint(vec4(hi0.yz, lo1.xy));
    hit_quad[3u * id + 2u] = floatBitsToUint(vec4(lo1.z, hi1));
}

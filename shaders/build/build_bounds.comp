#version 450
#extension GL_GOOGLE_include_directive : require
/* The bounds of the scene: of a workgroup's triangles in shared memory, then of all. */
#include "build_job.glsl"

shared uint group_bounds[6];

void main()
{
    uint i = gl_GlobalInvocationID.x, mine = gl_LocalInvocationID.x;
    if (mine < 6u)
        group_bounds[mine] = mine < 3u ? 0xFFFFFFFFu : 0u;
    barrier();
    if (i < job.count) {
        uvec3 lo, hi;
        triangle_bounds(i, lo, hi);
        for (uint k = 0u; k < 3u; k++) {
            atomicMin(group_bounds[k], lo[k]);
            atomicMax(group_bounds[3u + k], hi[k]);
        }
    }
    barrier();
    if (mine < 3u)
        atomicMin(state[ABI_STATE_LO + mine], group_bounds[mine]);
    else if (mine < 6u)
        atomicMax(state[ABI_STATE_LO + mine], group_bounds[mine]);
}

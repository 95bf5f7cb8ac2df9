#version 450
#extension GL_GOOGLE_include_directive : require
/* How often each digit occurs in a block of keys: counts[digit * blocks + block]. */
#include "build_digit.glsl"

shared uint total[DIGITS];

void main()
{
    uint mine = gl_LocalInvocationID.x, block = gl_WorkGroupID.x;
    if (mine < DIGITS)
        total[mine] = 0u;
    barrier();
    uint first = (block * ABI_BUILD_GROUP + mine) * ABI_BUILD_EACH;
    for (uint i = first; i < min(first + ABI_BUILD_EACH, job.count); i++)
        atomicAdd(total[digit_of(key_at(i))], 1u);
    barrier();
    if (mine < DIGITS)
        counts[mine * job.blocks + block] = total[mine];
}

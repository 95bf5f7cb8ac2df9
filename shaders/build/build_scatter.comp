#version 450
#extension GL_GOOGLE_include_directive : require
/* Moves the keys of a block behind those of smaller digits, of the same digit in earlier blocks, in
 * earlier invocations, and before them in its own: equal digits keep their order. */
#include "build_digit.glsl"

shared uint before[DIGITS][ABI_BUILD_GROUP];

void main()
{
    uint mine = gl_LocalInvocationID.x, block = gl_WorkGroupID.x;
    uint first = (block * ABI_BUILD_GROUP + mine) * ABI_BUILD_EACH;
    uint last = min(first + ABI_BUILD_EACH, job.count);
    for (uint d = 0u; d < DIGITS; d++)
        before[d][mine] = 0u;
    for (uint i = first; i < last; i++)
        before[digit_of(key_at(i))][mine]++;
    barrier();
    if (mine < DIGITS) {
        uint sum = counts[mine * job.blocks + block];
        for (uint i = 0u; i < ABI_BUILD_GROUP; i++) {
            uint own = before[mine][i];
            before[mine][i] = sum;
            sum += own;
        }
    }
    barrier();
    for (uint i = first; i < last; i++) {
        uvec4 key = key_at(i);
        uint to = before[digit_of(key)][mine]++;
        if (job.swapped != 0u)
            keys[to] = key;
        else
            others[to] = key;
    }
}

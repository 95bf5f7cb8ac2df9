#version 450
#extension GL_GOOGLE_include_directive : require
/* Adds up what the workgroups of a level found, and begins the next level. */
#include "build_wide.glsl"
#include "build_sum.glsl"

shared uint nodes_below;

void main()
{
    uint groups = state[level_word(ABI_LEVEL_GROUPS)];
    uint first = state[level_word(ABI_LEVEL_FIRST)] + state[level_word(ABI_LEVEL_COUNT)];
    uint items = state[level_word(ABI_LEVEL_ITEMS)];
    uvec2 run = sum_counts(2u * groups + 1u);
    if (groups >= run.x && groups < run.y) {
        uint nodes = min(counts[groups], job.blocks - min(first, job.blocks));
        nodes_below = counts[groups];
        state[next_word(ABI_LEVEL_FIRST)] = first;
        state[next_word(ABI_LEVEL_COUNT)] = nodes;
        state[next_word(ABI_LEVEL_GROUPS)] = (nodes + ABI_BUILD_GROUP - 1u) / ABI_BUILD_GROUP;
    }
    barrier();
    if (2u * groups >= run.x && 2u * groups < run.y)
        state[next_word(ABI_LEVEL_ITEMS)] = items + counts[2u * groups] - nodes_below;
}

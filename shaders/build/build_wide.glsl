/* What the shaders of wide trees share: ref/staged/staged_wide.h has the rule, ref/abi_build.h the
 * words. */
#ifndef BUILD_WIDE_GLSL
#define BUILD_WIDE_GLSL

#define BUILD_WIDE /* build_job.glsl without the buffers that stand elsewhere */
#include "build_job.glsl"

layout(std430, set = 0, binding = ABI_WIDE_PACKED) buffer Packed { uint packed_word[]; };
layout(std430, set = 0, binding = ABI_WIDE_ITEMS) buffer Items { uint item_word[]; };
layout(std430, set = 0, binding = ABI_WIDE_NODES) buffer Nodes { uint wide_word[]; };

#define LEAF_MOST job.shift

/* A word of the level that is being made, and of the next. */
uint level_word(uint word)
{
    return ABI_STATE_LEVEL + (job.swapped != 0u ? ABI_LEVEL_WORDS : 0u) + word;
}

uint next_word(uint word)
{
    return ABI_STATE_LEVEL + (job.swapped != 0u ? 0u : ABI_LEVEL_WORDS) + word;
}

/* Triangles of a subtree. */
uint size_of(uint link)
{
    return (link & ABI_LINK_LEAF) != 0u ? 1u : links[ABI_BUILD_LINK_WORDS * link + ABI_LINK_FIRST];
}

#endif

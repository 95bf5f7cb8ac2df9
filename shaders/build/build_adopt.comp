#version 450
#extension GL_GOOGLE_include_directive : require
/* Prepares a binary tree for its collapse: an invocation takes in the links of an inner node, and
 * becomes its children's parent. The first also begins the level of the root. */
#include "build_wide.glsl"

void set_parent(uint link, uint node)
{
    bool leaf = (link & ABI_LINK_LEAF) != 0u;
    uint word = leaf ? ABI_BUILD_LINK_WORDS * (job.count - 1u) + (link & ~ABI_LINK_LEAF)
                     : ABI_BUILD_LINK_WORDS * link + ABI_LINK_PARENT;
    links[word] = node;
}

void main()
{
    uint i = gl_GlobalInvocationID.x, word = ABI_BUILD_LINK_WORDS * i;
    if (i == 0u) {
        uint root = state[ABI_STATE_ROOT];
        wide_word[ABI_WIDE_ROOT] = root;
        for (uint w = 0u; w < 2u * ABI_LEVEL_WORDS; w++) {
            bool one = w == ABI_LEVEL_COUNT || w % ABI_LEVEL_WORDS > ABI_LEVEL_GROUPS;
            state[ABI_STATE_LEVEL + w] = one || w == ABI_LEVEL_GROUPS ? 1u : 0u;
        }
        if ((root & ABI_LINK_LEAF) == 0u)
            links[ABI_BUILD_LINK_WORDS * root + ABI_LINK_PARENT] = ABI_LINK_NONE;
    }
    if (i + 1u >= job.count)
        return;
    for (uint c = 0u; c < 2u; c++) {
        if (job.swapped != 0u)
            links[word + ABI_LINK_CHILD + c] = counts[2u * i + c];
        set_parent(links[word + ABI_LINK_CHILD + c], i);
    }
    links[word + ABI_LINK_VISITS] = 0u;
}

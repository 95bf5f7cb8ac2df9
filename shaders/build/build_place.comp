#version 450
#extension GL_GOOGLE_include_directive : require
/* A level of the wide tree: an invocation numbers the children of a node that are nodes, and writes
 * the items of the others. */
#include "build_wide.glsl"

#define LEAF_ROOM 16

/* Writes the items of a leaf from `item` on. */
void put_items(uint link, uint kind, uint item)
{
    uint open[LEAF_ROOM], count = 1u, end = min(item + kind, job.count);
    open[0] = link;
    for (uint round = 0u; round < 2u * kind && count > 0u; round++) {
        uint at = open[--count];
        if ((at & ABI_LINK_LEAF) != 0u) {
            if (item < end)
                item_word[item++] = keys[at & ~ABI_LINK_LEAF].z;
            continue;
        }
        uint word = ABI_BUILD_LINK_WORDS * at + ABI_LINK_CHILD;
        open[min(count++, LEAF_ROOM - 1u)] = links[word + 1u];
        open[min(count++, LEAF_ROOM - 1u)] = links[word];
    }
}

void main()
{
    uint at = gl_GlobalInvocationID.x, group = gl_WorkGroupID.x;
    if (at >= state[level_word(ABI_LEVEL_COUNT)])
        return;
    uint word = ABI_WIDE_WORDS * (state[level_word(ABI_LEVEL_FIRST)] + at);
    uint groups = state[level_word(ABI_LEVEL_GROUPS)];
    uint before = wide_word[word + ABI_WIDE_BEFORE], kinds = wide_word[word + ABI_WIDE_KINDS];
    uint node = state[next_word(ABI_LEVEL_FIRST)] + counts[group] + (before & 0xFFFFu);
    uint item = state[level_word(ABI_LEVEL_ITEMS)] + counts[groups + group] - counts[groups] +
                (before >> 16);
    wide_word[word + ABI_WIDE_FIRST] = node;
    wide_word[word + ABI_WIDE_ITEM] = item;
    for (uint s = 0u; s < ABI_WIDE_MOST; s++) {
        uint kind = (kinds >> (4u * s)) & 15u, link = wide_word[word + ABI_WIDE_LINKS + s];
        if (kind != 0u && kind != ABI_WIDE_NODE) {
            put_items(link, kind, item);
            item += kind;
        } else if (kind != 0u) {
            if (node < job.blocks)
                wide_word[ABI_WIDE_WORDS * node + ABI_WIDE_ROOT] = link;
            node++;
        }
    }
}

/* Boxes of nodes, and the way up from a leaf. */
#ifndef BUILD_CLIMB_GLSL
#define BUILD_CLIMB_GLSL

#include "build_job.glsl"
#include "build_wait.glsl"

uint box_place(uint link)
{
    uint node = (link & ABI_LINK_LEAF) != 0u ? job.count - 1u + (link & ~ABI_LINK_LEAF) : link;
    return 6u * node;
}

void leaf_box(uint place)
{
    uvec3 lo, hi;
    triangle_bounds(keys[place].z, lo, hi);
    uint word = box_place(ABI_LINK_LEAF | place);
    for (uint k = 0u; k < 3u; k++) {
        box_word[word + k] = from_order(lo[k]);
        box_word[word + 3u + k] = from_order(hi[k]);
    }
}

void join_boxes(uint node, uint a, uint b)
{
    uint to = box_place(node), one = box_place(a), other = box_place(b);
    for (uint k = 0u; k < 3u; k++) {
        uint lo = min(to_order(box_word[one + k]), to_order(box_word[other + k]));
        uint hi = max(to_order(box_word[one + 3u + k]), to_order(box_word[other + 3u + k]));
        box_word[to + k] = from_order(lo);
        box_word[to + 3u + k] = from_order(hi);
    }
}

/* The parent of a leaf. */
uint leaf_parent(uint place)
{
    return job.count > 1u ? links[ABI_BUILD_LINK_WORDS * (job.count - 1u) + place] : ABI_LINK_NONE;
}

/* The leaf's own part; returns its parent. */
uint climb_from(uint place)
{
    if (place >= job.count)
        return ABI_LINK_NONE;
    leaf_box(place);
    if (job.count == 1u)
        state[ABI_STATE_ROOT] = ABI_LINK_LEAF;
    return leaf_parent(place);
}

uint visits_of(uint node)
{
    return ABI_BUILD_LINK_WORDS * node + ABI_LINK_VISITS;
}

#endif

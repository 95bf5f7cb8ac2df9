/* Boxes of nodes, and the way up from a leaf: whoever is second at a node goes on. */
#ifndef BUILD_CLIMB_GLSL
#define BUILD_CLIMB_GLSL

#include "build_job.glsl"

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

shared uint group_on;

/* Returns whether any invocation of the workgroup is still on its way. All of them call it and
 * is_second equally often: Mesa's lavapipe 22.3 runs a memory barrier as a barrier of execution, so
 * one in a loop that some have left would lose the others. */
bool any_on(bool on)
{
    barrier();
    if (gl_LocalInvocationID.x == 0u)
        group_on = 0u;
    barrier();
    if (on)
        atomicOr(group_on, 1u);
    barrier();
    return group_on != 0u;
}

/* Returns true if the other child of the node was done before, so that this invocation does the
 * node. What each wrote before is then visible to the second. */
bool is_second(bool on, uint node)
{
    uint before = 0u;
    memoryBarrierBuffer();
    if (on)
        before = atomicAdd(links[ABI_BUILD_LINK_WORDS * node + ABI_LINK_VISITS], 1u);
    memoryBarrierBuffer();
    return on && before == 1u;
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

#endif

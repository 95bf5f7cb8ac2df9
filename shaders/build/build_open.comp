#version 450
#extension GL_GOOGLE_include_directive : require
/* A level of the wide tree: an invocation finds the children of a node, and a workgroup how many of
 * them are nodes, and the items of the others. */
#include "build_wide.glsl"
#include "build_frame.glsl"

shared uint before_or_at[ABI_BUILD_GROUP];

uint slot[ABI_WIDE_MOST], size[ABI_WIDE_MOST];
uvec2 area[ABI_WIDE_MOST]; /* half of it, high word first */

void set_slot(uint exponent, uint at, uint link)
{
    uint word = 6u * ((link & ABI_LINK_LEAF) != 0u ? job.count - 1u + (link & ~ABI_LINK_LEAF)
                                                   : link);
    uint side[3];
    for (uint k = 0u; k < 3u; k++)
        side[k] = uint(frame_coordinate(exponent, box_word[word + 3u + k]) -
                       frame_coordinate(exponent, box_word[word + k]));
    uvec2 sum = uvec2(0u);
    for (uint k = 0u; k < 3u; k++) {
        uint more_high, more_low, carry;
        umulExtended(side[k], side[k == 2u ? 0u : k + 1u], more_high, more_low);
        sum.y = uaddCarry(sum.y, more_low, carry);
        sum.x += more_high + carry;
    }
    slot[at] = link;
    size[at] = size_of(link);
    area[at] = sum;
}

/* The slot to be opened; `number`: none. */
uint largest(uint number)
{
    uint best = number;
    for (uint s = number; s-- > 0u;) {
        if (size[s] <= LEAF_MOST)
            continue;
        bool less = best < number && (area[s].x < area[best].x ||
                                      (area[s].x == area[best].x && area[s].y < area[best].y));
        best = less ? best : s;
    }
    return best;
}

uint open_all(uint exponent, uint root)
{
    uint number = 1u;
    set_slot(exponent, 0u, root);
    while (number < ABI_WIDE_MOST) {
        uint at = largest(number);
        if (at == number)
            break;
        uint word = ABI_BUILD_LINK_WORDS * slot[at] + ABI_LINK_CHILD;
        for (uint s = number; s > at + 1u; s--) {
            slot[s] = slot[s - 1u];
            size[s] = size[s - 1u];
            area[s] = area[s - 1u];
        }
        set_slot(exponent, at, links[word]);
        set_slot(exponent, at + 1u, links[word + 1u]);
        number++;
    }
    return number;
}

/* Returns the number of children that are nodes, and in the upper half the items of the others. */
uint do_node(uint node)
{
    uint word = ABI_WIDE_WORDS * node, kinds = 0u, both = 0u;
    uint number = open_all(frame_exponent(), wide_word[word + ABI_WIDE_ROOT]);
    for (uint s = 0u; s < number; s++) {
        bool leaf = size[s] <= LEAF_MOST;
        wide_word[word + ABI_WIDE_LINKS + s] = slot[s];
        kinds |= (leaf ? size[s] : ABI_WIDE_NODE) << (4u * s);
        both += leaf ? size[s] << 16 : 1u;
    }
    wide_word[word + ABI_WIDE_KINDS] = kinds;
    return both;
}

void main()
{
    uint mine = gl_LocalInvocationID.x, at = gl_GlobalInvocationID.x;
    uint number = state[level_word(ABI_LEVEL_COUNT)], both = 0u;
    uint node = state[level_word(ABI_LEVEL_FIRST)] + at;
    if (at < number)
        both = do_node(node);
    before_or_at[mine] = both;
    barrier();
    for (uint step = 1u; step < ABI_BUILD_GROUP; step <<= 1) {
        uint before = mine >= step ? before_or_at[mine - step] : 0u;
        barrier();
        before_or_at[mine] += before;
        barrier();
    }
    if (at < number)
        wide_word[ABI_WIDE_WORDS * node + ABI_WIDE_BEFORE] = before_or_at[mine] - both;
    if (mine == ABI_BUILD_GROUP - 1u) {
        uint groups = state[level_word(ABI_LEVEL_GROUPS)];
        counts[gl_WorkGroupID.x] = before_or_at[mine] & 0xFFFFu;
        counts[groups + gl_WorkGroupID.x] = before_or_at[mine] >> 16;
    }
}

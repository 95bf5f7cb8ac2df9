#version 450
#extension GL_GOOGLE_include_directive : require
/* H-PLOC: an invocation climbs as for boxes, and merges the clusters of the ranges that it does.
 * The clusters of a range stand at its first places in `others`: x the link, y the place, and
 * at the first place z their number. A range of few places has none there: its leaves are its
 * clusters. The links of merged clusters stand in the counts, two for the place that was given
 * up. */
#include "build_climb.glsl"
#include "build_frame.glsl"

#define ROOM (2 * ABI_HPLOC_CLUSTERS)

uint link[ROOM], place_of[ROOM];
ivec3 low[ROOM], high[ROOM];
uint number; /* of clusters */

void load_cluster(uint exponent, uint at, uint its_link, uint its_place)
{
    uint word = box_place(its_link);
    link[at] = its_link;
    place_of[at] = its_place;
    for (uint k = 0u; k < 3u; k++) {
        low[at][k] = frame_coordinate(exponent, box_word[word + k]);
        high[at][k] = frame_coordinate(exponent, box_word[word + 3u + k]);
    }
}

uint places_of(uint node)
{
    uint word = ABI_BUILD_LINK_WORDS * node;
    return links[word + ABI_LINK_LAST] - links[word + ABI_LINK_FIRST] + 1u;
}

/* The clusters of a child. */
void load_side(uint exponent, uint child)
{
    bool leaf = (child & ABI_LINK_LEAF) != 0u;
    uint places = leaf ? 1u : places_of(child);
    uint first = leaf ? child & ~ABI_LINK_LEAF
                      : links[ABI_BUILD_LINK_WORDS * child + ABI_LINK_FIRST];
    bool few = places <= uint(ABI_HPLOC_CLUSTERS);
    uint more = few ? places : min(others[first].z, uint(ABI_HPLOC_CLUSTERS));
    for (uint place = first; place < first + more; place++) {
        uvec4 cluster = few ? uvec4(place | ABI_LINK_LEAF, place, 0u, 0u) : others[place];
        load_cluster(exponent, number, cluster.x, cluster.y);
        number++;
    }
}

/* Half the area of the box of two clusters, high word first. */
uvec2 common_area(uint a, uint b)
{
    uvec3 side = uvec3(max(high[a], high[b]) - min(low[a], low[b]));
    uvec2 sum = uvec2(0u);
    for (uint k = 0u; k < 3u; k++) {
        uint more_high, more_low, carry;
        umulExtended(side[k], side[k == 2u ? 0u : k + 1u], more_high, more_low);
        sum.y = uaddCarry(sum.y, more_low, carry);
        sum.x += more_high + carry;
    }
    return sum;
}

uint nearest(uint i)
{
    uvec2 least = uvec2(0xFFFFFFFFu);
    uint best = i;
    uint from = i > uint(ABI_HPLOC_RADIUS) ? i - uint(ABI_HPLOC_RADIUS) : 0u;
    uint last = min(i + uint(ABI_HPLOC_RADIUS), number - 1u);
    for (uint j = from; j <= last; j++) {
        if (j == i)
            continue;
        uvec2 area = common_area(i, j);
        bool same = area == least;
        bool less = area.x < least.x || (area.x == least.x && area.y < least.y);
        if (less || (same && (i ^ j) < (i ^ best))) {
            least = area;
            best = j;
        }
    }
    return best;
}

void merge_round(uint exponent)
{
    uint chosen[ROOM], left = 0u;
    for (uint i = 0u; i < number; i++)
        chosen[i] = nearest(i);
    for (uint i = 0u; i < number; i++) {
        uint j = chosen[i];
        bool both = chosen[j] == i;
        if (both && j < i)
            continue;
        uint its_link = link[i], its_place = place_of[i];
        if (both) {
            uint node = place_of[j] - 1u;
            counts[2u * node] = link[i];
            counts[2u * node + 1u] = link[j];
            join_boxes(node, link[i], link[j]);
            its_link = node;
        }
        load_cluster(exponent, left, its_link, its_place);
        left++;
    }
    number = left;
}

/* Merges what a node's children left, to one cluster at the root. Returns its parent. */
uint do_node(uint exponent, uint node)
{
    uint word = ABI_BUILD_LINK_WORDS * node, parent = links[word + ABI_LINK_PARENT];
    uint least = parent == ABI_LINK_NONE ? 1u : uint(ABI_HPLOC_CLUSTERS);
    if (places_of(node) <= least)
        return parent;
    number = 0u;
    load_side(exponent, links[word + ABI_LINK_CHILD]);
    load_side(exponent, links[word + ABI_LINK_CHILD + 1u]);
    for (uint round = 0u; round < uint(ROOM) && number > least; round++)
        merge_round(exponent);
    uint first = links[word + ABI_LINK_FIRST];
    for (uint i = 0u; i < number; i++)
        others[first + i] = uvec4(link[i], place_of[i], number, 0u);
    if (parent == ABI_LINK_NONE)
        state[ABI_STATE_ROOT] = link[0];
    return parent;
}

void main()
{
    uint node = climb_from(gl_GlobalInvocationID.x), exponent = frame_exponent();
    while (any_on(node != ABI_LINK_NONE)) {
        if (is_second(node != ABI_LINK_NONE, visits_of(node)))
            node = do_node(exponent, node);
        else
            node = ABI_LINK_NONE;
    }
}

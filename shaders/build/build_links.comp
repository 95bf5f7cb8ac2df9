#version 450
#extension GL_GOOGLE_include_directive : require
/* Karras 2012, figure 4: an invocation finds the range of an inner node, and where it is cut. */
#include "build_job.glsl"

/* The length of the common prefix of two codes, or of their places if the codes are equal. */
int prefix(int i, int j)
{
    if (j < 0 || j >= int(job.count))
        return -1;
    uvec4 a = keys[i], b = keys[j];
    if (a.x != b.x)
        return 31 - findMSB(a.x ^ b.x);
    if (a.y != b.y)
        return 63 - findMSB(a.y ^ b.y);
    return 95 - findMSB(uint(i ^ j));
}

void set_child(int node, uint side, int from, int to, int place)
{
    bool leaf = from == to;
    uint child = uint(place);
    links[ABI_BUILD_LINK_WORDS * uint(node) + ABI_LINK_CHILD + side] =
        leaf ? child | ABI_LINK_LEAF : child;
    uint parent = leaf ? ABI_BUILD_LINK_WORDS * (job.count - 1u) + child
                       : ABI_BUILD_LINK_WORDS * child + ABI_LINK_PARENT;
    links[parent] = uint(node);
}

void main()
{
    int i = int(gl_GlobalInvocationID.x);
    if (i >= int(job.count) - 1)
        return;
    int way = prefix(i, i + 1) > prefix(i, i - 1) ? 1 : -1;
    int least = prefix(i, i - way), reach = 2;
    while (prefix(i, i + reach * way) > least)
        reach *= 2;
    int length = 0;
    for (int step = reach / 2; step >= 1; step /= 2)
        if (prefix(i, i + (length + step) * way) > least)
            length += step;
    int end = i + length * way, whole = prefix(i, end), to_cut = 0, step = length;
    do {
        step = (step + 1) / 2;
        if (prefix(i, i + (to_cut + step) * way) > whole)
            to_cut += step;
    } while (step > 1);
    int cut = i + to_cut * way + min(way, 0), first = min(i, end), last = max(i, end);
    set_child(i, 0u, first, cut, cut);
    set_child(i, 1u, cut + 1, last, cut + 1);
    uint word = ABI_BUILD_LINK_WORDS * uint(i);
    links[word + ABI_LINK_VISITS] = 0u;
    links[word + ABI_LINK_FIRST] = uint(first);
    links[word + ABI_LINK_LAST] = uint(last);
    if (i == 0) {
        links[ABI_LINK_PARENT] = ABI_LINK_NONE;
        state[ABI_STATE_ROOT] = 0u;
    }
}

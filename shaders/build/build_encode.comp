#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes the records of a layout: an invocation one of a wide node. */
#include "build_wide.glsl"
#include "encode_cwbvh80.glsl"
#include "encode_tiny8.glsl"

uint box[BOX_WORDS], there;

void load_boxes(uint word, uint kinds)
{
    there = 0u;
    for (uint s = 0u; s < ABI_WIDE_MOST; s++) {
        if (((kinds >> (4u * s)) & 15u) == 0u)
            continue;
        uint link = wide_word[word + ABI_WIDE_LINKS + s];
        uint node = (link & ABI_LINK_LEAF) != 0u ? job.count - 1u + (link & ~ABI_LINK_LEAF) : link;
        there |= 1u << s;
        for (uint k = 0u; k < 6u; k++)
            box[6u * s + k] = box_word[6u * node + k];
    }
}

/* The first child that is a node, and the first item: 0 where there is none. */
uvec2 firsts_of(uint word, uint kinds)
{
    bool nodes = false, items = false;
    for (uint s = 0u; s < ABI_WIDE_MOST; s++) {
        uint kind = (kinds >> (4u * s)) & 15u;
        nodes = nodes || kind == ABI_WIDE_NODE;
        items = items || (kind != 0u && kind != ABI_WIDE_NODE);
    }
    return uvec2(nodes ? wide_word[word + ABI_WIDE_FIRST] : 0u,
                 items ? wide_word[word + ABI_WIDE_ITEM] : 0u);
}

void do_cwbvh80(uint node, uint kinds, uvec2 firsts)
{
    uint word[20] = uint[](0u, 0u, 0u, 0u, firsts.x, firsts.y, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u,
                           0u, 0u, 0u, 0u, 0u);
    uint items = 0u;
    encode_cwbvh80(there, box, word);
    for (uint s = 0u; s < ABI_WIDE_MOST; s++) {
        uint kind = (kinds >> (4u * s)) & 15u, meta = 0u;
        if (kind == ABI_WIDE_NODE) {
            word[3] |= 1u << (24u + s);
            meta = 32u | (24u + s);
        } else if (kind != 0u) {
            meta = ((1u << kind) - 1u) << 5 | items;
            items += kind;
        }
        word[6u + s / 4u] |= meta << (s % 4u * 8u);
    }
    for (uint w = 0u; w < 20u; w++)
        packed_word[20u * node + w] = word[w];
}

/* The kinds of children are those of the layout. */
void do_tiny8(uint node, uint kinds, uvec2 firsts)
{
    uint word[16] = uint[](0u, 0u, 0u, 0u, firsts.x, firsts.y, kinds, 0u, 0u, 0u, 0u, 0u, 0u, 0u,
                           0u, 0u);
    encode_tiny8(there, box, word);
    for (uint w = 0u; w < 16u; w++)
        packed_word[16u * node + w] = word[w];
}

void main()
{
    uint node = gl_GlobalInvocationID.x;
    if (node >= job.blocks)
        return;
    uint word = ABI_WIDE_WORDS * node, kinds = wide_word[word + ABI_WIDE_KINDS];
    uvec2 firsts = firsts_of(word, kinds);
    load_boxes(word, kinds);
    if (job.axis_bits == ABI_WIDE_CWBVH80)
        do_cwbvh80(node, kinds, firsts);
    else
        do_tiny8(node, kinds, firsts);
}

#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of layout cwbvh80, as packed_refit does. */
#define RECORD_WORDS   20u
#define MAGNITUDE_MOST 0x71800000u /* 2^100 */
#include "build_refit_wide.glsl"
#include "encode_cwbvh80.glsl"

uint read_slots(uint at)
{
    uint there = 0u, nodes = 0u, inner = node_word[at + 3u] >> 24;
    for (uint s = 0u; s < 8u; s++) {
        uint meta = (node_word[at + 6u + s / 4u] >> (s % 4u * 8u)) & 0xFFu;
        there |= meta != 0u ? 1u << s : 0u;
        if (((inner >> s) & 1u) != 0u) {
            slot_first[s] = node_word[at + 4u] + nodes++;
            slot_count[s] = 0u;
        } else {
            slot_first[s] = node_word[at + 5u] + (meta & 31u);
            slot_count[s] = uint(bitCount(meta >> 5));
        }
    }
    return there;
}

void write_boxes(uint at, uint there)
{
    uint word[20];
    for (uint w = 0u; w < 20u; w++)
        word[w] = node_word[at + w];
    encode_cwbvh80(there, slot_box, word);
    for (uint w = 0u; w < 20u; w++)
        node_word[at + w] = word[w];
}

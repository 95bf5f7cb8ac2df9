#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of layout tiny8 and its family, as packed_refit does. */
#define RECORD_WORDS   16u
#define MAGNITUDE_MOST 0x71800000u /* 2^100 */
#include "build_refit_wide.glsl"
#include "encode_tiny8.glsl"

uint read_slots(uint at)
{
    uint there = 0u, node = node_word[at + 4u], item = node_word[at + 5u];
    for (uint s = 0u; s < 8u; s++) {
        uint kind = (node_word[at + 6u] >> (4u * s)) & 15u;
        there |= kind != 0u ? 1u << s : 0u;
        slot_first[s] = kind == 15u ? node++ : item;
        slot_count[s] = kind == 15u ? 0u : kind;
        item += slot_count[s];
    }
    return there;
}

void write_boxes(uint at, uint there)
{
    uint word[16];
    for (uint w = 0u; w < 16u; w++)
        word[w] = node_word[at + w];
    encode_tiny8(there, slot_box, word);
    for (uint w = 0u; w < 16u; w++)
        node_word[at + w] = word[w];
}

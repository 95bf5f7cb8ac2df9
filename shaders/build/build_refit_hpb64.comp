#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of layout hpb64, as packed_refit does. */
#define RECORD_WORDS   16u
#define MAGNITUDE_MOST 0x7E800000u /* 2^126 */
#define COMMON_LEAST   43u
#define CODE_BITS      18u
#define CODE_UNITS     0x1FFFFu
#define CODE_SIGN      0x20000u
#include "build_refit_wide.glsl"

uint read_slots(uint at)
{
    uint there = 0u, zero = node_word[at], one = node_word[at + 1u];
    uint node = zero & 0x3FFFFFu, item = ((zero >> 22) & 0x7Fu) | (((one >> 9) & 0x7FFFu) << 7);
    uint types = zero >> 29 | one << 3;
    for (uint s = 0u; s < 4u; s++) {
        uint type = (types >> (3u * s)) & 7u;
        bool inner = type == 4u;
        slot_count[s] = inner ? 0u : (0x403021u >> (4u * type)) & 15u;
        slot_first[s] = inner ? node++ : item;
        item += slot_count[s];
        there |= inner || slot_count[s] != 0u ? 1u << s : 0u;
    }
    return there;
}

/* The units of a bound, cut off toward 0, and its sign. An upper bound of 0 is negative. */
uint code_of(uint bits, uint most, bool up)
{
    uint exponent = (bits >> 23) & 0xFFu, by = most - exponent + 7u;
    bool zero = (bits & 0x7FFFFFFFu) == 0u;
    uint code = exponent > 0u && by < 24u ? bits_units(bits) >> by : 0u;
    return code | ((zero ? up : (bits >> 31) != 0u) ? CODE_SIGN : 0u);
}

/* A slot that is not there has a box inside out. */
void write_boxes(uint at, uint there)
{
    uint exponents[3], word[14];
    for (uint k = 0u; k < 3u; k++)
        exponents[k] = max(max((low[k] >> 23) & 0xFFu, (high[k] >> 23) & 0xFFu), COMMON_LEAST);
    node_word[at + 1u] = (node_word[at + 1u] & 0x00FFFFFFu) | exponents[0] << 24;
    for (uint w = 0u; w < 14u; w++)
        word[w] = 0u;
    word[0] = exponents[1] | exponents[2] << 8;
    for (uint i = 0u; i < 24u; i++) {
        uint s = i / 6u, k = i % 3u, bit = 16u + CODE_BITS * i;
        bool up = i % 6u >= 3u, is = ((there >> s) & 1u) != 0u;
        uint missing = up ? CODE_SIGN | CODE_UNITS : CODE_UNITS;
        uint code = is ? code_of(slot_box[i], exponents[k], up) : missing;
        word[bit / 32u] |= code << (bit % 32u);
        if (bit % 32u + CODE_BITS > 32u)
            word[bit / 32u + 1u] |= code >> (32u - bit % 32u);
    }
    for (uint w = 0u; w < 14u; w++)
        node_word[at + 2u + w] = word[w];
}

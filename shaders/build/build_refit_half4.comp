#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of layout half4, as packed_refit does. */
#define RECORD_WORDS   16u
#define MAGNITUDE_MOST 0x477FE000u /* 65504 */
#define HALF_MOST      0x7BFFu     /* its code */
#include "build_refit_wide.glsl"
#include "build_number.glsl"

uint read_slots(uint at)
{
    uint there = 0u;
    for (uint s = 0u; s < 4u; s++) {
        uint child = node_word[at + 12u + s];
        there |= child != 0u ? 1u << s : 0u;
        slot_first[s] = child & 0x0FFFFFFFu;
        slot_count[s] = child >> 28;
    }
    return there;
}

/* A slot that is not there has an empty box. */
void write_boxes(uint at, uint there)
{
    number_format format = format_of(ABI_NUMBER_F16);
    for (uint plane = 0u; plane < 6u; plane++) {
        bool up = plane >= 3u;
        uint empty = up ? HALF_MOST | 0x8000u : HALF_MOST;
        uint word[2] = uint[2](0u, 0u);
        for (uint s = 0u; s < 4u; s++) {
            uint code = empty, bound = slot_box[6u * s + plane];
            if (((there >> s) & 1u) != 0u && !world_code(format, bound, up, code))
                atomicAdd(state[ABI_REFIT_BEYOND], 1u);
            word[s / 2u] |= code << (s % 2u * 16u);
        }
        node_word[at + 2u * plane] = word[0];
        node_word[at + 2u * plane + 1u] = word[1];
    }
}

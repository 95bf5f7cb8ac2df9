#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of the grid family, as packed_refit does. */
#define RECORD_WORDS   record_words()
#define MAGNITUDE_MOST 0x7FFFFFFFu /* codes tell what is beyond */
uint record_words();
#include "build_refit_wide.glsl"
#include "build_number.glsl"

uint code_word[48];

uint code_words()
{
    uint bits = format_of(job.number).bits;
    return bits == 10u ? 2u * job.width : (6u * job.width * bits + 31u) / 32u;
}

/* Words before the codes. */
uint head_words()
{
    return 2u + (job.width + 3u) / 4u + (job.frame == ABI_FRAME_NODE ? 4u : 0u);
}

uint record_words()
{
    return head_words() + code_words();
}

uint read_slots(uint at)
{
    uint there = 0u;
    for (uint s = 0u; s < job.width; s++) {
        uint byte = (node_word[at + 2u + s / 4u] >> (s % 4u * 8u)) & 0xFFu;
        bool leaf = byte < 0x80u;
        there |= byte != 0xFFu ? 1u << s : 0u;
        slot_first[s] = leaf ? node_word[at + 1u] + (byte & 31u) : node_word[at] + byte - 0x80u;
        slot_count[s] = leaf ? (byte >> 5) + 1u : 0u;
    }
    return there;
}

void put_code(uint bits, uint index, uint code)
{
    uint word = bits == 10u ? index / 3u : index * bits / 32u;
    uint bit = bits == 10u ? index % 3u * 10u : index * bits % 32u;
    code_word[word] |= code << bit;
    if (bit + bits > 32u)
        code_word[word + 1u] |= code >> (32u - bit);
}

/* The frame of the node, which is written, or that of the scene. */
bool axis_of(number_format format, uint at, uint k, out number_axis axis)
{
    if (job.frame == ABI_FRAME_SCENE) {
        axis = number_axis(node_word[k], int((node_word[3] >> (8u * k)) & 0xFFu) - 127);
        return true;
    }
    uint frame = at + head_words() - 4u;
    bool fits = number_axis_make(format, low[k], high[k], axis);
    node_word[frame + k] = axis.origin;
    if (k == 0u)
        node_word[frame + 3u] = 0u;
    node_word[frame + 3u] |= uint(axis.exponent + 127) << (8u * k);
    return fits;
}

void write_boxes(uint at, uint there)
{
    number_format format = format_of(job.number);
    for (uint w = 0u; w < code_words(); w++)
        code_word[w] = 0u;
    for (uint k = 0u; k < 3u; k++) {
        number_axis axis;
        bool world = job.frame == ABI_FRAME_WORLD;
        bool fits = world || axis_of(format, at, k, axis);
        for (uint s = 0u; s < job.width && fits; s++)
            for (uint up = 0u; up < 2u && ((there >> s) & 1u) != 0u; up++) {
                uint bound = slot_box[6u * s + 3u * up + k], code;
                fits = fits && (world ? world_code(format, bound, up != 0u, code)
                                      : framed_code(format, axis.origin, axis.exponent, bound,
                                                    up != 0u, code));
                put_code(format.bits, 6u * s + 2u * k + up, code);
            }
        if (!fits)
            atomicAdd(state[ABI_REFIT_BEYOND], 1u);
    }
    for (uint w = 0u; w < code_words(); w++)
        node_word[at + head_words() + w] = code_word[w];
}

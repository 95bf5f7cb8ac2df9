#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of the layouts gfx12, as packed_refit does. */
#define RECORD_WORDS   32u
#define MAGNITUDE_MOST 0x71800000u /* 2^100 */
#define CODES          4096u
#define CODE_BITS      12
#include "build_refit_wide.glsl"
#include "build_number.glsl"

uint read_slots(uint at)
{
    uint there = 0u, node = node_word[at], item = node_word[at + 1u];
    uint count = (node_word[at + 6u] >> 28) + 1u;
    for (uint s = 0u; s < 8u; s++) {
        uint last = node_word[at + 10u + 3u * s], size = last >> 28;
        bool inner = ((last >> 24) & 15u) == 5u;
        there |= s < count && size > 0u ? 1u << s : 0u;
        slot_first[s] = inner ? node : item;
        slot_count[s] = inner ? 0u : size;
        node += inner ? size : 0u;
        item += inner ? 0u : size;
    }
    return there;
}

void put_code(uint at, uint s, uint i, uint code)
{
    uint word = at + 8u + 3u * s + i / 2u, bit = i % 2u * 12u;
    node_word[word] = (node_word[word] & ~(0xFFFu << bit)) | code << bit;
}

void put_frame(uint at, uint k, uint origin, uint exponent)
{
    node_word[at + 3u + k] = origin;
    node_word[at + 6u] =
        (node_word[at + 6u] & ~(0xFFu << (8u * k))) | exponent << (8u * k);
}

/* A difference of two numbers that is not negative, rounded to float32. */
exact difference(uint more, uint less)
{
    return rounded(magnitude_of(sum_of(more, less ^ SIGN)));
}

/* The exponent of the least power of two that is at least a float32, which is not negative. */
uint exponent_above(exact x)
{
    int top = top_bit(x), biased = top + x.unit + 127;
    if (top < 0)
        return 0u;
    if (biased < 1)
        return 1u; /* of any subnormal number */
    bool power = shifted(x, uint(top)).between == false;
    return uint(power ? biased : biased + 1);
}

/* The code of a difference as published: of an extent of 0, and of a quotient that is rounded to 0,
 * the upper code of 0 is one less, which is the last. */
uint mesa_code(exact x, uint exponent, bool up)
{
    int top = top_bit(x), below = top + x.unit - (int(exponent) - 127);
    bool power = top >= 0 && !shifted(x, uint(top)).between;
    if (top < 0 || exponent == 0u || below < -150 || (below == -150 && power))
        return up ? CODES - 1u : 0u;
    int whole = whole_of(x, int(exponent) - 127 - CODE_BITS, up);
    return min(uint(up ? whole - 1 : whole), CODES - 1u);
}

void write_mesa(uint at, uint there, uint k)
{
    uint exponent = exponent_above(difference(high[k], low[k])), size = low[k] & ~SIGN;
    put_frame(at, k, low[k], exponent);
    if ((size > 0u && size < NORMAL) || (exponent > 0u && exponent <= uint(CODE_BITS)))
        atomicAdd(state[ABI_REFIT_BEYOND], 1u);
    for (uint s = 0u; s < 8u; s++)
        for (uint up = 0u; up < 2u && ((there >> s) & 1u) != 0u; up++)
            put_code(at, s, 3u * up + k,
                     mesa_code(difference(slot_box[6u * s + 3u * up + k], low[k]), exponent,
                               up != 0u));
}

void write_own(uint at, uint there, uint k)
{
    node_axis axis = node_axis_of(there, slot_box, k, CODES);
    put_frame(at, k, node_axis_origin(axis), uint(axis.exponent + CODE_BITS + 127));
    for (uint s = 0u; s < 8u; s++) {
        if (((there >> s) & 1u) == 0u)
            continue;
        uint lo = node_axis_down(axis, slot_box[6u * s + k]);
        uint hi = node_axis_up(axis, slot_box[6u * s + 3u + k]);
        put_code(at, s, k, min(lo, CODES - 1u));
        put_code(at, s, 3u + k, max(hi, 1u) - 1u);
    }
}

void write_boxes(uint at, uint there)
{
    for (uint k = 0u; k < 3u; k++)
        if (job.kind == ABI_REFIT_NEAREST)
            write_mesa(at, there, k);
        else
            write_own(at, there, k);
}

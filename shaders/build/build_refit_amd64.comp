#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new boxes into the records of the layouts amd64, as packed_refit does. A node keeps its
 * format; node r is record r in float16, node job.width + r is record r in float32. */
#define RECORD_AT(ref) record_at(ref)
#define MAGNITUDE_MOST 0x7F7FFFFFu
uint record_at(uint ref);
#include "build_refit_wide.glsl"

bool is_f32; /* the node at hand */

uint record_at(uint ref)
{
    is_f32 = ref >= job.width;
    return 16u * (is_f32 ? ref - job.width : ref);
}

uint read_slots(uint at)
{
    uint there = 0u;
    for (uint s = 0u; s < 4u; s++) {
        uint pointer = node_word[at + s], type = pointer & 7u;
        there |= type <= 5u ? 1u << s : 0u;
        slot_first[s] = (pointer >> 3) + (type == 5u ? job.width : 0u);
        slot_count[s] = type < 4u ? type + 1u : 0u;
    }
    return there;
}

/* The half of a number: outward or to the nearest, of two the even one; infinite beyond. */
uint half_of(uint bits, bool up)
{
    uint size = bits & 0x7FFFFFFFu, exponent = max(size >> 23, 1u);
    bool negative = (bits >> 31) != 0u, nearest = job.kind == ABI_REFIT_NEAREST;
    uint by = min(13u + uint(max(113 - int(exponent), 0)), 25u); /* 113: subnormal halves below */
    uint units = bits_units(bits), rest = units & ((1u << by) - 1u), tie = 1u << (by - 1u);
    uint code = (units >> by) + (max(exponent, 113u) - 113u << 10);
    bool more = nearest ? rest > tie || (rest == tie && (code & 1u) != 0u)
                        : rest != 0u && negative != up;
    if (size >= 0x47800000u) /* 2^16 */
        code = nearest || negative != up ? 0x7C00u : 0x7BFFu;
    else if (more)
        code++;
    return negative ? code | 0x8000u : code;
}

/* Moves a number with that bit as its sign outward by job.number ulp; there is no -0. */
uint grown(uint bits, uint sign, bool up)
{
    int size = int(bits & (sign - 1u));
    int place = ((bits & sign) != 0u ? -size : size) + (up ? int(job.number) : -int(job.number));
    return place < 0 ? uint(-place) | sign : uint(place);
}

void write_boxes(uint at, uint there)
{
    for (uint w = 4u; w < 16u; w++)
        node_word[at + w] = 0u;
    for (uint i = 0u; i < 24u; i++) {
        uint s = i / 6u, infinite = is_f32 ? 0x7F800000u : 0x7C00u;
        bool up = i % 6u >= 3u;
        if (((there >> s) & 1u) == 0u)
            continue;
        uint code = is_f32 ? grown(slot_box[i], 0x80000000u, up)
                           : grown(half_of(slot_box[i], up), 0x8000u, up);
        if ((code & infinite) == infinite)
            atomicAdd(state[ABI_REFIT_BEYOND], 1u);
        if (is_f32)
            node_word[at + 4u + i] = code;
        else
            node_word[at + 4u + i / 2u] |= code << (i % 2u * 16u);
    }
}

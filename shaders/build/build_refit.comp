#version 450
#extension GL_GOOGLE_include_directive : require
/* Writes new bounds into the nodes of a binary layout, as packed_refit does, for vertices that have
 * moved: an invocation begins at a leaf. */
#include "build_refit.glsl"

#define HALF_NORMAL 0x38800000u /* 2^-14, the least magnitude that is not 0 */
#define HALF_MOST   0x477FE000u /* 65504 */

/* The half of a bound, without the sign: toward 0, or away from it. */
uint half_of(uint magnitude, bool away)
{
    if (magnitude < HALF_NORMAL)
        return away && magnitude != 0u ? 0x400u : 0u;
    return (magnitude - 0x38000000u + (away ? 0x1FFFu : 0u)) >> 13;
}

uint half_bound(uint bits, bool up)
{
    bool negative = (bits >> 31) != 0u;
    uint code = half_of(bits & 0x7FFFFFFFu, negative != up);
    return code != 0u && negative ? code | 0x8000u : code;
}

void write_node(uint ref)
{
    for (uint k = 0u; k < 3u; k++) {
        box_word[6u * ref + k] = low[k];
        box_word[6u * ref + 3u + k] = high[k];
        if (job.kind == ABI_REFIT_F32) {
            node_word[8u * ref + k] = low[k];
            node_word[8u * ref + 4u + k] = high[k];
            continue;
        }
        if (max(low[k] & 0x7FFFFFFFu, high[k] & 0x7FFFFFFFu) > HALF_MOST)
            atomicAdd(state[ABI_REFIT_BEYOND], 1u);
        node_word[4u * ref + k] = half_bound(low[k], false) | half_bound(high[k], true) << 16;
    }
}

void do_first(uint ref)
{
    begin();
    if (job.kind == ABI_REFIT_F32) {
        uint first = node_word[8u * ref + 3u], count = node_word[8u * ref + 7u];
        for (uint i = 0u; i < count; i++)
            grow_triangle(item_word[first + i]);
    } else {
        uint count = node_word[4u * ref + 3u] & 15u;
        for (uint i = 0u; i < count; i++)
            grow_triangle((node_word[4u * ref + 4u + i / 2u] >> (16u * (i & 1u))) & 0xFFFFu);
    }
    write_node(ref);
}

void do_inner(uint ref)
{
    uint tag = node_word[4u * ref + 3u];
    bool wide = job.kind == ABI_REFIT_F32;
    begin();
    grow_node(wide ? ref + 1u : (tag >> 16) & 0x7FFFu);
    grow_node(wide ? node_word[8u * ref + 3u] : tag & 0xFFFFu);
    write_node(ref);
}

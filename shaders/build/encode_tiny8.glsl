/* Writes the boxes of all child slots into a record of layout tiny8 and its family, and the
 * frame. */
#ifndef ENCODE_TINY8_GLSL
#define ENCODE_TINY8_GLSL

#include "build_axis.glsl"

/* `there` and `box` as in build_axis.glsl. Words 4 to 6 and the word of each slot that is not there
 * stay. */
void encode_tiny8(uint there, uint box[BOX_WORDS], inout uint word[16])
{
    word[3] = 0u;
    word[15] = 0u;
    for (uint s = 0u; s < 8u; s++)
        word[7u + s] = ((there >> s) & 1u) != 0u ? 0u : word[7u + s];
    for (uint k = 0u; k < 3u; k++) {
        node_axis axis = node_axis_of(there, box, k, 63u);
        word[k] = node_axis_origin(axis);
        word[3] |= uint(axis.exponent + 127) << (8u * k);
        for (uint s = 0u; s < 8u; s++) {
            if (((there >> s) & 1u) == 0u)
                continue;
            uint lo = node_axis_down(axis, box[6u * s + k]);
            uint hi = node_axis_up(axis, box[6u * s + 3u + k]);
            word[7u + s] |= lo << (6u * k) | hi << (18u + 6u * k);
            if (k == 2u)
                word[15] |= (hi >> 2) << (4u * s);
        }
    }
}

#endif

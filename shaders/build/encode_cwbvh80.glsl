/* Writes the boxes of all child slots into a record of layout cwbvh80, and the frame. */
#ifndef ENCODE_CWBVH80_GLSL
#define ENCODE_CWBVH80_GLSL

#include "build_axis.glsl"

/* `there` and `box` as in build_axis.glsl. Other words than those of the frame and of the planes of
 * slots that are there stay. */
void encode_cwbvh80(uint there, uint box[BOX_WORDS], inout uint word[20])
{
    for (uint k = 0u; k < 3u; k++) {
        node_axis axis = node_axis_of(there, box, k, 255u);
        word[k] = node_axis_origin(axis);
        word[3] = (word[3] & ~(0xFFu << (8u * k))) | uint(axis.exponent + 127) << (8u * k);
        for (uint s = 0u; s < 8u; s++) {
            if (((there >> s) & 1u) == 0u)
                continue;
            uint at = 2u * k + s / 4u, by = s % 4u * 8u, keep = ~(0xFFu << by);
            uint lo = node_axis_down(axis, box[6u * s + k]);
            uint hi = node_axis_up(axis, box[6u * s + 3u + k]);
            word[8u + at] = (word[8u + at] & keep) | lo << by;
            word[14u + at] = (word[14u + at] & keep) | hi << by;
        }
    }
}

#endif

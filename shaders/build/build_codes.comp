#version 450
#extension GL_GOOGLE_include_directive : require
/* The Morton code of the centre of each triangle's box, with x in the highest bit of three. */
#include "build_frame.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= job.count)
        return;
    uint exponent = frame_exponent(), longest = 0u;
    int base[3];
    for (uint k = 0u; k < 3u; k++) {
        int lo = frame_coordinate(exponent, from_order(state[ABI_STATE_LO + k]));
        int hi = frame_coordinate(exponent, from_order(state[ABI_STATE_HI + k]));
        base[k] = 2 * lo;
        longest = max(longest, uint(hi - lo) << 1);
    }
    uvec3 lo, hi;
    triangle_bounds(i, lo, hi);
    uint code[2] = uint[](0u, 0u);
    int have = longest != 0u ? findMSB(longest) + 1 : int(job.axis_bits);
    int shift = have - int(job.axis_bits);
    for (uint k = 0u; k < 3u; k++) {
        int twice = frame_coordinate(exponent, from_order(lo[k])) +
                    frame_coordinate(exponent, from_order(hi[k]));
        uint at = uint(twice - base[k]);
        uint cell = shift >= 0 ? at >> uint(shift) : at << uint(-shift);
        for (uint b = 0u; b < job.axis_bits; b++) {
            uint place = 3u * b + 2u - k;
            code[place >> 5] |= ((cell >> b) & 1u) << (place & 31u);
        }
    }
    keys[i] = uvec4(code[1], code[0], i, 0u);
}

/* The frame of a scene, whose bounds are known: coordinates as integers of 29 bits and a sign. */
#ifndef BUILD_FRAME_GLSL
#define BUILD_FRAME_GLSL

#include "build_job.glsl"

uint frame_exponent()
{
    uint exponent = 1u;
    for (uint k = ABI_STATE_LO; k < ABI_STATE_LO + 6u; k++)
        exponent = max(exponent, (from_order(state[k]) >> 23) & 0xFFu);
    return exponent;
}

int frame_coordinate(uint exponent, uint bits)
{
    uint own = (bits >> 23) & 0xFFu, significand = bits & 0x7FFFFFu;
    significand = own != 0u ? significand | 0x800000u : significand;
    uint shift = exponent - max(own, 1u);
    uint size = shift < 32u ? (significand << 5) >> shift : 0u;
    return (bits >> 31) != 0u ? -int(size) : int(size);
}

#endif

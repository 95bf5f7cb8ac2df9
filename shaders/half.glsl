/* Converts float16 bounds of a box to float32. */
#ifndef HALF_GLSL
#define HALF_GLSL

#include "slab.glsl"

/* Converts the half in bits 0-15, for every code. Subnormals use integer arithmetic, since Vulkan
 * lets a driver flush them in unpackHalf2x16 (their float32 value is normal). Infinities and NaN
 * are converted bit by bit. */
float half_any(uint code)
{
    uint magnitude = code & 0x7FFFu;
    uint bits = (magnitude << 13) + 0x38000000u;
    if (magnitude >= 0x7C00u)
        bits = (magnitude << 13) | 0x7F800000u;
    precise float tiny = float(magnitude) * 5.9604644775390625e-8; /* times 2^-24: exact */
    if (magnitude < 0x400u)
        bits = floatBitsToUint(tiny);
    return uintBitsToFloat(bits | (code & 0x8000u) << 16);
}

/* Converts the half in bits 0-15 if it is zero or normal. For these Vulkan's conversion is
 * exact. */
float half_normal(uint code)
{
    return unpackHalf2x16(code).x;
}

/* The bit offset of the nearer plane's half in each word. */
uvec3 half_shift(slab_ray r)
{
    return uvec3(r.swapped) << 4;
}

/* Converts bounds whose words hold the lower bound in the low half. The planes are returned in the
 * order in which the ray meets them. `_any` is for layouts that can store every code, the other for
 * layouts that store neither subnormals nor infinities. */
void half_bounds(slab_ray r, uvec3 bounds, out vec3 nearer, out vec3 farther)
{
    uvec3 shift = half_shift(r);
    uvec3 n = bounds >> shift;
    uvec3 f = bounds >> (16u - shift);
    nearer = vec3(half_normal(n.x), half_normal(n.y), half_normal(n.z));
    farther = vec3(half_normal(f.x), half_normal(f.y), half_normal(f.z));
}

void half_bounds_any(slab_ray r, uvec3 bounds, out vec3 nearer, out vec3 farther)
{
    uvec3 shift = half_shift(r);
    uvec3 n = (bounds >> shift) & 0xFFFFu;
    uvec3 f = (bounds >> (16u - shift)) & 0xFFFFu;
    nearer = vec3(half_any(n.x), half_any(n.y), half_any(n.z));
    farther = vec3(half_any(f.x), half_any(f.y), half_any(f.z));
}

#endif

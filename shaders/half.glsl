/* Float16 bounds of a box to float32. */
#ifndef HALF_GLSL
#define HALF_GLSL

#include "slab.glsl"

/* The half in bits 0-15, every code: subnormals by integer arithmetic, since Vulkan lets a driver
 * flush them in unpackHalf2x16 (their float32 value is normal); infinities and NaN bit by bit. */
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

/* The half in bits 0-15 if it is zero or normal, for which Vulkan's conversion is exact. */
float half_normal(uint code)
{
    return unpackHalf2x16(code).x;
}

/* How far the half of the plane that is met first lies up in its word. */
uvec3 half_shift(slab_ray r)
{
    return uvec3(r.swapped) << 4;
}

/* Each word of `bounds` holds the lower bound in its low half; the planes in the order in which the
 * ray meets them. `_any` for layouts that can store every code, the other for those that store
 * neither subnormals nor infinities. */
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

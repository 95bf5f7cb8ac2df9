/* The square root, rounded to nearest on every driver. Vulkan guarantees only some ulp. */
#ifndef SQRT_GLSL
#define SQRT_GLSL

#include "pick.glsl"

/* x = n 4^k with n of 47 or 48 bits, so that the root's 24 bits are the m nearest to sqrt(n). It is
 * the m with -m < n - m^2 <= m, since (m + 1/2)^2 is no integer. The driver's root of n 2^-46 gives
 * a first m. The 32 low bits of n - m^2 suffice while m is within 63 ulp. */
uint sqrt_step(uint n, uint m)
{
    int rest = int(n - m * m);
    return pick(rest > int(m), m + 1u, pick(rest <= -int(m), m - 1u, m));
}

/* `worse` is added to the driver's estimate, to simulate its error in tests. */
float sqrt_from(float x, int worse)
{
    uint bits = floatBitsToUint(x);
    int high = findMSB(bits & 0x7FFFFFu), exponent = int(bits >> 23 & 255u);
    bool subnormal = exponent == 0;
    int shift = subnormal ? 23 - high : 0;
    exponent = subnormal ? 1 - shift : exponent;
    uint mantissa = (bits & 0x7FFFFFu) << (shift & 31) | 0x800000u;
    uint odd = uint(exponent & 1);
    uint n = mantissa << (24u - odd); /* 32 low bits of n */
    float scaled = uintBitsToFloat((128u - odd) << 23 | (mantissa & 0x7FFFFFu));
    precise float estimate = sqrt(scaled) * 8388608.0;
    uint m = uint(int(estimate) + worse);
    precise float off = float(int(n - m * m)) / float(2u * m);
    m += uint(int(off)); /* now within one */
    m = sqrt_step(n, sqrt_step(n, m));
    uint half_exponent = uint(exponent + 126 + int(odd)) >> 1; /* (e - 150 - 24 + odd) / 2 + 150 */
    uint root = half_exponent << 23 | (m & 0x7FFFFFu);
    /* 0, infinity and NaN are their own roots. Other values with a sign have none. */
    root = pick(both(bits > 0u, bits < 0x7F800000u), root, bits);
    return uintBitsToFloat(pick(bits > 0x80000000u, 0x7FC00000u, root));
}

float sqrt_nearest(float x)
{
    return sqrt_from(x, 0);
}

#endif

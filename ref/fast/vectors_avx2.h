/* Functions that the AVX2 and AVX-512 kernels share. Expects INLINE. */
#ifndef FAST_VECTORS_AVX2_H
#define FAST_VECTORS_AVX2_H

#include <immintrin.h>

INLINE float4 max4(float4 a, float4 b)
{
    return (float4)_mm_max_ps((__m128)a, (__m128)b);
}

INLINE float8 max8(float8 a, float8 b)
{
    return (float8)_mm256_max_ps((__m256)a, (__m256)b);
}

INLINE float8 min8(float8 a, float8 b)
{
    return (float8)_mm256_min_ps((__m256)a, (__m256)b);
}

INLINE float8 fma8(float8 a, float8 b, float8 c)
{
    return (float8)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}

INLINE float8 planes(const uint16_t *code)
{
    __m128i v = _mm_load_si128((const __m128i *)(const void *)code);
    return (float8)_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(v));
}

INLINE float8 bytes(const uint8_t *from)
{
    return (float8)_mm256_cvtepi32_ps(
        _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from)));
}

INLINE uint32_t bits4(float4 v)
{
    return (uint32_t)_mm_movemask_ps((__m128)v);
}

INLINE float4 permute4(float4 v, int4 order)
{
    return (float4)_mm_permutevar_ps((__m128)v, (__m128i)order);
}

#endif

/* Functions that the AVX2 and AVX-512 kernels share, and those of the AVX2 kernels, which define
 * FAST_AVX2. Expects INLINE and ref/fast/kernel/vectors.h. */
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

#ifdef FAST_AVX2 /* rows of 16 vertices in two registers: most leaves do not need the second one */

INLINE uint32_t less(float8 a, float8 b)
{
    return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ));
}

INLINE uint32_t not_above(float8 a, float8 b)
{
    return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LE_OQ));
}

INLINE uint32_t unequal(float8 a, float8 b)
{
    return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_NEQ_OQ));
}

INLINE float8 lane8(float4 v, int k)
{
    return (float8)_mm256_permutevar8x32_ps(_mm256_castps128_ps256((__m128)v),
                                            _mm256_set1_epi32(k));
}

INLINE float16 lane16(float4 v, int k)
{
    float8 half = lane8(v, k);
    float16 both;
    memcpy(&both, &half, sizeof half);
    memcpy((char *)&both + sizeof half, &half, sizeof half);
    return both;
}

/* Lanes beyond the row hold what follows it; no corner refers to them. */
INLINE float16 vertices(const uint32_t *row, uint32_t count)
{
    (void)count;
    float16 out;
    memcpy(&out, row, sizeof out);
    return out;
}

typedef __m256i codes8;

INLINE codes8 codes(uint32_t word)
{
    return _mm256_srlv_epi32(_mm256_set1_epi32((int)word),
                             _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
}

/* The permutation of 8 lanes reads the lowest 3 bits of a code; the fourth bit selects the half. */
INLINE float8 corners(float16 row, codes8 code, uint32_t count)
{
    __m256 half[2];
    memcpy(half, &row, sizeof half);
    __m256 low = _mm256_permutevar8x32_ps(half[0], code);
    if (count <= 8)
        return (float8)low;
    __m256 high = _mm256_permutevar8x32_ps(half[1], code);
    return (float8)_mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(code, 28)));
}

#endif

#endif

/* Functions of the AVX-512 kernels: rows of 16 vertices in one register, and children sorted in
 * one. Expects INLINE, ref/fast/kernel/vectors.h and ref/fast/kernel/vectors_avx2.h. */
#ifndef FAST_VECTORS_AVX512_H
#define FAST_VECTORS_AVX512_H

INLINE uint32_t less(float8 a, float8 b)
{
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, _CMP_LT_OQ);
}

INLINE uint32_t not_above(float8 a, float8 b)
{
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, _CMP_LE_OQ);
}

INLINE uint32_t unequal(float8 a, float8 b)
{
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, _CMP_NEQ_OQ);
}

INLINE float8 lane8(float4 v, int k)
{
    return (float8)_mm256_permutexvar_ps(_mm256_set1_epi32(k), _mm256_castps128_ps256((__m128)v));
}

INLINE float16 lane16(float4 v, int k)
{
    return (float16)_mm512_permutexvar_ps(_mm512_set1_epi32(k), _mm512_castps128_ps512((__m128)v));
}

INLINE float16 vertices(const uint32_t *row, uint32_t count)
{
    return (float16)_mm512_maskz_loadu_ps((__mmask16)_bzhi_u32(0xFFFF, count), row);
}

typedef __m256i codes8;

/* The higher bits of a lane belong to the next codes. The permutation of 16 lanes reads the lowest
 * 4. */
INLINE codes8 codes(uint32_t word)
{
    return _mm256_srlv_epi32(_mm256_set1_epi32((int)word),
                             _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
}

INLINE float8 corners(float16 row, codes8 code, uint32_t count)
{
    (void)count;
    __m512 all = _mm512_permutexvar_ps(_mm512_castsi256_si512(code), (__m512)row);
    return (float8)_mm512_castps512_ps256(all);
}

#define ORDER(k, p, smaller) _mm_blend_epi32(_mm_max_epu32(k, p), _mm_min_epu32(k, p), smaller)
#define ORDER8(k, p, smaller)                                                                      \
    _mm256_blend_epi32(_mm256_max_epu32(k, p), _mm256_min_epu32(k, p), smaller)

/* Sorts in descending order. In each step the lanes in `smaller` take the smaller value of a
 * pair. */
INLINE __m128i sort4(__m128i k)
{
    k = ORDER(k, _mm_shuffle_epi32(k, 0xB1), 0xA);
    k = ORDER(k, _mm_shuffle_epi32(k, 0x4E), 0xC);
    return ORDER(k, _mm_shuffle_epi32(k, 0xD8), 0x4);
}

INLINE __m256i sort8(__m256i k)
{
    k = ORDER8(k, _mm256_shuffle_epi32(k, 0xB1), 0xAA);
    k = ORDER8(k, _mm256_shuffle_epi32(k, 0x4E), 0xCC);
    k = ORDER8(k, _mm256_shuffle_epi32(k, 0xD8), 0x44);
    k = ORDER8(k, _mm256_permutexvar_epi32(_mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0), k), 0xF0);
    k = ORDER8(k, _mm256_shuffle_epi32(k, 0x4E), 0xCC);
    return ORDER8(k, _mm256_shuffle_epi32(k, 0xB1), 0xAA);
}

/* As in ref/fast/kernel/push.h; absent lanes are 0 and come last. */
INLINE uint32_t push(uint32_t *key, uint32_t *ref, const uint32_t *child, uint32_t mask,
                     float8 entry)
{
    uint32_t count = (uint32_t)__builtin_popcount(mask);
    __m256i k = _mm256_andnot_si256(_mm256_set1_epi32(7), (__m256i)entry);
    k = _mm256_or_si256(k, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    k = _mm256_maskz_compress_epi32((__mmask8)mask, k);
    k = count <= 4 ? _mm256_zextsi128_si256(sort4(_mm256_castsi256_si128(k))) : sort8(k);
    __m256i refs = _mm256_loadu_si256((const __m256i *)(const void *)child);
    _mm256_storeu_si256((__m256i *)(void *)key, k);
    _mm256_storeu_si256((__m256i *)(void *)ref, _mm256_permutexvar_epi32(k, refs));
    return count;
}

/* Writes the last one, too, where it is not counted: that takes fewer steps. */
INLINE uint32_t push_any(uint32_t *ref, const uint32_t *child, uint32_t mask)
{
    __m256i refs = _mm256_loadu_si256((const __m256i *)(const void *)child);
    _mm256_storeu_si256((__m256i *)(void *)ref, _mm256_maskz_compress_epi32((__mmask8)mask, refs));
    return (uint32_t)__builtin_popcount(mask) - 1;
}

/* --- rays in a stream ------------------------------------------------------------------------- */

/* Writes all children in `mask`, in order. Returns their number. */
INLINE uint32_t push_all(uint32_t *ref, const uint32_t *child, uint32_t mask)
{
    __m256i refs = _mm256_loadu_si256((const __m256i *)(const void *)child);
    _mm256_storeu_si256((__m256i *)(void *)ref, _mm256_maskz_compress_epi32((__mmask8)mask, refs));
    return (uint32_t)__builtin_popcount(mask);
}

/* The first lane with the least number of the lanes `in`, and that number; of no lanes, any lane
 * and infinity. */
INLINE uint32_t nearest8(float8 t, uint32_t in, float *least)
{
    const __m256 far = _mm256_set1_ps(__builtin_inff());
    const __m256 all = _mm256_mask_blend_ps((__mmask8)in, far, (__m256)t);
    __m256 m = _mm256_min_ps(all, _mm256_permute2f128_ps(all, all, 1));
    m = _mm256_min_ps(m, _mm256_permute_ps(m, 0x4E));
    m = _mm256_min_ps(m, _mm256_permute_ps(m, 0xB1));
    const uint32_t lane = _tzcnt_u32(_mm256_cmp_ps_mask(all, m, _CMP_EQ_OQ)) & 7;
    /* Of zeros of both signs, that lane's. */
    *least = _mm256_cvtss_f32(_mm256_permutexvar_ps(_mm256_set1_epi32((int)lane), all));
    return lane;
}

/* --- 16 rays ---------------------------------------------------------------------------------- */

#define FAST_LANES

INLINE float16 fma16(float16 a, float16 b, float16 c)
{
    return (float16)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}

INLINE float16 max16(float16 a, float16 b)
{
    return (float16)_mm512_max_ps((__m512)a, (__m512)b);
}

INLINE float16 min16(float16 a, float16 b)
{
    return (float16)_mm512_min_ps((__m512)a, (__m512)b);
}

INLINE uint32_t less16(float16 a, float16 b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

INLINE uint32_t not_above16(float16 a, float16 b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
}

INLINE uint32_t unequal16(float16 a, float16 b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_NEQ_OQ);
}

INLINE float16 blend16(uint32_t mask, float16 a, float16 b)
{
    return (float16)_mm512_mask_blend_ps((__mmask16)mask, (__m512)a, (__m512)b);
}

INLINE int16v blend16i(uint32_t mask, int16v a, int16v b)
{
    return (int16v)_mm512_mask_blend_epi32((__mmask16)mask, (__m512i)a, (__m512i)b);
}

INLINE float least_of16(float16 v)
{
    return _mm512_reduce_min_ps((__m512)v);
}

INLINE uint32_t signs16(float16 v)
{
    return _mm512_movepi32_mask((__m512i)v);
}

/* Four words of rays 0, 4, 8 and 12 from `from` on. */
INLINE __m512 four_rays(const float *from)
{
    __m512 v = _mm512_castps128_ps512(_mm_loadu_ps(from));
    v = _mm512_mask_broadcast_f32x4(v, 0x00F0, _mm_loadu_ps(from + 32));
    v = _mm512_mask_broadcast_f32x4(v, 0x0F00, _mm_loadu_ps(from + 64));
    return _mm512_mask_broadcast_f32x4(v, 0xF000, _mm_loadu_ps(from + 96));
}

/* Exchanges rows and columns of the four 4 x 4 squares that 4 vectors hold. */
INLINE void turn4(const __m512 r[4], float16 out[4])
{
    __m512 low[2], high[2];
    for (int i = 0; i < 2; i++) {
        low[i] = _mm512_unpacklo_ps(r[2 * i], r[2 * i + 1]);
        high[i] = _mm512_unpackhi_ps(r[2 * i], r[2 * i + 1]);
    }
    out[0] = (float16)_mm512_shuffle_ps(low[0], low[1], 0x44);
    out[1] = (float16)_mm512_shuffle_ps(low[0], low[1], 0xEE);
    out[2] = (float16)_mm512_shuffle_ps(high[0], high[1], 0x44);
    out[3] = (float16)_mm512_shuffle_ps(high[0], high[1], 0xEE);
}

/* Words 0 to 3 of 16 rays from `from` on, a vector each. A gather is slower. */
INLINE void words16(const float *from, float16 out[4])
{
    __m512 r[4];
    for (int i = 0; i < 4; i++)
        r[i] = four_rays(from + 8 * i);
    turn4(r, out);
}

/* The reverse: four words of lane 4 i + j from word 4 (4 j + i) of `out` on. */
INLINE void lanes16(const float16 word[4], float out[64])
{
    const __m512 r[4] = {(__m512)word[0], (__m512)word[1], (__m512)word[2], (__m512)word[3]};
    float16 turned[4];
    turn4(r, turned);
    memcpy(out, turned, sizeof turned);
}

#endif

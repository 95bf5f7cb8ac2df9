/* The AVX2 traversal of tiny trees: rows of 32 vertices in four registers. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_TINY
#include "ref/fast/kernel/avx2.h"

/* Every lane has its 15 bits, and bits that are no code's. */
INLINE void triplets(const char *from, group_codes c[3])
{
    const __m256i some = _mm256_setr_epi8(0, 1, 2, -1, 1, 2, 3, -1, 3, 4, 5, -1, 5, 6, 7, -1, 7, 8,
                                          9, -1, 9, 10, 11, -1, 11, 12, 13, -1, 13, 14, 15, -1);
    const __m256i shift = _mm256_setr_epi32(0, 7, 6, 5, 4, 3, 2, 1);
    const __m128i all = _mm_loadu_si128((const __m128i *)(const void *)from);
    c[0] = _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(all), some);
    c[0] = _mm256_srlv_epi32(c[0], shift);
    c[1] = _mm256_srli_epi32(c[0], 5);
    c[2] = _mm256_srli_epi32(c[0], 10);
}

INLINE __m256 unpacked8(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
{
    const __m256i v = _mm256_add_epi32(row8(block, first, width), _mm256_set1_epi32((int)more));
    return _mm256_cvtepi32_ps(v);
}

INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
{
    __m256 half[2];
    float16 out;
    half[0] = unpacked8(block, first, width, more);
    half[1] = unpacked8(block, first + 8 * width, width, more);
    memcpy(&out, half, sizeof out);
    return out;
}

INLINE group corners32(const float16 half[2], group_codes code, uint32_t count)
{
    const group low = group_corners(half[0], code, count);
    if (count <= 16)
        return low;
    const group high = group_corners(half[1], code, count - 16);
    return (group)_mm256_blendv_ps((__m256)low, (__m256)high,
                                   _mm256_castsi256_ps(_mm256_slli_epi32(code, 27)));
}

#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_tiny_avx2 = {"avx2", runs, closest, any_hit, NULL};

#endif

/* The AVX2 traversal of tiny trees: rows of 32 vertices in four registers. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_TINY
#define FAST_AVX2
#define KERNEL_TARGET __attribute__((target("avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE        KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/kernel/walk_group.h"

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

/* Eight numbers of a row. They lie in nine words. */
INLINE __m256 unpacked8(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
{
    const __m256i number = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), low = _mm256_set1_epi32(31);
    const uint32_t *from = block + (first >> 5);
    __m256i at = _mm256_mullo_epi16(number, _mm256_set1_epi32((int)width));
    at = _mm256_add_epi32(at, _mm256_set1_epi32((int)(first & 31)));
    const __m256i word = _mm256_srli_epi32(at, 5), shift = _mm256_and_si256(at, low);
    const __m256i a = _mm256_loadu_si256((const __m256i *)(const void *)from);
    const __m256i b = _mm256_loadu_si256((const __m256i *)(const void *)(from + 1));
    __m256i v = _mm256_srlv_epi32(_mm256_permutevar8x32_epi32(a, word), shift);
    v = _mm256_or_si256(v, _mm256_sllv_epi32(_mm256_permutevar8x32_epi32(b, word),
                                             _mm256_sub_epi32(_mm256_set1_epi32(32), shift)));
    v = _mm256_and_si256(v, _mm256_set1_epi32((int)_bzhi_u32(~0u, width)));
    return _mm256_cvtepi32_ps(_mm256_add_epi32(v, _mm256_set1_epi32((int)more)));
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

static bool runs(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi2");
}

const struct fast_kernel fast_tiny_avx2 = {"avx2", runs, closest, any_hit, NULL};

#endif

/* What the AVX2 kernels are compiled with, which processors run them, and rows of bits. */
#ifndef FAST_AVX2_H
#define FAST_AVX2_H

#define FAST_AVX2
#define KERNEL_TARGET __attribute__((target("avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE        KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/kernel/walk_group.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi2");
}

/* Eight numbers of a row of so many bits each, from bit `first` on. They lie in nine words. */
INLINE __m256i row8(const uint32_t *block, uint32_t first, uint32_t width)
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
    return _mm256_and_si256(v, _mm256_set1_epi32((int)_bzhi_u32(~0u, width)));
}

#endif

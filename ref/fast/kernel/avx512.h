/* What the AVX-512 kernels are compiled with, which processors run them, and rows of bits. */
#ifndef FAST_AVX512_H
#define FAST_AVX512_H

#define KERNEL_TARGET                                                                              \
    __attribute__((target("avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/vectors_avx512.h"
#include "ref/fast/kernel/walk_group.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
}

/* 16 numbers of a row of so many bits each, from bit `first` on. The row lies in 16 words; a bit
 * beyond them is not of the row. */
INLINE __m512i row16(const uint32_t *block, uint32_t first, uint32_t width)
{
    const __m512i number = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i row = _mm512_loadu_si512(block + (first >> 5)), one = _mm512_set1_epi32(1);
    __m512i at = _mm512_mullo_epi16(number, _mm512_set1_epi32((int)width));
    at = _mm512_add_epi32(at, _mm512_set1_epi32((int)(first & 31)));
    const __m512i word = _mm512_srli_epi32(at, 5);
    const __m512i shift = _mm512_and_si512(at, _mm512_set1_epi32(31));
    const __m512i low = _mm512_srlv_epi32(_mm512_permutexvar_epi32(word, row), shift);
    const __m512i high =
        _mm512_sllv_epi32(_mm512_permutexvar_epi32(_mm512_add_epi32(word, one), row),
                          _mm512_sub_epi32(_mm512_set1_epi32(32), shift));
    const __m512i mask = _mm512_set1_epi32((int)_bzhi_u32(~0u, width));
    return _mm512_ternarylogic_epi32(low, high, mask, 0xA8); /* (a | b) & c */
}

#endif

/* The AVX-512 traversal of tiny trees: rows of 32 vertices in two registers, and 16 triangles at
 * once. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_TINY
#define GROUP_16
#define KERNEL_TARGET                                                                              \
    __attribute__((target("avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/vectors_avx512.h"
#include "ref/fast/kernel/walk_group.h"

/* Two 16-bit words of each triangle, in which its 15 bits are. */
INLINE void triplets(const char *from, group_codes c[3])
{
    const __m512i two =
        _mm512_setr_epi32(0x10000, 0x10000, 0x20001, 0x30002, 0x40003, 0x50004, 0x60005, 0x70006,
                          0x80007, 0x90008, 0xA0009, 0xB000A, 0xC000B, 0xD000C, 0xE000D, 0xF000E);
    const __m512i shift = _mm512_setr_epi32(0, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1);
    const __m256i all = _mm256_loadu_si256((const __m256i *)(const void *)from);
    c[0] = _mm512_permutexvar_epi16(two, _mm512_castsi256_si512(all));
    c[0] = _mm512_srlv_epi32(c[0], shift);
    c[1] = _mm512_srli_epi32(c[0], 5);
    c[2] = _mm512_srli_epi32(c[0], 10);
}

/* The row lies in 16 words. A bit beyond them is not of the row. */
INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
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
    const __m512i v = _mm512_ternarylogic_epi32(low, high, mask, 0xA8); /* (a | b) & c */
    return (float16)_mm512_cvtepi32_ps(_mm512_add_epi32(v, _mm512_set1_epi32((int)more)));
}

/* The permutation of two registers reads the lowest 5 bits of a code. */
INLINE group corners32(const float16 half[2], group_codes code, uint32_t count)
{
    (void)count;
    return (group)_mm512_permutex2var_ps((__m512)half[0], code, (__m512)half[1]);
}

#include "ref/fast/kernel/walk.h"

static bool runs(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
}

const struct fast_kernel fast_tiny_avx512 = {"avx512", runs, closest, any_hit, NULL};

#endif

/* The AVX-512 traversal of tiny trees: rows of 32 vertices in two registers, and 16 triangles at
 * once. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_TINY
#define GROUP_16
#include "ref/fast/kernel/avx512.h"

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

INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t more)
{
    const __m512i v = _mm512_add_epi32(row16(block, first, width), _mm512_set1_epi32((int)more));
    return (float16)_mm512_cvtepi32_ps(v);
}

/* The permutation of two registers reads the lowest 5 bits of a code. */
INLINE group corners32(const float16 half[2], group_codes code, uint32_t count)
{
    (void)count;
    return (group)_mm512_permutex2var_ps((__m512)half[0], code, (__m512)half[1]);
}

#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_tiny_avx512 = {"avx512", runs, closest, any_hit, NULL};

#endif

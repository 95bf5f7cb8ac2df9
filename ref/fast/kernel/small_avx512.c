/* The AVX-512 traversal of small trees: rows of 16 vertices in one register, and 16 triangles at
 * once. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_SMALL
#define GROUP_16
#include "ref/fast/kernel/avx512.h"

/* Two 16-bit words of each triangle, in which its 12 bits are. */
INLINE void triplets(const uint32_t *from, group_codes c[3])
{
    const __m512i two =
        _mm512_setr_epi32(0x10000, 0x10000, 0x20001, 0x30002, 0x40003, 0x40003, 0x50004, 0x60005,
                          0x70006, 0x70006, 0x80007, 0x90008, 0xA0009, 0xA0009, 0xB000A, 0xC000B);
    const __m512i shift = _mm512_setr_epi32(0, 12, 8, 4, 0, 12, 8, 4, 0, 12, 8, 4, 0, 12, 8, 4);
    const __m256i all = _mm256_loadu_si256((const __m256i *)(const void *)from);
    c[0] = _mm512_permutexvar_epi16(two, _mm512_castsi256_si512(all));
    c[0] = _mm512_srlv_epi32(c[0], shift);
    c[1] = _mm512_srli_epi32(c[0], 4);
    c[2] = _mm512_srli_epi32(c[0], 8);
}

INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t least,
                        uint32_t count)
{
    __m512i v = _mm512_add_epi32(row16(block, first, width), _mm512_set1_epi32((int)least));
    v = _mm512_maskz_ternarylogic_epi32((__mmask16)_bzhi_u32(0xFFFF, count), v,
                                        _mm512_srai_epi32(v, 31), _mm512_set1_epi32(0x7FFFFFFF),
                                        0x78); /* a ^ (b & c) */
    return (float16)v;
}

#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_small_avx512 = {"avx512", runs, closest, any_hit, NULL};

#endif

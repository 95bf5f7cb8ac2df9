/* The AVX2 traversal of small trees: rows of 16 vertices in two registers, of which most leaves
 * need both. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_SMALL
#include "ref/fast/kernel/avx2.h"

/* Every lane has its 12 bits, and 4 bits that are no code's. */
INLINE void triplets(const uint32_t *from, group_codes c[3])
{
    const __m256i two = _mm256_setr_epi8(0, 1, -1, -1, 1, 2, -1, -1, 3, 4, -1, -1, 4, 5, -1, -1, 6,
                                         7, -1, -1, 7, 8, -1, -1, 9, 10, -1, -1, 10, 11, -1, -1);
    const __m256i odd = _mm256_setr_epi32(0, 4, 0, 4, 0, 4, 0, 4);
    const __m128i all = _mm_loadu_si128((const __m128i *)(const void *)from);
    c[0] = _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(all), two);
    c[0] = _mm256_srlv_epi32(c[0], odd);
    c[1] = _mm256_srli_epi32(c[0], 4);
    c[2] = _mm256_srli_epi32(c[0], 8);
}

/* Eight integers of a row, as floats' bits. */
INLINE __m256i unpacked8(const uint32_t *block, uint32_t first, uint32_t width, uint32_t least)
{
    const __m256i v = _mm256_add_epi32(row8(block, first, width), _mm256_set1_epi32((int)least));
    return _mm256_xor_si256(v, _mm256_srli_epi32(_mm256_srai_epi32(v, 31), 1));
}

/* Lanes beyond the row hold what follows it; no corner refers to them. */
INLINE float16 unpacked(const uint32_t *block, uint32_t first, uint32_t width, uint32_t least,
                        uint32_t count)
{
    __m256i half[2];
    float16 out;
    half[0] = unpacked8(block, first, width, least);
    half[1] = count > 8 ? unpacked8(block, first + 8 * width, width, least) : half[0];
    memcpy(&out, half, sizeof out);
    return out;
}

#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_small_avx2 = {"avx2", runs, closest, any_hit, NULL};

#endif

/* The AVX2 traversal of small trees: rows of 16 vertices in two registers, of which most leaves
 * need both. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_SMALL
#define FAST_AVX2
#define KERNEL_TARGET __attribute__((target("avx2,fma,bmi,bmi2,lzcnt,popcnt")))
#define INLINE        KERNEL_TARGET static inline __attribute__((always_inline))
#include "ref/fast/kernel/vectors.h"
#include "ref/fast/kernel/vectors_avx2.h"
#include "ref/fast/kernel/push.h"
#include "ref/fast/kernel/walk_group.h"

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

/* Eight integers of a row. They lie in nine words. */
INLINE __m256i unpacked8(const uint32_t *block, uint32_t first, uint32_t width, uint32_t least)
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
    v = _mm256_add_epi32(v, _mm256_set1_epi32((int)least));
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

static bool runs(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi2");
}

const struct fast_kernel fast_small_avx2 = {"avx2", runs, closest, any_hit, NULL};

#endif

/* Triangles that are tested at once: 8, or 16 where GROUP_16 is defined. Expects INLINE and the
 * functions of a kernel on so many lanes. */
#ifndef WALK_GROUP_H
#define WALK_GROUP_H

#ifdef GROUP_16

#define GROUP 16
typedef float16 group;
typedef __m512i group_codes;

INLINE group group_all(float x)
{
    return (group)_mm512_set1_ps(x);
}

INLINE group group_min(group a, group b)
{
    return min16(a, b);
}

INLINE group group_max(group a, group b)
{
    return max16(a, b);
}

INLINE uint32_t group_less(group a, group b)
{
    return less16(a, b);
}

INLINE uint32_t group_unequal(group a, group b)
{
    return unequal16(a, b);
}

/* The lanes in which t is at or above the number of which `least` has copies, or below that of
 * `most`. */
INLINE uint32_t group_not_below(group t, float8 least)
{
    return not_above16(group_all(least[0]), t);
}

INLINE uint32_t group_below(group t, float8 most)
{
    return less16(t, group_all(most[0]));
}

/* The permutation of 16 lanes reads the lowest 4 bits of a code. */
INLINE group group_corners(float16 row, group_codes code, uint32_t count)
{
    (void)count;
    return (group)_mm512_permutexvar_ps(code, (__m512)row);
}

/* As below. */
INLINE uint32_t group_nearest(group t, uint32_t in, float *least)
{
    const __m512 far = _mm512_set1_ps(__builtin_inff());
    const __m512 all = _mm512_mask_blend_ps((__mmask16)in, far, (__m512)t);
    __m512 m = _mm512_min_ps(all, _mm512_shuffle_f32x4(all, all, 0x4E));
    m = _mm512_min_ps(m, _mm512_shuffle_f32x4(m, m, 0xB1));
    m = _mm512_min_ps(m, _mm512_permute_ps(m, 0x4E));
    m = _mm512_min_ps(m, _mm512_permute_ps(m, 0xB1));
    const uint32_t lane = _tzcnt_u32(_mm512_cmp_ps_mask(all, m, _CMP_EQ_OQ)) & 15;
    /* Of zeros of both signs, that lane's. */
    *least = _mm512_cvtss_f32(_mm512_permutexvar_ps(_mm512_set1_epi32((int)lane), all));
    return lane;
}

#else

#define GROUP 8
typedef float8 group;
typedef codes8 group_codes;

INLINE group group_all(float x)
{
    return all8(x);
}

INLINE group group_min(group a, group b)
{
    return min8(a, b);
}

INLINE group group_max(group a, group b)
{
    return max8(a, b);
}

INLINE uint32_t group_less(group a, group b)
{
    return less(a, b);
}

INLINE uint32_t group_unequal(group a, group b)
{
    return unequal(a, b);
}

INLINE uint32_t group_not_below(group t, float8 least)
{
    return not_above(least, t);
}

INLINE uint32_t group_below(group t, float8 most)
{
    return less(t, most);
}

INLINE group group_corners(float16 row, group_codes code, uint32_t count)
{
    return corners(row, code, count);
}

#ifdef FAST_LANES
/* The first lane with the least number of the lanes `in`, and that number; of no lanes, any lane
 * and infinity. */
INLINE uint32_t group_nearest(group t, uint32_t in, float *least)
{
    return nearest8(t, in, least);
}
#endif

#endif

#endif

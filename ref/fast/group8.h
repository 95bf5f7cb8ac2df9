/* Triangles in groups of 8. Expects INLINE and the functions on 8 lanes of a kernel. */
#ifndef FAST_GROUP8_H
#define FAST_GROUP8_H

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

/* The lanes in which t is at or above the number of which `least` has copies, or below that of
 * `most`. */
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

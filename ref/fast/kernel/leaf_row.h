/* The vertices of a leaf along an axis: up to 16, or up to 32 where FAST_TINY is defined. Expects
 * ref/fast/kernel/walk_group.h. */
#ifdef FAST_TINY

typedef struct {
    float16 half[2];
} leaf_row;

INLINE leaf_row row_minus(leaf_row row, float16 from)
{
    return (leaf_row){{row.half[0] - from, row.half[1] - from}};
}

INLINE leaf_row row_times(leaf_row row, float16 by)
{
    return (leaf_row){{by * row.half[0], by * row.half[1]}};
}

INLINE leaf_row row_minus_row(leaf_row a, leaf_row b)
{
    return (leaf_row){{a.half[0] - b.half[0], a.half[1] - b.half[1]}};
}

/* The vertices of a group of triangles, by codes of 5 bits. */
INLINE group row_corners(leaf_row row, group_codes code, uint32_t count)
{
    return corners32(row.half, code, count);
}

#else

typedef float16 leaf_row;

INLINE leaf_row row_minus(leaf_row row, float16 from)
{
    return row - from;
}

INLINE leaf_row row_times(leaf_row row, float16 by)
{
    return by * row;
}

INLINE leaf_row row_minus_row(leaf_row a, leaf_row b)
{
    return a - b;
}

/* The same by codes of 4 bits. */
INLINE group row_corners(leaf_row row, group_codes code, uint32_t count)
{
    return group_corners(row, code, count);
}

#endif

/* Compares every number on two paths in order of computation. Finds the first number that differs
 * and its first bit. */
#ifndef DIFF_VALUES_H
#define DIFF_VALUES_H

#include "scenes/render/diff_walk.h"

/* The first difference of two paths. */
struct first_bit {
    bool differs;
    uint32_t segment;
    uint32_t light;   /* UINT32_MAX: not at a light */
    const char *name; /* name of the number: "t", "origin x"; static */
    bool is_float;    /* false: an integer or a boolean */
    uint32_t bits[2]; /* in both; "goes on" is 0 in a segment after a path's end */
    unsigned bit;     /* highest bit that differs, 0 to 31 */
    uint64_t ulps;    /* floats: number of steps between both; 0 for -0 and 0 */
};

/* Compares path `index` of two walks of the same job. Hits of any-hit shadow rays are not compared:
 * any triangle blocks the light. */
struct first_bit walk_first_bit(const struct diff_walk *a, const struct diff_walk *b, size_t index);

#endif

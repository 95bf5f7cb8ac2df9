/* Compares every number on two paths in the order of computation: names the first number that
 * differs, and its first bit. */
#ifndef DIFF_VALUES_H
#define DIFF_VALUES_H

#include "scenes/render/diff_walk.h"

/* Where two paths first differ. */
struct first_bit {
    bool differs;
    uint32_t segment;
    uint32_t light;   /* UINT32_MAX: none */
    const char *name; /* of the number: "t", "origin x"; static */
    bool is_float;    /* else a whole number, or a yes or no */
    uint32_t bits[2]; /* of both; a path that has ended has the segment "goes on": 0 */
    unsigned bit;     /* the highest that differs, 0 to 31 */
    uint64_t ulps;    /* floats: how many floats apart; -0 and 0 are none */
};

/* Compares path `index` of two walks of the same job. What any-hit shadow rays met is not compared:
 * whichever triangle it is, the light is blocked. */
struct first_bit walk_first_bit(const struct diff_walk *a, const struct diff_walk *b, size_t index);

#endif

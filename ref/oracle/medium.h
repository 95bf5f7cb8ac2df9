/* One ray and one triangle in 320 bits, for exponents that lie too far apart for ref/oracle/small.h
 * by no more than some 60 bits; many times faster than wide. For the oracle's own files. */
#ifndef ORACLE_MEDIUM_H
#define ORACLE_MEDIUM_H

#include "ref/integers/wide.h"

#include <stdbool.h>

#define MEDIUM_LIMBS 5

/* Two's complement, least limb first. */
struct medium {
    uint64_t limb[MEDIUM_LIMBS];
};

/* Vertices relative to the origin, and the direction, in units of their own; how many bits they
 * take, less than 127 each. */
struct medium_input {
    __int128 a[3][3], d[3];
    int place_bits, way_bits;
};

struct medium_products {
    struct medium w[3], det, t;
};

/* Returns false if they do not fit. */
bool medium_multiply(const struct medium_input *in, struct medium_products *out);

int medium_sign(const struct medium *a);
void medium_wide(const struct medium *a, struct oracle_wide *out);

#endif

/* Float32 numbers as integers on a common grid: x = m * 2^exponent.. */
#ifndef ORACLE_GRID_H
#define ORACLE_GRID_H

#include "ref/base/base.h"
#include "ref/integers/wide.h"

#include <math.h>
#include <string.h>

/* 2^exponent, which is a normal number. */
static inline double power_of_two(int exponent)
{
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* x * 2^exponent as ldexp rounds it. */
static inline double times_power(double x, int exponent)
{
    return exponent >= -1022 && exponent <= 1023 ? x * power_of_two(exponent) : ldexp(x, exponent);
}

/* x = m * 2^exponent with m odd, or m = exponent = 0. */
struct odd {
    int32_t m;
    int exponent;
};

struct odd odd_of(float x);

/* The grid of `count` numbers: the largest power of two of which all are multiples, and the bits
 * that the largest of them then has. */
struct oracle_grid {
    int exponent;
    int bits; /* |x| < 2^(exponent + bits); 0 if all are 0 */
};

struct oracle_grid grid_of(const struct odd *x, int count);

/* x in units of the grid; the first needs grid.bits <= 126. */
__int128 grid_int(struct oracle_grid grid, struct odd x);
void grid_wide(struct oracle_grid grid, struct odd x, struct oracle_wide *out);

#endif

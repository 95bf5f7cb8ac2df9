/* Where placed points lie: coordinate k of point p is M_k0 p_0 + M_k1 p_1 + M_k2 p_2 + T_k,
 * a sum of real numbers, with at most 556 bits for any finite float32 numbers. */
#ifndef PLACED_H
#define PLACED_H

#include "ref/integers/wide.h"
#include "ref/scene/scene.h"

/* The largest float32 that is at most the coordinate and the least that is at least that: equal if
 * the coordinate is a float32. Infinite where no float32 is. `row` is a row of a transform; all
 * numbers are finite. */
void placed_round(const float row[4], const float p[3], float *below, float *above);

/* Sign of the coordinate minus x, which is finite. */
int placed_compare(const float row[4], const float p[3], float x);

/* The coordinate minus x, exactly, in units of 2^*exponent; x is finite. */
void placed_difference(const float row[4], const float p[3], float x, struct oracle_wide *out,
                       int *exponent);

/* Bound of the error of placed_about: its sum and that of the bound have three roundings each, and
 * products of two float32 numbers have none in double. */
#define PLACED_ERROR 0x1.8p-52

/* The coordinate in double; *error bounds the difference from it. */
static inline double placed_about(const float row[4], const float p[3], double *error)
{
    double a = (double)row[0] * (double)p[0] + (double)row[1] * (double)p[1];
    double b = a + (double)row[2] * (double)p[2];
    double c = b + (double)row[3];
    *error = ((a < 0 ? -a : a) + (b < 0 ? -b : b) + (c < 0 ? -c : c)) * PLACED_ERROR;
    return c;
}

/* Grows the range [*lo, *hi] of float32 numbers by a coordinate, exactly: to placed_round's. */
static inline void placed_grow(const float row[4], const float p[3], float *lo, float *hi)
{
    double error, about = placed_about(row, p, &error);
    if (about - error >= (double)*lo && about + error <= (double)*hi)
        return;
    float below, above;
    placed_round(row, p, &below, &above);
    *lo = below < *lo ? below : *lo;
    *hi = above > *hi ? above : *hi;
}

/* The least box of float32 numbers that contains a placed triangle; its bounds are infinite where
 * no float32 is. */
struct box placed_tri_bounds(const float m[3][4], float v[3][3]);

/* The same of a placed box of points, which is a parallelepiped. `box` is not empty. */
struct box placed_box_bounds(const float m[3][4], const struct box *box);

#endif

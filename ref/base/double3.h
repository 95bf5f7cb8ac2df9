/* Vectors of three doubles. */
#ifndef DOUBLE3_H
#define DOUBLE3_H

#include <math.h>
#include <stdbool.h>

/* out = a - b */
static inline void double3_sub(const float a[3], const float b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k] - (double)b[k];
}

static inline double double3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* `out` must be neither a nor b. */
static inline void double3_cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Scales `v` to length 1; false, and `v` unchanged, if its length is 0 or NaN. */
static inline bool double3_unit(double v[3])
{
    double length = sqrt(double3_dot(v, v));
    if (!(length > 0))
        return false;
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return true;
}

#endif

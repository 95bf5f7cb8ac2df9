/* Affine maps of points, made from user input and composed in order. */
#ifndef TRANSFORM_H
#define TRANSFORM_H

#include "ref/base/base.h"

/* A point p becomes row . p + row[3], computed in double. */
struct transform {
    double row[3][4];
    bool mirrors; /* the determinant is negative: triangles change their winding */
    bool any;     /* false: the identity, which changes no bit */
};

/* The identity. A zero struct is not the identity. */
struct transform transform_identity(void);

/* The map that applies `first`, then `second`. */
struct transform transform_then(const struct transform *first, const struct transform *second);

/* Each makes one map. All numbers must be finite.
 * Errors: STATUS_INPUT with the rule; *out is then the identity. */

struct transform transform_translate(const float by[3]);

/* Rotates about an axis through the origin by `degrees`, counter-clockwise as seen from the axis'
 * tip. Multiples of 90 degrees about a coordinate axis are exact. The axis may have any length but
 * 0. */
enum status transform_rotate(const float axis[3], float degrees, struct transform *out,
                             struct reason *reason) MUST_USE;

/* Scales along the axes. No factor may be 0; a negative one mirrors. */
enum status transform_scale(const float by[3], struct transform *out,
                            struct reason *reason) MUST_USE;

/* A 4 x 4 matrix row by row, for column vectors: the fourth column translates, the last row is 0 0
 * 0 1. Singular matrices are rejected: |determinant| at most 2^-40 of the product of the row
 * lengths. */
enum status transform_matrix(const float number[16], struct transform *out,
                             struct reason *reason) MUST_USE;

/* Maps a point; infinite where the result is outside the range of a float. `in` may be `out`. */
void transform_point(const struct transform *transform, const float in[3], float out[3]);

#endif

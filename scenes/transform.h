/* Affine maps of points, made from what a user writes and done one after the other. */
#ifndef TRANSFORM_H
#define TRANSFORM_H

#include "ref/base/base.h"

/* A point p becomes row . p + row[3], computed in double. */
struct transform {
    double row[3][4];
    bool mirrors; /* turns left into right, so that a triangle's winding turns around */
    bool any;     /* false: the identity, which leaves every bit as it is */
};

/* The identity, which a zero struct is not. */
struct transform transform_identity(void);

/* `first`, then `second`. */
struct transform transform_then(const struct transform *first, const struct transform *second);

/* Each makes one step. All numbers must be finite.
 * Errors: STATUS_INPUT with the rule; *out is then the identity. */

struct transform transform_translate(const float by[3]);

/* About an axis through the origin, by `degrees`, counter-clockwise as seen from the axis' tip; of
 * multiples of 90 degrees about a coordinate axis no rounding is left. The axis has any length but
 * 0. */
enum status transform_rotate(const float axis[3], float degrees, struct transform *out,
                             struct reason *reason) MUST_USE;

/* Along the axes; no factor may be 0, a negative one mirrors. */
enum status transform_scale(const float by[3], struct transform *out,
                            struct reason *reason) MUST_USE;

/* Row by row, for points as columns: the fourth column moves, the last row is 0 0 0 1 and nothing
 * may be flattened (determinant 0, or below 2^-40 of what rows of that length could have). */
enum status transform_matrix(const float number[16], struct transform *out,
                             struct reason *reason) MUST_USE;

/* Moves a point; infinite where the result leaves the range of a float. `in` may be `out`. */
void transform_point(const struct transform *transform, const float in[3], float out[3]);

#endif

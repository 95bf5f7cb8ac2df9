/* Distances between floats in steps of a format. */
#ifndef EXPLAIN_STEPS_H
#define EXPLAIN_STEPS_H

#include <stdint.h>

/* How many floats `to` is above `from`, negative if below; -0 and 0 are one. Infinity is one step
 * beyond FLT_MAX. A NaN counts as beyond infinity, with its sign. */
int64_t float_steps(float from, float to);

/* The distance in float16 steps: whole ones between halves, a fraction inside a step; negative if
 * `to` is below. Beyond 65504 steps go on as if the exponent had no limit. NaN if one is NaN. */
double half_steps(float from, float to);

#endif

/* The numbers of one ray and triangle as integers of three sizes. For the oracle's own files.
 *
 * As in ref/oracle/small.h, vertices and origin share one grid of unit P and the direction has its
 * own of unit Q; of a placed triangle the vertices are M v + T, in sums without rounding. */
#ifndef ORACLE_EXACT_INPUT_H
#define ORACLE_EXACT_INPUT_H

#include "ref/oracle/medium.h"
#include "ref/oracle/small.h"
#include "ref/world/world.h"

/* Vertices relative to the origin, and the direction, in their units. */
struct wide_input {
    struct oracle_wide a[3][3], d[3];
};

/* Each fills in *out and *scale, of which t is T / D * 2^*scale. `at` is NULL or the instance that
 * has placed the triangle. The first two return false if the numbers take too many bits. */
bool input_small(const struct ray *ray, float v[3][3], const struct instance *at, struct small *out,
                 int *scale);
bool input_medium(const struct ray *ray, float v[3][3], const struct instance *at,
                  struct medium_input *out, int *scale);
void input_wide(const struct ray *ray, float v[3][3], const struct instance *at,
                struct wide_input *out, int *scale);

#endif

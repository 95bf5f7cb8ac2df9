/* Formulas replayed in scatters (ref/twin/scatter.h): which answers can some evaluation give? */
#ifndef TWIN_REPLAY_H
#define TWIN_REPLAY_H

#include "ref/primitives/primitives.h"
#include "ref/twin/scatter.h"
#include "ref/twin/twin_placed.h"

/* An answer, or all those between two: t, u and v. */
struct replay_answer {
    double lo[3], hi[3];
};

/* True unless no evaluation of `formula` with these liberties accepts the triangle and gives this
 * answer. The ray is in contract. Bounds and lists are wider than what is possible, so that
 * true proves nothing. Equal vertices are taken to come to equal numbers, as the same operations of
 * the same numbers do. */
bool replay_can_answer(enum twin_formula formula, const struct liberty *liberty,
                       const struct ray *ray, float v[3][3], const struct replay_answer *answer);

/* The same of a placed triangle, whose formula is one of ref/primitives/: the numbers of the ray in
 * the space of the mesh are scatters, too. */
bool replay_can_answer_placed(enum twin_formula formula, const struct liberty *liberty,
                              const struct twin_ray *ray, float v[3][3],
                              const struct replay_answer *answer);

/* The least size that a determinant of TWIN_EMBREE may have and not be 0; INFINITY: it is 0. */
double replay_least_det(const struct liberty *liberty, const struct ray *ray, float v[3][3]);

#endif

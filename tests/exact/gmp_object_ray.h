/* The ray in the space of a mesh as engines of ours must compute it, bit for bit: every operation
 * of the contract (ref/world/object_ray.h) done on rationals and rounded by definition. */
#ifndef GMP_OBJECT_RAY_H
#define GMP_OBJECT_RAY_H

#include "ref/world/world.h"

/* False if a number on the way is beyond float32. */
bool gmp_object_ray(const struct instance *instance, const struct ray *ray, struct ray *out);

/* |M| |M^-1|, the largest row sums, from above by at most 1 in 2^40. */
double gmp_kappa(const struct instance *instance);

#endif

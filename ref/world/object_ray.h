/* How a ray gets into the space of a mesh: the contract of all engines of ours. C and shaders
 * follow it, each written from here, to the same bits.
 *
 * A mesh is placed at M p + T. With W, the inverse of M rounded once to float32:
 *     x_k  = o_k - T_k                              one subtraction
 *     o'_k = (W_k0 x_0 + W_k1 x_1) + W_k2 x_2       products before sums, no contraction
 *     d'_k = (W_k0 d_0 + W_k1 d_1) + W_k2 d_2
 * The origin is taken relative to T first: W o - W T would cancel. tmin and tmax stay, and so does
 * t: it counts in multiples of the direction, whatever the transform does to its length.
 * An instance at the identity (ABI_INSTANCE_IDENTITY) takes the ray as it is: the sums above would
 * turn -0 into 0 and may flush subnormals. */
#ifndef OBJECT_RAY_H
#define OBJECT_RAY_H

#include "ref/abi_world.h"
#include "ref/base/base.h"

/* The ray in the space of the mesh of `instance`. */
static inline struct ray transform_ray(const struct instance_record *instance,
                                       const struct ray *ray)
{
    struct ray out = *ray;
    if (instance->flags & ABI_INSTANCE_IDENTITY)
        return out;
    float x[3];
    for (int k = 0; k < 3; k++)
        x[k] = ray->org[k] - instance->t[k];
    for (int k = 0; k < 3; k++) {
        const float *w = instance->w + 3 * k;
        out.org[k] = (w[0] * x[0] + w[1] * x[1]) + w[2] * x[2];
        out.dir[k] = (w[0] * ray->dir[0] + w[1] * ray->dir[1]) + w[2] * ray->dir[2];
    }
    return out;
}

/* Writes the inverse of M, row by row: each number is the exact one rounded to the nearest float32,
 * a subnormal too. m is finite, its determinant not 0 (world_finish). Errors: STATUS_LIMIT a number
 * of the inverse is beyond float32: row and column. */
enum status transform_inverse(const float m[3][4], float w[9], struct reason *reason) MUST_USE;

#endif

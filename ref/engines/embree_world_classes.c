/* Which instances of a world Embree may be given a ray for, and its masks of both. */
#include "ref/engines/embree_device.h"

#if HAVE_EMBREE

#include "ref/engines/embree_world_inner.h"

#include <math.h>

static const double class_most[CLASSES] = {0x1p8, 0x1p20, 0x1p32, INFINITY};

/* Embree's inverse is the adjoint times the reciprocal of the determinant, in float32. Five
 * roundings in a row and flushed subnormals change the determinant by at most DET_ERROR of the sum
 * of its terms' sizes and DET_LOST of the largest number and 1. */
#define DET_ERROR 0x1.5p-22
#define DET_LOST  0x1p-120
#define DET_MOST  0x1p120

static double largest_of(const float v[3])
{
    return fmax(fabs((double)v[0]), fmax(fabs((double)v[1]), fabs((double)v[2])));
}

/* The largest row sum that Embree's inverse of M can have; 0 if it may be infinite or NaN. */
static double growth_of(const float m[3][4])
{
    double det = 0.0, size = 0.0, largest = 1.0, most = 0.0;
    for (int i = 0; i < 3; i++) {
        double sum = 0.0;
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            double a = (double)m[j1][i1] * (double)m[j2][i2];
            double b = (double)m[j1][i2] * (double)m[j2][i1];
            sum += fabs(a) + fabs(b);
            largest = fmax(largest, fabs((double)m[j][i]));
            if (i == 0) {
                det += (double)m[j][0] * (a - b);
                size += fabs((double)m[j][0]) * (fabs(a) + fabs(b));
            }
        }
        most = fmax(most, sum);
    }
    double least = fabs(det) - DET_ERROR * size - DET_LOST * largest;
    if (!(least > 0.0 && size < DET_MOST && most < DET_MOST))
        return 0.0;
    return 1.0625 * most / least;
}

/* The class of an instance, to which it is added; CLASSES if Embree may abort on every ray. */
static uint32_t add_to_class(struct embree_world *world, const struct instance *instance)
{
    const float to[3] = {instance->m[0][3], instance->m[1][3], instance->m[2][3]};
    double growth = growth_of(instance->m);
    uint32_t at = 0;
    if (growth == 0.0)
        return CLASSES;
    while (growth > class_most[at])
        at++;
    world->class[at].growth = fmax(world->class[at].growth, growth);
    world->class[at].far = fmax(world->class[at].far, largest_of(to));
    return at;
}

uint32_t embree_mask_for(const struct embree *embree, const struct ray *ray, struct ray_mode mode)
{
    uint32_t mask = 0;
    if (!embree_takes(embree, ray) || (mode.flags & ABI_RAY_SKIP_TRIANGLES))
        return 0;
    const double org = largest_of(ray->org), dir = largest_of(ray->dir);
    for (uint32_t i = 0; i < CLASSES; i++) {
        const struct embree_class *class = &embree->world->class[i];
        if (embree->unguarded || class->growth * fmax(org + class->far, dir) < (double)EMBREE_MOST)
            mask |= mode.mask << 8 * i;
        else if (!embree->masks)
            return 0;
    }
    return mask;
}

enum status embree_instance_mask(struct embree *embree, uint32_t number, uint32_t *out,
                                 struct reason *reason)
{
    const struct instance *instance = &embree->world->world->instance[number];
    uint32_t class = add_to_class(embree->world, instance);
    if (class == CLASSES && !embree->unguarded)
        return fail(reason, STATUS_UNSUPPORTED,
                    "Embree: instance %u: the inverse of its transform is beyond float32, or the "
                    "transform too near to singular: Embree may abort",
                    number);
    *out = instance->mask << 8 * (class % CLASSES);
    return STATUS_OK;
}

#endif

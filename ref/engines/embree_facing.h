/* Which side of a triangle Embree's hit in a world is on. Include where Embree's headers are. */
#ifndef EMBREE_FACING_H
#define EMBREE_FACING_H

#include "ref/engines/embree_inner.h"
#include "ref/world/world.h"

#include <math.h>

/* True if the front is seen: Ng is (v1 - v0) x (v2 - v0), and the direction that of the space of
 * the mesh. */
static inline bool sees_front(const struct instance *instance, const struct RTCRay *ray,
                              const struct RTCHit *hit)
{
    double side = (double)ray->dir_x * (double)hit->Ng_x + (double)ray->dir_y * (double)hit->Ng_y +
                  (double)ray->dir_z * (double)hit->Ng_z;
    return world_is_front(instance, side < 0.0 ? -1 : 1);
}

/* (a x b) . n */
static inline double across(const float a[3], const float b[3], const double n[3])
{
    return ((double)a[1] * (double)b[2] - (double)a[2] * (double)b[1]) * n[0] +
           ((double)a[2] * (double)b[0] - (double)a[0] * (double)b[2]) * n[1] +
           ((double)a[0] * (double)b[1] - (double)a[1] * (double)b[0]) * n[2];
}

/* Leaves in Ng_x which side is seen, for the direction in the world: d' = M^-1 d, so d' . Ng has
 * the sign of det M times that of d . (cofactors of M) Ng. */
static inline void face_from_world(const struct instance *instance, struct RTCRayHit *query)
{
    const struct RTCRay *ray = &query->ray;
    const struct RTCHit *hit = &query->hit;
    const double d[3] = {(double)ray->dir_x, (double)ray->dir_y, (double)ray->dir_z};
    const double n[3] = {(double)hit->Ng_x, (double)hit->Ng_y, (double)hit->Ng_z};
    const double row[3] = {(double)instance->m[0][0], (double)instance->m[0][1],
                           (double)instance->m[0][2]};
    double side = across(instance->m[1], instance->m[2], n) * d[0] +
                  across(instance->m[2], instance->m[0], n) * d[1] +
                  across(instance->m[0], instance->m[1], n) * d[2];
    double det = across(instance->m[1], instance->m[2], row);
    side = signbit(det) ? -side : side; /* 0 counts as positive, as in sees_front */
    query->hit.Ng_x = (float)world_is_front(instance, side < 0.0 ? -1 : 1);
}

#endif

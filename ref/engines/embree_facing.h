/* Which side of a triangle Embree's hit in a world is on. Include where Embree's headers are. */
#ifndef EMBREE_FACING_H
#define EMBREE_FACING_H

#include "ref/engines/embree_inner.h"
#include "ref/world/world.h"

/* True if the front is seen: Ng is (v1 - v0) x (v2 - v0), and the direction that of the space of
 * the mesh. */
static inline bool sees_front(const struct instance *instance, const struct RTCRay *ray,
                              const struct RTCHit *hit)
{
    double side = (double)ray->dir_x * (double)hit->Ng_x + (double)ray->dir_y * (double)hit->Ng_y +
                  (double)ray->dir_z * (double)hit->Ng_z;
    return world_is_front(instance, side < 0.0 ? -1 : 1);
}

/* Leaves in Ng_x which side is seen, for the direction in the world: d' = M^-1 d, so d' . Ng has
 * the sign of det M times that of d . (cofactors of M) Ng. */
static inline void face_from_world(const struct instance *instance, struct RTCRayHit *query)
{
    const struct RTCRay *ray = &query->ray;
    const struct RTCHit *hit = &query->hit;
    const double d[3] = {(double)ray->dir_x, (double)ray->dir_y, (double)ray->dir_z};
    const double n[3] = {(double)hit->Ng_x, (double)hit->Ng_y, (double)hit->Ng_z};
    double side = 0, det = 0;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) {
            const float *a = instance->m[(k + 1) % 3], *b = instance->m[(k + 2) % 3];
            double cofactor = (double)a[(j + 1) % 3] * (double)b[(j + 2) % 3] -
                              (double)a[(j + 2) % 3] * (double)b[(j + 1) % 3];
            side += d[k] * cofactor * n[j];
            det += k == 0 ? (double)instance->m[0][j] * cofactor : 0;
        }
    bool front = world_is_front(instance, (side < 0.0) != (det < 0.0) ? -1 : 1);
    query->hit.Ng_x = front ? 1.0f : -1.0f;
}

#endif

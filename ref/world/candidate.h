/* Whether a triangle of an instance that a ray hits counts as a hit. */
#ifndef CANDIDATE_H
#define CANDIDATE_H

#include "ref/world/world.h"

/* An instance that a ray is in. */
struct instance_at {
    const struct world *world;
    const struct instance_record *record; /* its own */
    uint32_t index;
    struct ray_mode mode;
};

/* d . ((v1 - v0) x (v2 - v0)) in this order of operations, which is part of the contract of
 * trace_world_ray. It is computed from the vertices of the mesh, whatever the triangle test and the
 * storage have: some have no determinant of that sign. */
static inline float candidate_side(const float d[3], float v[3][3])
{
    float a[3], b[3], n[3];
    for (int k = 0; k < 3; k++) {
        a[k] = v[1][k] - v[0][k];
        b[k] = v[2][k] - v[0][k];
    }
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
    return (d[0] * n[0] + d[1] * n[1]) + d[2] * n[2];
}

/* Decides about a hit whose prim is a triangle of the mesh; `dir` is the direction in the space of
 * the mesh. If it counts, hit->prim becomes the number of the placed triangle, and *tag is set. */
static inline bool candidate_counts(const struct instance_at *at, const float dir[3],
                                    struct hit *hit, uint32_t *tag)
{
    const struct world *world = at->world;
    const struct instance *instance = &world->instance[at->index];
    struct place place = world_place_in(world, at->index, hit->prim);
    const struct world_mesh *mesh = &world->mesh[place.mesh];
    bool opaque = world_is_opaque(instance, mesh->geometry[place.geometry].opaque, at->mode);
    float v[3][3];
    scene_tri(mesh->scene, hit->prim, v);
    bool front = world_is_front(instance, candidate_side(dir, v) < 0.0f ? -1 : 1);
    if (world_culls(instance, opaque, front, at->mode))
        return false;
    if (!opaque && !filter_passes(&world->filter, &place, hit->u, hit->v))
        return false;
    hit->prim = at->record->first + hit->prim;
    *tag = (at->record->custom_mask & ABI_TAG_CUSTOM) | (front ? ABI_TAG_FRONT : 0);
    return true;
}

#endif

/* Rays from inside a closed mesh, aimed at its vertices and edges: what the leak counter traces.
 * Not in the table of ray sets, since only closed meshes have an inside. */
#ifndef RAYS_INSIDE_H
#define RAYS_INSIDE_H

#include "ref/judge/leaks.h"
#include "ref/base/rng.h"

#define INSIDE_ORIGINS 64 /* most points inside that rays start from */

/* What was made. */
struct inside {
    size_t origins; /* points inside, 1 to INSIDE_ORIGINS */
    size_t exact;   /* rays whose direction is target - origin without rounding */
    size_t sampled; /* rays not of LEAK_BESIDE that were looked at, evenly spread */
    size_t near;    /* of them, those that exactly meet or pass an edge within 2^-12 barycentric */
};

/* Makes `count` rays with tmin 0 and tmax RAY_TMAX that keep the contract; ray i has the aim aim[i]
 * = i % LEAK_AIMS. Origins are the centre of mass and random points, each found inside by counting:
 * a ray that exactly meets no edge or vertex crosses the closed mesh an odd number of times.
 * `beside` moves the target by extent * 2^-8 to 2^-24. Depends on scene, seed and count only.
 * `topology` is of `scene` and closed (topology_is_closed), `oracle` of `scene`. Errors:
 * STATUS_INPUT no point inside was found in 4096 tries; STATUS_MEMORY. */
enum status rays_inside_make(const struct scene *scene, const struct topology *topology,
                             const struct oracle *oracle, uint64_t seed, size_t count,
                             struct ray *out, uint8_t *aim, struct inside *inside,
                             struct reason *reason) MUST_USE;

/* True if `point` lies strictly inside: off the surface, and rays from it cross the mesh an odd
 * number of times. False also if no generic direction was found. Errors: STATUS_MEMORY. */
enum status point_is_inside(const struct oracle *oracle, const float point[3], struct rng *rng,
                            bool *inside, struct reason *reason) MUST_USE;

#endif

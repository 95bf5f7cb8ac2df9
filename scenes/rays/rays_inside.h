/* Rays from inside a closed mesh, aimed at its vertices and edges, for the leak counter. Not in the
 * table of ray sets, since only closed meshes have an inside. */
#ifndef RAYS_INSIDE_H
#define RAYS_INSIDE_H

#include "ref/judge/leaks.h"
#include "ref/base/rng.h"

#define INSIDE_ORIGINS 64 /* most origins */

/* Counts of the rays made. */
struct inside {
    size_t origins; /* origins inside the mesh, 1 to INSIDE_ORIGINS */
    size_t exact;   /* rays whose direction is target - origin without rounding */
    size_t sampled; /* rays checked, evenly spread, without those of LEAK_BESIDE */
    size_t near;    /* of the sampled: meet an edge exactly or pass it within 2^-12 barycentric */
};

/* Makes `count` rays with tmin 0 and tmax RAY_TMAX that keep the contract; ray i has the aim aim[i]
 * = i % LEAK_AIMS. Origins are the centre of mass and random points. Each is found to be inside by
 * counting: a ray that exactly meets no edge or vertex crosses the closed mesh an odd number of
 * times. LEAK_BESIDE moves the target by extent * 2^-8 to 2^-24. The rays depend on scene, seed and
 * count only.
 * `topology` is that of `scene` and closed (topology_is_closed), `oracle` that of `scene`. Errors:
 * STATUS_INPUT no point inside was found in 4096 tries; STATUS_MEMORY. */
enum status rays_inside_make(const struct scene *scene, const struct topology *topology,
                             const struct oracle *oracle, uint64_t seed, size_t count,
                             struct ray *out, uint8_t *aim, struct inside *inside,
                             struct reason *reason) MUST_USE;

/* Sets *inside if `point` lies strictly inside: not on the surface, and rays from it cross the mesh
 * an odd number of times. Also false if no generic direction was found. Errors: STATUS_MEMORY. */
enum status point_is_inside(const struct oracle *oracle, const float point[3], struct rng *rng,
                            bool *inside, struct reason *reason) MUST_USE;

#endif

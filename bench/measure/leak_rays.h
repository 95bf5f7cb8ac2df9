/* Rays from inside a closed mesh, aimed exactly at its edges and vertices. Each of them hits, so a
 * miss is a leak. */
#ifndef LEAK_RAYS_H
#define LEAK_RAYS_H

#include "ref/oracle/oracle.h"

enum leak_target { LEAK_EDGE, LEAK_VERTEX };

/* Makes `count` seeded rays from up to LEAK_ORIGINS points inside. An origin is inside if a ray
 * from it crosses the mesh an odd number of times, always through interiors of triangles, decided
 * exactly. Targets are vertices, or the float32 points nearest to points of edges, a quarter of
 * which are midpoints. Directions are target - origin, rounded. Errors: STATUS_INPUT the mesh is
 * not closed (names the edge), or no point inside was found; STATUS_MEMORY. */
#define LEAK_ORIGINS 64
enum status leak_rays_make(const struct oracle *oracle, const struct scene *scene,
                           enum leak_target target, uint64_t seed, size_t count, struct ray *out,
                           struct reason *reason) MUST_USE;

#endif

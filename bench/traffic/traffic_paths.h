/* Paths of rays, and what engine cpu answers to them. */
#ifndef TRAFFIC_PATHS_H
#define TRAFFIC_PATHS_H

#include "ref/engine.h"

#define TRAFFIC_DEPTH_MOST 64

/* Rays of one depth. */
struct traffic_wave {
    size_t count;
    struct ray *ray;
    struct hit *hit;
    uint32_t *path; /* which path each ray belongs to; ascending */
};

/* Owns its arrays: free with traffic_paths_free. */
struct traffic_paths {
    uint32_t depth; /* waves; a wave without rays ends the paths */
    struct traffic_wave wave[TRAFFIC_DEPTH_MOST];
};

/* Makes `count` paths of up to `depth` rays. The first are camera rays, in scanlines; each next one
 * leaves the hit of the one before it, as in bench/measure/bounce_rays.h; a path ends where its ray
 * hits nothing. Hits are those of trace_ray for `job`, nearest. Depth d of more paths begins as
 * depth d of fewer. Errors: STATUS_INPUT no camera ray hits the scene; STATUS_MEMORY, before
 * anything is traced where it is known; those of trace_ray. */
enum status traffic_paths_make(const struct job *job, uint64_t seed, size_t count, uint32_t depth,
                               struct traffic_paths *out, struct reason *reason) MUST_USE;

/* Bytes that traffic_paths_make may need. */
uint64_t traffic_paths_bytes(size_t count, uint32_t depth);

/* Replaces the hits by those of another tree. Errors: STATUS_LIMIT. */
enum status traffic_paths_trace(struct traffic_paths *paths, const struct job *job,
                                struct reason *reason) MUST_USE;

void traffic_paths_free(struct traffic_paths *paths);

#endif

/* Embree 3 or 4: the engine functions (ref/engine.h) that all its modes share. Without Embree
 * (embree_none.c) opening fails with STATUS_UNSUPPORTED. */
#ifndef EMBREE_DEVICE_H
#define EMBREE_DEVICE_H

#include "ref/engine.h"

enum embree_mode {
    EMBREE_DEFAULT,
    EMBREE_ROBUST,  /* RTC_SCENE_FLAG_ROBUST */
    EMBREE_PACKETS, /* default, in packets of 16 rays */
    EMBREE_HIGH     /* default, RTC_BUILD_QUALITY_HIGH */
};

enum status embree_open_mode(const struct engine_options *options, enum embree_mode mode,
                             void **self, struct reason *reason) MUST_USE;
enum status embree_prepare(void *self, const struct job *job, struct reason *reason) MUST_USE;
enum status embree_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason) MUST_USE;
enum status embree_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason) MUST_USE;
void embree_close(void *self);

/* Worlds, for EMBREE_DEFAULT and EMBREE_ROBUST. Embree has no custom indices: those of the tags
 * come from the world. What QUERY_ANY and ABI_RAY_FIRST find is not named: triangle 0 at t = 0 with
 * tag 0. A ray that Embree may abort on in the space of some meshes does not meet their instances;
 * where the library was built without masks of rays, it meets nothing. prepare_world returns also
 * STATUS_UNSUPPORTED: Embree may abort on every ray through a transform (the instance), unless
 * `unguarded`. */
extern const struct world_tracer embree_worlds;

void embree_describe(const struct engine_options *options, char *text, size_t text_bytes);

#endif

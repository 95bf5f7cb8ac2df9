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
void embree_describe(const struct engine_options *options, char *text, size_t text_bytes);

#endif

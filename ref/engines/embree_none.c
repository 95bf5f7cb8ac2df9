/* The functions of embree_device.h in a build without Embree. */
#include "ref/engines/embree_device.h"

#if !HAVE_EMBREE

#include <stdio.h>

enum status embree_open_mode(const struct engine_options *options, const struct embree_mode *mode,
                             void **self, struct reason *reason)
{
    (void)options, (void)mode;
    *self = NULL;
    return fail(reason, STATUS_UNSUPPORTED,
                "built without Embree: install libembree-dev and build again");
}

enum status embree_isa_check(enum embree_isa isa, struct reason *reason)
{
    void *self;
    return isa == EMBREE_ISA_OWN ? STATUS_OK : embree_open_mode(NULL, NULL, &self, reason);
}

enum status embree_prepare(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)job;
    return embree_open_mode(NULL, NULL, &self, reason);
}

enum status embree_move(void *self, const struct job *job, struct reason *reason)
{
    return embree_prepare(self, job, reason);
}

enum status embree_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    (void)ray, (void)ray_count, (void)hit, (void)report;
    return embree_open_mode(NULL, NULL, &self, reason);
}

enum status embree_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    (void)ray, (void)ray_count, (void)capacity, (void)hit, (void)hit_count;
    return embree_open_mode(NULL, NULL, &self, reason);
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    (void)job;
    return embree_open_mode(NULL, NULL, &self, reason);
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    (void)ray, (void)mode, (void)ray_count, (void)hit, (void)tag, (void)report;
    return embree_open_mode(NULL, NULL, &self, reason);
}

const struct world_tracer embree_worlds = {.prepare_world = prepare_world,
                                           .trace_world = trace_world};

void embree_close(void *self)
{
    (void)self;
}

void embree_describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, "built without Embree: install libembree-dev and build again");
}

#endif

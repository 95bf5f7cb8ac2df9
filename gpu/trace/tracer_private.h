/* Shared by tracer.c and tracer_tasks.c; private to them. */
#ifndef TRACER_PRIVATE_H
#define TRACER_PRIVATE_H

#include "gpu/trace/dispatch.h"
#include "gpu/shaders/pipelines.h"
#include "gpu/trace/tracer.h"

/* The most node visits of one submission, so that neither a wait nor a driver's watchdog ends
 * it. */
#define TRACER_VISITS_MOST (1u << 25)
#define TRACER_RAYS_MOST   (1u << 20) /* of one dispatch */

struct tracer {
    struct vk *vk;
    uint32_t workgroup;
    struct pipelines pipelines;
    struct vk_pipeline *pipeline; /* for the job; borrowed */
    struct vk_buffer *buffer[DISPATCH_BINDINGS];
    uint32_t *flag; /* room for the flags of ray_capacity rays */
    uint32_t ray_capacity, batch;
    uint32_t trouble; /* flags of the first ray that was not finished */
    bool unfinished;  /* the last call ended with such a ray */
    bool lists;       /* prepared for QUERY_ALL */
    struct push push;
    struct arithmetic arithmetic;
    bool measured;
    struct tracer_tasks *tasks; /* kept by tracer_trace_tasks, or NULL */
};

/* Finds or makes the pipeline of the dispatch. Errors: as vk_pipeline_make. */
enum status tracer_pipeline(struct tracer *tracer, const struct dispatch *dispatch,
                            struct vk_pipeline **out, struct reason *reason) MUST_USE;

void tracer_tasks_free(struct tracer *tracer);

#endif

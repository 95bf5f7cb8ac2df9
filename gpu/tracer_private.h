/* What tracer.c and tracer_tasks.c share; nobody else includes it. */
#ifndef TRACER_PRIVATE_H
#define TRACER_PRIVATE_H

#include "gpu/shaders.h"
#include "gpu/tracer.h"

#define TRACER_BINDINGS  7u
#define TRACER_CONSTANTS 5u

/* Node visits of one submission, at most: neither a wait nor a driver's watchdog ends it. */
#define TRACER_VISITS_MOST (1u << 25)
#define TRACER_RAYS_MOST   (1u << 20) /* of one dispatch */

_Static_assert(ABI_BIND_FOUND == TRACER_BINDINGS - 1, "the tracing shaders have bindings 0 to 6");
_Static_assert(ABI_SPEC_STACK == TRACER_CONSTANTS - 1, "the tracing shaders have constants 0 to 4");

struct cached {
    const struct shader *shader;
    uint32_t constant[TRACER_CONSTANTS];
    struct vk_pipeline *pipeline;
};

struct tracer {
    struct vk *vk;
    uint32_t workgroup;
    struct cached *cache;
    size_t cache_count, cache_capacity;
    struct vk_pipeline *pipeline; /* of the job; borrowed from the cache */
    struct vk_buffer *buffer[TRACER_BINDINGS];
    uint32_t *flag; /* ray_capacity read back */
    uint32_t ray_capacity, batch;
    uint32_t trouble; /* flags of the first ray that was not finished */
    bool lists;       /* prepared for QUERY_ALL */
    struct push push;
    struct arithmetic arithmetic;
    bool measured;
    struct tracer_tasks *tasks; /* what tracer_trace_tasks keeps, or NULL */
};

/* Finds or makes the pipeline of the job; kept in the cache. Errors: as tracer_prepare. */
enum status tracer_pipeline(struct tracer *tracer, const struct job *job, uint32_t stack,
                            struct vk_pipeline **out, struct reason *reason) MUST_USE;

/* The smallest stack class that is enough: a larger private array costs every ray. Errors:
 * STATUS_LIMIT deeper than all. */
enum status tracer_stack(const struct packed *packed, uint32_t *out,
                         struct reason *reason) MUST_USE;

/* What the shaders are told of a job, ray_count left out. */
struct push tracer_push(const struct job *job);

/* What kept a ray from its end, by its flags. */
const char *tracer_cause(uint32_t flag);

void tracer_tasks_free(struct tracer *tracer);

#endif

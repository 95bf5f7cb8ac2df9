/* Traces rays on a Vulkan device: uploads a packed tree, selects the pipeline and traces in
 * batches. Used by engine `vulkan`, and by tests with options that no command has. */
#ifndef TRACER_H
#define TRACER_H

#include "gpu/card/probe.h"
#include "ref/engine.h"

struct tracer;

/* Opens a device. `workgroup` 0: ABI_WORKGROUP. *out is NULL on error.
 * Errors: as vk_open; STATUS_UNSUPPORTED workgroup over the device's limit. */
enum status tracer_open(const struct vk_options *options, uint32_t workgroup, struct tracer **out,
                        struct reason *reason) MUST_USE;

/* As engine.prepare; job->packed must be set. Pipelines are kept from job to job.
 * Errors: STATUS_LIMIT stack_need over layout_stack_most, or a buffer over the device's limits;
 * STATUS_UNSUPPORTED no shader for the layout; STATUS_DEVICE; STATUS_MEMORY. */
enum status tracer_prepare(struct tracer *tracer, const struct job *job,
                           struct reason *reason) MUST_USE;

/* As engine.move: writes nodes, items and triangles into the buffers of the last job. Errors: as
 * tracer_prepare. */
enum status tracer_move(struct tracer *tracer, const struct job *job,
                        struct reason *reason) MUST_USE;

/* As engine.trace. Errors: STATUS_DEVICE not prepared or for another query, lost, hung, a ray that
 * was not finished, or validation messages since open (the reason has the first); STATUS_MEMORY. */
enum status tracer_trace(struct tracer *tracer, const struct ray *ray, size_t ray_count,
                         struct hit *hit, struct trace_report *report,
                         struct reason *reason) MUST_USE;

/* As engine.trace_tasks. All tasks are traced in few submissions; each shader sees only its own
 * parts of the buffers. Errors: as engine.trace_tasks; STATUS_DEVICE validation messages since
 * open. */
enum status tracer_trace_tasks(struct tracer *tracer, struct engine_task *task, size_t count,
                               struct reason *reason) MUST_USE;

/* As engine.trace_all, for a job prepared with QUERY_ALL; hits of a ray come in the order of
 * trace_ray_all. Errors: as tracer_trace; STATUS_LIMIT one ray's capacity is over the device's
 * buffers. */
enum status tracer_trace_all(struct tracer *tracer, const struct ray *ray, size_t ray_count,
                             uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                             struct reason *reason) MUST_USE;

/* Returns vk_close's count of validation messages, including those about leaks. NULL is fine. */
uint32_t tracer_close(struct tracer *tracer, struct reason *reason);

/* Returns the device's arithmetic, which the first call measures. */
struct arithmetic tracer_arithmetic(struct tracer *tracer);

/* Returns the device, for other work on it before tracer_close. */
struct vk *tracer_device(struct tracer *tracer);

/* Returns the number of pipelines made since open. */
uint32_t tracer_pipelines(const struct tracer *tracer);

#endif

/* Traces rays through worlds on a Vulkan device: by the shaders world_LAYOUT, for engine `vulkan`;
 * by query_world, for engine `rayquery`; or by world_brute, for engine `vulkan_brute`. */
#ifndef WORLD_RUNNER_H
#define WORLD_RUNNER_H

#include "gpu/vk/vk.h"
#include "ref/engine.h"

struct vk_accel;
struct world_runner;

/* Makes one on an open device, which is borrowed. NULL: no memory. */
struct world_runner *world_runner_make(struct vk *vk, uint32_t workgroup);

/* Frees it, before the device is closed. NULL is fine. */
void world_runner_free(struct world_runner *runner);

/* As world_tracer.prepare_world (ref/engine.h); job->packed must be set. Pipelines are kept.
 * Errors: STATUS_UNSUPPORTED top and meshes in different layouts, a triangle test that the storage
 * does not have, no shader for the layout; STATUS_LIMIT stack_need over layout_stack_most, or a
 * buffer over the device's limits; STATUS_DEVICE; STATUS_MEMORY. */
enum status world_runner_prepare(struct world_runner *runner, const struct world_job *job,
                                 struct reason *reason) MUST_USE;

/* As world_tracer.move_world: writes into the buffers of the last job, which stay where they are.
 * Errors: as world_runner_prepare. */
enum status world_runner_move(struct world_runner *runner, const struct world_job *job,
                              struct reason *reason) MUST_USE;

/* As world_runner_prepare for the driver's own trees, `accel`, made of job->world on a device with
 * ray queries; of the job only world and query are used. Errors: STATUS_LIMIT a buffer over the
 * device's limits; STATUS_UNSUPPORTED as vk_pipeline_make; STATUS_DEVICE; STATUS_MEMORY. */
enum status world_runner_prepare_query(struct world_runner *runner, const struct world_job *job,
                                       const struct vk_accel *accel,
                                       struct reason *reason) MUST_USE;

/* As world_runner_prepare without trees: every triangle of every instance is tested, to the bits of
 * engine brute. The world is read again when rays are traced. Errors: STATUS_LIMIT the inverse of a
 * transform is beyond float32, or a buffer over the device's limits; STATUS_DEVICE;
 * STATUS_MEMORY. */
enum status world_runner_prepare_brute(struct world_runner *runner, const struct world_job *job,
                                       struct reason *reason) MUST_USE;

/* As trace_world and trace_world_all; `hit_count` NULL: the former, of capacity 1. Errors:
 * STATUS_DEVICE not prepared, or for another query, lost, hung, a ray that was not finished, or
 * validation messages since open; STATUS_LIMIT one ray's capacity is over the device's buffers;
 * STATUS_MEMORY. */
enum status world_runner_trace(struct world_runner *runner, const struct ray *ray,
                               const struct ray_mode *mode, size_t ray_count, uint32_t capacity,
                               struct hit *hit, uint32_t *tag, uint32_t *hit_count,
                               struct trace_report *report, struct reason *reason) MUST_USE;

#endif

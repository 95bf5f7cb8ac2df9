/* Renders frames on a Vulkan device, for engines `vulkan` and `vulkan_brute`. */
#ifndef FRAMER_H
#define FRAMER_H

#include "gpu/vk/vk.h"
#include "ref/frame.h"

struct framer;

/* `vk` is borrowed. `brute`: tests every triangle; job.packed is not needed. Returns NULL without
 * memory. */
struct framer *framer_make(struct vk *vk, bool brute);
void framer_free(struct framer *framer); /* call before closing its device; NULL is fine */

/* As frame_renderer.prepare. Pipelines are made with the first frame that needs them and kept from
 * job to job. Errors: STATUS_LIMIT no pipeline for so deep a stack, so many lights or bounces, or a
 * buffer over the device's limits; STATUS_UNSUPPORTED no shader for the layout, or tiles over the
 * device's limit; STATUS_DEVICE; STATUS_MEMORY. */
enum status framer_prepare(struct framer *framer, const struct frame_job *job,
                           struct reason *reason) MUST_USE;

/* As frame_renderer.draw. Errors: STATUS_DEVICE not prepared, lost, hung, a path that was not
 * finished (the reason names its pixel and the cause), or validation messages since open;
 * STATUS_LIMIT a row of tiles needs more than the device's buffers; STATUS_UNSUPPORTED as
 * vk_pipeline_make; STATUS_MEMORY. */
enum status framer_draw(struct framer *framer, const struct view *view, struct frame *out,
                        struct trace_report *report, struct reason *reason) MUST_USE;

/* Return how the last frame was drawn, FRAME_WHOLE or FRAME_STEPS, and the number of pipelines made
 * so far. */
enum frame_plan framer_plan(const struct framer *framer);
uint32_t framer_pipelines(const struct framer *framer);

#endif

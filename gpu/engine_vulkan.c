/* Engine `vulkan`: the shaders of shaders/trace_<layout>.comp on any Vulkan 1.1 device. */
#include "gpu/vulkan_options.h"
#include "gpu/tracer.h"
#include "ref/twin.h"

static enum status open(const struct engine_options *options, void **self, struct reason *reason)
{
    struct vk_options vk_options = vulkan_options(options);
    struct tracer *tracer;
    enum status status = tracer_open(&vk_options, options->workgroup, &tracer, reason);
    *self = tracer;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    return tracer_prepare(self, job, reason);
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    return tracer_trace(self, ray, ray_count, hit, report, reason);
}

static enum status trace_tasks(void *self, struct engine_task *task, size_t count,
                               struct reason *reason)
{
    return tracer_trace_tasks(self, task, count, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    return tracer_trace_all(self, ray, ray_count, capacity, hit, hit_count, reason);
}

static struct model model(void *self, const struct tri_test *tri)
{
    struct arithmetic arithmetic = tracer_arithmetic(self);
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = arithmetic.rounding,
                          .bits = arithmetic.bits,
                          .watertight = tri->watertight && rounding_is_nearest(arithmetic.rounding),
                          .open = tri->open};
}

static void close(void *self)
{
    (void)tracer_close(self, NULL);
}

extern const struct engine engine_vulkan;
const struct engine engine_vulkan = {
    .name = "vulkan",
    .summary = "compute shaders on a Vulkan device, one per layout",
    .needs_packed = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_tasks = trace_tasks,
    .trace_all = trace_all,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

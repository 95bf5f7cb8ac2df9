/* Engine `vulkan_stackless`: the tracing shaders of binary layouts without a stack, by parent links
 * and a trail of bits (shaders/walk_stackless.glsl). Rendering is done ray by ray. */
#include "gpu/trace/tracer.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/packed/packed_walk.h"
#include "ref/twin/twin.h"

#include <stdlib.h>

static void close(void *self)
{
    (void)tracer_close(self, NULL);
}

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    struct vk_options vk_options = vulkan_options(options);
    struct tracer *tracer;
    enum status status = tracer_open(&vk_options, options->workgroup, &tracer, reason);
    *self = tracer;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct job linked = *job;
    uint32_t *parent;
    enum status status = packed_links(job->packed, &parent, reason);
    if (status)
        return status;
    uint32_t none = ABI_NO_PRIM; /* an empty tree has no links, but needs a pointer */
    linked.parent = parent ? parent : &none;
    status = tracer_prepare(self, &linked, reason);
    free(parent);
    return status;
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    return tracer_trace(self, ray, ray_count, hit, report, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    return tracer_trace_all(self, ray, ray_count, capacity, hit, hit_count, reason);
}

static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine;
    struct arithmetic arithmetic = tracer_arithmetic(self);
    return model_of_tri(tri, arithmetic.rounding, arithmetic.bits);
}

extern const struct engine engine_vulkan_stackless;
const struct engine engine_vulkan_stackless = {
    .name = "vulkan_stackless",
    .gpu = true,
    .summary = "the shaders of binary layouts with parent links and a bit trail",
    .needs_packed = true,
    .compiles = true,
    .binary = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

/* Engine `vulkan`: the shaders of shaders/trace_<layout>.comp on any Vulkan 1.1 device.
 * Environment: RAYDIFF_VALIDATE=1 runs under the validation layer and fails on its messages;
 * RAYDIFF_VULKAN_LIBRARY names another loader than libvulkan.so.1. */
#include "gpu/probe.h"
#include "gpu/tracer.h"
#include "ref/twin.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct vk_options options_of(const struct engine_options *options)
{
    const char *validate = getenv("RAYDIFF_VALIDATE");
    return (struct vk_options){
        .library = getenv("RAYDIFF_VULKAN_LIBRARY"),
        .driver = options->driver,
        .device = options->device,
        .validate = validate && strcmp(validate, "1") == 0,
    };
}

static enum status open(const struct engine_options *options, void **self, struct reason *reason)
{
    struct vk_options vk_options = options_of(options);
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

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    return tracer_trace_all(self, ray, ray_count, capacity, hit, hit_count, reason);
}

static struct model model(void *self, const struct tri_test *tri)
{
    (void)self;
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = ROUNDING_IEEE,
                          .bits = true,
                          .watertight = tri->watertight,
                          .open = tri->open};
}

static void close(void *self)
{
    (void)tracer_close(self, NULL);
}

/* What the chosen device computes, after the list of all devices. */
static void describe_arithmetic(const struct vk_options *options, char *text, size_t text_bytes)
{
    struct vk *vk;
    struct probe_op op[PROBE_OPS];
    struct reason reason;
    if (vk_open(options, &vk, &reason))
        return; /* the list says why */
    int used = snprintf(text, text_bytes, "arithmetic of %s, ", vk_limits(vk)->device);
    if (used > 0 && (size_t)used < text_bytes) {
        if (probe_run(vk, op, &reason))
            (void)snprintf(text + used, text_bytes - (size_t)used, "unknown: %s\n", reason.text);
        else
            probe_text(op, text + used, text_bytes - (size_t)used);
    }
    (void)vk_close(vk, NULL);
}

static void describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    struct vk_options vk_options = options_of(options);
    vk_describe(&vk_options, text, text_bytes);
    size_t used = strlen(text);
    describe_arithmetic(&vk_options, text + used, text_bytes - used);
}

extern const struct engine engine_vulkan;
const struct engine engine_vulkan = {
    .name = "vulkan",
    .summary = "compute shaders on a Vulkan device, one per layout",
    .needs_packed = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .model = model,
    .close = close,
    .describe = describe,
};

/* Engine `vulkan`: traces and renders with the shaders of shaders/layouts/layout_<layout>.glsl, on
 * any Vulkan 1.1 device. */
#include "gpu/frame/framer.h"
#include "gpu/trace/tracer.h"
#include "gpu/trace/vulkan_options.h"
#include "gpu/trace/world_runner.h"
#include "ref/twin/twin.h"

#include <stdlib.h>

struct vulkan {
    struct tracer *tracer;
    struct framer *framer;       /* NULL until a frame is prepared */
    struct world_runner *worlds; /* NULL until a world is */
    uint32_t workgroup;
};

static void close(void *self)
{
    struct vulkan *v = self;
    if (!v)
        return;
    framer_free(v->framer);
    world_runner_free(v->worlds);
    (void)tracer_close(v->tracer, NULL);
    free(v);
}

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    struct vk_options vk_options = vulkan_options(options);
    struct vulkan *v = alloc_zeroed(1, sizeof *v);
    *self = v;
    if (!v)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    v->workgroup = options->workgroup;
    enum status status = tracer_open(&vk_options, options->workgroup, &v->tracer, reason);
    if (status) {
        close(v);
        *self = NULL;
    }
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    return tracer_prepare(((struct vulkan *)self)->tracer, job, reason);
}

static enum status move(void *self, const struct job *job, struct reason *reason)
{
    return tracer_move(((struct vulkan *)self)->tracer, job, reason);
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    return tracer_trace(((struct vulkan *)self)->tracer, ray, ray_count, hit, report, reason);
}

static enum status trace_tasks(void *self, struct engine_task *task, size_t count,
                               struct reason *reason)
{
    return tracer_trace_tasks(((struct vulkan *)self)->tracer, task, count, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    return tracer_trace_all(((struct vulkan *)self)->tracer, ray, ray_count, capacity, hit,
                            hit_count, reason);
}

static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine;
    struct arithmetic arithmetic = tracer_arithmetic(((struct vulkan *)self)->tracer);
    return model_of_tri(tri, arithmetic.rounding, arithmetic.bits);
}

static enum status frame_prepare(void *self, const struct frame_job *job, struct reason *reason)
{
    struct vulkan *v = self;
    if (!v->framer)
        v->framer = framer_make(tracer_device(v->tracer), false);
    if (!v->framer)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    return framer_prepare(v->framer, job, reason);
}

static enum status frame(void *self, const struct view *view, struct frame *out,
                         struct trace_report *report, struct reason *reason)
{
    return framer_draw(((struct vulkan *)self)->framer, view, out, report, reason);
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct vulkan *v = self;
    if (!v->worlds)
        v->worlds = world_runner_make(tracer_device(v->tracer), v->workgroup);
    if (!v->worlds)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    return world_runner_prepare(v->worlds, job, reason);
}

static enum status move_world(void *self, const struct world_job *job, struct reason *reason)
{
    return world_runner_move(((struct vulkan *)self)->worlds, job, reason);
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    return world_runner_trace(((struct vulkan *)self)->worlds, ray, mode, ray_count, 1, hit, tag,
                              NULL, report, reason);
}

static enum status trace_world_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    struct trace_report unused;
    return world_runner_trace(((struct vulkan *)self)->worlds, ray, mode, ray_count, capacity, hit,
                              tag, hit_count, &unused, reason);
}

static const struct world_tracer worlds = {
    .prepare_world = prepare_world,
    .move_world = move_world,
    .trace_world = trace_world,
    .trace_world_all = trace_world_all,
};

extern const struct engine engine_vulkan;
static const struct frame_renderer renderer = {.prepare = frame_prepare, .draw = frame};

const struct engine engine_vulkan = {
    .name = "vulkan",
    .gpu = true,
    .summary = "compute shaders on a Vulkan device, one per layout",
    .needs_packed = true,
    .compiles = true,
    .open = open,
    .prepare = prepare,
    .move = move,
    .trace = trace,
    .trace_tasks = trace_tasks,
    .trace_all = trace_all,
    .worlds = &worlds,
    .renderer = &renderer,
    .model = model,
    .close = close,
    .describe = vulkan_describe,
};

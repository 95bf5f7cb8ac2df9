/* Engine `rayquery`: the driver's own tree and triangle test (VK_KHR_ray_query), where available.
 * Its formula is unknown, so the judge checks geometry only. The job's box and triangle test are
 * not used. */
#include "gpu/trace/batch.h"
#include "gpu/trace/dispatch.h"
#include "ref/base/text.h"
#include "gpu/vk/vk_accel.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

#define QUERIES 3u

struct rayquery {
    struct batch_engine base;
    struct vk_pipeline *pipeline[QUERIES];
    struct vk_accel *accel; /* NULL: no triangles */
};

_Static_assert(ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct rayquery *r = self;
    if (!r)
        return;
    for (uint32_t q = 0; q < QUERIES && r->base.vk; q++)
        vk_pipeline_free(r->base.vk, r->pipeline[q]);
    if (r->base.vk)
        vk_accel_free(r->base.vk, r->accel);
    (void)vk_close(r->base.vk, NULL);
    free(r);
}

static uint64_t most(const struct batch_engine *engine)
{
    (void)engine;
    return UINT64_MAX;
}

static enum status answer(struct batch_engine *engine, struct batch *batch, const struct ray *ray,
                          size_t first, uint32_t count, const struct batch_answers *to,
                          struct trace_report *report, struct reason *reason)
{
    const struct push push = {.ray_count = count, .capacity = batch->capacity};
    struct vk_buffer *const buffer[BATCH_BINDINGS] = {
        [ABI_BIND_RAYS] = batch->rays,      [ABI_BIND_HITS] = batch->hits[0],
        [ABI_BIND_FLAGS] = batch->flags,    [ABI_BIND_NODES] = batch->none,
        [ABI_BIND_ITEMS] = batch->none,     [ABI_BIND_TRIS] = batch->none,
        [ABI_BIND_FOUND] = batch->found[0],
    };
    struct vk_time time = {0};
    enum status status = batch_rays(batch, ray + first, count, reason);
    if (!status)
        status = batch_run(batch, engine->chosen, buffer, &push, first, &time, reason);
    report->ns += time.ns;
    report->device_clock = report->device_clock && time.device_clock;
    if (status)
        return status;
    return batch_read(batch, 0, 0, count, to->hit + first * batch->capacity,
                      to->found ? to->found + first : NULL, reason);
}

static enum status open(const struct engine_options *options, void **self, struct reason *reason)
{
    struct rayquery *r = alloc_zeroed(1, sizeof *r);
    *self = NULL;
    if (!r)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    struct vk_options vk_options = vulkan_options(options);
    vk_options.ray_query = true;
    r->base.most = most;
    r->base.answer = answer;
    r->base.workgroup = options->workgroup ? options->workgroup : ABI_WORKGROUP;
    enum status status = vk_open(&vk_options, &r->base.vk, reason);
    if (status)
        close(r);
    else
        *self = r;
    return status;
}

static enum status make_pipeline(struct rayquery *r, const struct job *job, struct reason *reason)
{
    struct vk_pipeline **pipeline = &r->pipeline[job->query];
    const struct dispatch dispatch = dispatch_query(job, r->base.workgroup);
    const struct vk_shader make = dispatch_shader(&dispatch);
    enum status status =
        *pipeline ? STATUS_OK : vk_pipeline_make(r->base.vk, &make, pipeline, reason);
    r->base.chosen = *pipeline;
    return status;
}

static enum status upload(struct rayquery *r, const void *data, uint64_t bytes,
                          struct vk_buffer **out, struct reason *reason)
{
    enum status status = vk_buffer_make(r->base.vk, bytes, out, reason);
    return status ? status : vk_buffer_write(r->base.vk, *out, 0, data, bytes, reason);
}

static enum status build(struct rayquery *r, const struct scene *scene, struct reason *reason)
{
    struct vk_buffer *vertices = NULL, *indices = NULL;
    enum status status =
        upload(r, scene->vertex, (uint64_t)scene->vertex_count * 12, &vertices, reason);
    if (!status)
        status = upload(r, scene->index, (uint64_t)scene->tri_count * 12, &indices, reason);
    if (!status)
        status = vk_accel_make(r->base.vk, vertices, scene->vertex_count, indices, scene->tri_count,
                               &r->accel, reason);
    vk_buffer_free(r->base.vk, vertices);
    vk_buffer_free(r->base.vk, indices);
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct rayquery *r = self;
    vk_accel_free(r->base.vk, r->accel);
    r->accel = NULL;
    r->base.lists = job->query == QUERY_ALL;
    enum status status = make_pipeline(r, job, reason);
    if (!status && job->scene->tri_count)
        status = build(r, job->scene, reason);
    r->base.empty = !r->accel;
    r->base.bytes = vk_accel_bytes(r->accel);
    if (!status && r->accel)
        vk_pipeline_use(r->base.vk, r->base.chosen, r->accel);
    if (status)
        r->base.chosen = NULL;
    return status;
}

/* Vulkan requires tmin < t < tmax; that closed fans are watertight is only a "should". */
static struct model model(void *self, const struct tri_test *tri)
{
    (void)self;
    (void)tri;
    return (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_VULKAN, .open = true};
}

static void describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    struct vk_options vk_options = vulkan_options(options);
    struct vk *vk;
    struct reason reason;
    text[0] = '\0';
    vk_options.ray_query = true;
    if (vk_open(&vk_options, &vk, &reason)) {
        text_append(text, text_bytes, "%s\n", reason.text);
        return;
    }
    text_append(text, text_bytes, "ray queries of %s (%s)\n", vk_limits(vk)->device,
                vk_limits(vk)->driver);
    (void)vk_close(vk, NULL);
}

extern const struct engine engine_rayquery;
const struct engine engine_rayquery = {
    .name = "rayquery",
    .gpu = true,
    .summary = "the Vulkan driver's own ray queries, where it has them",
    .own_tri = true,
    .open = open,
    .prepare = prepare,
    .trace = batch_trace,
    .trace_all = batch_trace_all,
    .model = model,
    .close = close,
    .describe = describe,
};

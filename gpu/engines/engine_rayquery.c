/* Engine `rayquery`: the driver's own tree and triangle test (VK_KHR_ray_query), where it has
 * them. Nothing is known of its formula, so the judge looks at geometry alone; box and triangle
 * test of the job do not matter. */
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
    struct vk *vk;
    uint32_t workgroup;
    struct vk_pipeline *pipeline[QUERIES];
    struct vk_pipeline *chosen; /* of the job; NULL: none prepared */
    struct vk_accel *accel;     /* NULL: no triangle */
    bool lists;                 /* prepared for QUERY_ALL */
};

/* Where the answers of a call go. */
struct rayquery_answers {
    struct hit *hit;
    uint32_t *found; /* QUERY_ALL, else NULL */
    uint32_t capacity;
};

_Static_assert(ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct rayquery *r = self;
    if (!r)
        return;
    for (uint32_t q = 0; q < QUERIES && r->vk; q++)
        vk_pipeline_free(r->vk, r->pipeline[q]);
    if (r->vk)
        vk_accel_free(r->vk, r->accel);
    (void)vk_close(r->vk, NULL);
    free(r);
}

static enum status open(const struct engine_options *options, void **self, struct reason *reason)
{
    struct rayquery *r = alloc_zeroed(1, sizeof *r);
    *self = NULL;
    if (!r)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    struct vk_options vk_options = vulkan_options(options);
    vk_options.ray_query = true;
    r->workgroup = options->workgroup ? options->workgroup : ABI_WORKGROUP;
    enum status status = vk_open(&vk_options, &r->vk, reason);
    if (status)
        close(r);
    else
        *self = r;
    return status;
}

static enum status make_pipeline(struct rayquery *r, const struct job *job, struct reason *reason)
{
    struct vk_pipeline **pipeline = &r->pipeline[job->query];
    const struct dispatch dispatch = dispatch_query(job, r->workgroup);
    const struct vk_shader make = dispatch_shader(&dispatch);
    enum status status = *pipeline ? STATUS_OK : vk_pipeline_make(r->vk, &make, pipeline, reason);
    r->chosen = *pipeline;
    return status;
}

static enum status upload(struct rayquery *r, const void *data, uint64_t bytes,
                          struct vk_buffer **out, struct reason *reason)
{
    enum status status = vk_buffer_make(r->vk, bytes, out, reason);
    return status ? status : vk_buffer_write(r->vk, *out, 0, data, bytes, reason);
}

static enum status build(struct rayquery *r, const struct scene *scene, struct reason *reason)
{
    struct vk_buffer *vertices = NULL, *indices = NULL;
    enum status status =
        upload(r, scene->vertex, (uint64_t)scene->vertex_count * 12, &vertices, reason);
    if (!status)
        status = upload(r, scene->index, (uint64_t)scene->tri_count * 12, &indices, reason);
    if (!status)
        status = vk_accel_make(r->vk, vertices, scene->vertex_count, indices, scene->tri_count,
                               &r->accel, reason);
    vk_buffer_free(r->vk, vertices);
    vk_buffer_free(r->vk, indices);
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct rayquery *r = self;
    vk_accel_free(r->vk, r->accel);
    r->accel = NULL;
    r->lists = job->query == QUERY_ALL;
    enum status status = make_pipeline(r, job, reason);
    if (!status && job->scene->tri_count)
        status = build(r, job->scene, reason);
    if (!status && r->accel)
        vk_pipeline_use(r->vk, r->chosen, r->accel);
    if (status)
        r->chosen = NULL;
    return status;
}

static enum status trace_batch(struct rayquery *r, struct batch *batch, const struct ray *ray,
                               size_t first, uint32_t count, const struct rayquery_answers *to,
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
        status = batch_run(batch, r->chosen, buffer, &push, first, &time, reason);
    report->ns += time.ns;
    report->device_clock = report->device_clock && time.device_clock;
    if (status)
        return status;
    return batch_read(batch, 0, 0, count, to->hit + first * batch->capacity,
                      to->found ? to->found + first : NULL, reason);
}

static void answer_nothing(const struct rayquery_answers *to, size_t ray_count)
{
    for (size_t i = 0; i < ray_count; i++) {
        if (to->found)
            to->found[i] = 0;
        else
            to->hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    }
}

static enum status trace_rays(struct rayquery *r, const struct ray *ray, size_t ray_count,
                              const struct rayquery_answers *to, struct trace_report *report,
                              struct reason *reason)
{
    *report = (struct trace_report){.device_clock = true};
    if (!r->chosen || r->lists != (to->found != NULL))
        return fail(reason, STATUS_DEVICE, "vulkan: not prepared for this query");
    if (!r->accel || !ray_count) {
        answer_nothing(to, ray_count);
        return STATUS_OK;
    }
    struct batch batch;
    enum status status =
        batch_make(r->vk, r->workgroup, ray_count, r->lists, to->capacity, false, &batch, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint32_t part = ray_count - done < batch.most ? (uint32_t)(ray_count - done) : batch.most;
        status = trace_batch(r, &batch, ray, done, part, to, report, reason);
        done += part;
    }
    report->memory_bytes = vk_accel_bytes(r->accel) + batch_bytes(&batch);
    batch_free(&batch);
    if (!status && vk_messages(r->vk, reason))
        status = STATUS_DEVICE;
    return status;
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    const struct rayquery_answers to = {hit, NULL, 1};
    return trace_rays(self, ray, ray_count, &to, report, reason);
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    const struct rayquery_answers to = {hit, hit_count, capacity};
    struct trace_report unused;
    return trace_rays(self, ray, ray_count, &to, &unused, reason);
}

/* Vulkan asks for tmin < t < tmax; that closed fans are watertight is a "should". */
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
    .trace = trace,
    .trace_all = trace_all,
    .model = model,
    .close = close,
    .describe = describe,
};

/* Engine `rayquery`: the driver's own tree and triangle test (VK_KHR_ray_query), where available.
 * Its formula is unknown, so the judge checks geometry only. The job's box and triangle test are
 * not used. */
#include "gpu/accel/accel_format.h"
#include "gpu/accel/accel_input.h"
#include "gpu/accel/accel_variant.h"
#include "gpu/engines/rayquery_build.h"
#include "gpu/trace/batch.h"
#include "gpu/trace/dispatch.h"
#include "ref/base/text.h"
#include "gpu/vk/vk_accel.h"
#include "gpu/trace/vulkan_options.h"
#include "gpu/trace/world_runner.h"
#include "ref/twin/model.h"
#include "ref/world/world.h"

#include <stdlib.h>
#include <string.h>

#define QUERIES 3u

struct rayquery {
    struct batch_engine base;
    struct vk_pipeline *pipeline[QUERIES];
    struct vk_accel *accel; /* of the scene or world; NULL: none, or a scene without triangles */
    struct world_runner *worlds; /* NULL until a world is prepared */
    struct accel_variant variant;
    struct vk_options options; /* of the device */
    struct world alone;        /* the scene as a world, if a variant makes one of it */
    struct rayquery_past past; /* the last scene or world, if the variant has an update */
    bool runs;                 /* the scene is traced by the runner of worlds */
};

_Static_assert(ABI_QUERY_ALL < QUERIES, "a pipeline each");

/* Frees what was prepared. */
static void forget(struct rayquery *r)
{
    if (r->base.vk)
        vk_accel_free(r->base.vk, r->accel);
    r->accel = NULL;
    r->runs = false;
    world_free(&r->alone);
}

static void close(void *self)
{
    struct rayquery *r = self;
    if (!r)
        return;
    for (uint32_t q = 0; q < QUERIES && r->base.vk; q++)
        vk_pipeline_free(r->base.vk, r->pipeline[q]);
    world_runner_free(r->worlds);
    forget(r);
    rayquery_forget(&r->past);
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

/* What a variant needs of the device. */
static enum status check_variant(struct rayquery *r, struct reason *reason)
{
    const struct accel_format_facts *format = &accel_format[r->variant.format];
    if (r->variant.index == ACCEL_U8)
        return fail(reason, STATUS_UNSUPPORTED,
                    "vulkan: acceleration structures have no 8-bit indices "
                    "(VUID-VkAccelerationStructureGeometryTrianglesDataKHR-indexType-03798)");
    if (r->variant.format == ACCEL_F32X3 || vk_accel_takes_format(r->base.vk, format->vk_format))
        return STATUS_OK;
    return fail(reason, STATUS_UNSUPPORTED,
                "vulkan: %s takes no vertices of VK_FORMAT_%s in acceleration structures",
                vk_limits(r->base.vk)->device, format->vulkan);
}

enum status rayquery_open(const struct engine_options *options, const struct accel_variant *variant,
                          void **self, struct reason *reason)
{
    struct rayquery *r = alloc_zeroed(1, sizeof *r);
    *self = NULL;
    if (!r)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    r->variant = *variant;
    r->options = vulkan_options(options);
    r->options.ray_query = true;
    if (!rayquery_is_plain(variant))
        r->options.ray_more = vk_accel_needs(&variant->how);
    r->base.most = most;
    r->base.answer = answer;
    r->base.workgroup = options->workgroup ? options->workgroup : ABI_WORKGROUP;
    enum status status = vk_open(&r->options, &r->base.vk, reason);
    if (!status)
        status = check_variant(r, reason);
    if (status)
        close(r);
    else
        *self = r;
    return status;
}

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    static const struct accel_variant plain = {.split = 0};
    return rayquery_open(options, &plain, self, reason);
}

static enum status make_pipeline(struct rayquery *r, const struct job *job, struct reason *reason)
{
    struct vk_pipeline **pipeline = &r->pipeline[job->query];
    const struct dispatch dispatch = dispatch_query(job, r->base.workgroup);
    struct vk_shader make = dispatch_shader(&dispatch);
    enum status status = vk_compile(r->base.vk, &make, reason);
    if (!status && !*pipeline)
        status = vk_pipeline_make(r->base.vk, &make, pipeline, reason);
    r->base.chosen = *pipeline;
    return status;
}

/* --- scenes ----------------------------------------------------------------------------------- */

/* The world of the scene alone, with the geometries of the variant. */
static enum status make_alone(struct rayquery *r, const struct scene *scene, struct reason *reason)
{
    struct accel_part *part = NULL;
    uint32_t count = 0;
    enum status status = world_of_scene(scene, &r->alone, reason);
    if (!status)
        status = accel_split(scene, &r->variant, &part, &count, reason);
    struct geometry *geometry = status ? NULL : alloc_zeroed(count, sizeof *geometry);
    if (!status && !geometry)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for %u geometries", count);
    for (uint32_t i = 0; i < count && !status; i++)
        geometry[i] = (struct geometry){part[i].first, part[i].count, true};
    free(part);
    if (status)
        return status;
    free(r->alone.mesh[0].geometry);
    r->alone.mesh[0].geometry = geometry;
    r->alone.mesh[0].geometry_count = count;
    return STATUS_OK;
}

/* Has the runner of worlds trace the scene if triangles are numbered in several geometries, or are
 * there that the scene has not: it knows where each geometry begins and ends. */
static enum status choose_runner(struct rayquery *r, const struct job *job, struct reason *reason)
{
    const bool added = r->variant.nan || r->variant.degenerate;
    if (!r->accel || (r->alone.mesh[0].geometry_count == 1 && !added))
        return STATUS_OK;
    const struct world_job alone = {
        .world = &r->alone, .box = job->box, .tri = job->tri, .query = job->query};
    if (!r->worlds)
        r->worlds = world_runner_make(r->base.vk, r->base.workgroup);
    if (!r->worlds)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    r->runs = true;
    return world_runner_prepare_query(r->worlds, &alone, r->accel, reason);
}

/* Keeps what the next move finds. */
static enum status keep(struct rayquery *r, const struct world *world, struct reason *reason)
{
    if (r->variant.how.update != VK_ACCEL_UPDATE_NONE)
        return rayquery_keep(world, &r->past, reason);
    return STATUS_OK;
}

/* What was kept of such a world, or NULL. */
static const struct rayquery_past *past_of(const struct rayquery *r, const struct world *world)
{
    const struct rayquery_past *past = &r->past;
    return past->vertex && past->mesh_count == world->mesh_count &&
                   past->instance_count == world->instance_count
               ? past
               : NULL;
}

/* `moves`: the vertices were elsewhere before. */
static enum status make(struct rayquery *r, const struct job *job, bool moves,
                        struct reason *reason)
{
    forget(r);
    r->base.lists = job->query == QUERY_ALL;
    enum status status = make_pipeline(r, job, reason);
    if (!status && job->scene->tri_count)
        status = make_alone(r, job->scene, reason);
    if (!status && job->scene->tri_count)
        status =
            rayquery_build(r->base.vk, &r->options, &r->alone, moves ? past_of(r, &r->alone) : NULL,
                           &r->variant, &r->accel, reason);
    if (!status)
        status = choose_runner(r, job, reason);
    if (!status)
        status = keep(r, &r->alone, reason);
    r->base.empty = !r->accel;
    r->base.bytes = vk_accel_bytes(r->accel);
    if (!status && r->accel)
        vk_pipeline_use(r->base.vk, r->base.chosen, r->accel);
    if (status)
        r->base.chosen = NULL;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    return make(self, job, false, reason);
}

enum status rayquery_move(void *self, const struct job *job, struct reason *reason)
{
    return make(self, job, true, reason);
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct rayquery *r = self;
    if (!r->runs)
        return batch_trace(self, ray, ray_count, hit, report, reason);
    uint32_t *tag = alloc_zeroed(ray_count, sizeof *tag);
    if (!tag)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %zu rays", ray_count);
    enum status status =
        world_runner_trace(r->worlds, ray, NULL, ray_count, 1, hit, tag, NULL, report, reason);
    report->memory_bytes += vk_accel_bytes(r->accel);
    free(tag);
    return status;
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    struct rayquery *r = self;
    struct trace_report unused;
    if (!r->runs)
        return batch_trace_all(self, ray, ray_count, capacity, hit, hit_count, reason);
    uint32_t *tag = alloc_zeroed(ray_count * capacity, sizeof *tag);
    if (!tag)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %zu rays", ray_count);
    enum status status = world_runner_trace(r->worlds, ray, NULL, ray_count, capacity, hit, tag,
                                            hit_count, &unused, reason);
    free(tag);
    return status;
}

/* --- worlds ----------------------------------------------------------------------------------- */

static enum status make_world(struct rayquery *r, const struct world_job *job, bool moves,
                              struct reason *reason)
{
    forget(r);
    r->base.chosen = NULL;
    if (!r->worlds)
        r->worlds = world_runner_make(r->base.vk, r->base.workgroup);
    if (!r->worlds)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    enum status status =
        rayquery_build(r->base.vk, &r->options, job->world, moves ? past_of(r, job->world) : NULL,
                       &r->variant, &r->accel, reason);
    if (!status)
        status = keep(r, job->world, reason);
    if (!status)
        return world_runner_prepare_query(r->worlds, job, r->accel, reason);
    world_runner_free(r->worlds); /* what it was prepared for is gone */
    r->worlds = NULL;
    return status;
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    return make_world(self, job, false, reason);
}

enum status rayquery_move_world(void *self, const struct world_job *job, struct reason *reason)
{
    return make_world(self, job, true, reason);
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    struct rayquery *r = self;
    enum status status =
        world_runner_trace(r->worlds, ray, mode, ray_count, 1, hit, tag, NULL, report, reason);
    report->memory_bytes += vk_accel_bytes(r->accel);
    return status;
}

static enum status trace_world_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    struct trace_report unused;
    return world_runner_trace(((struct rayquery *)self)->worlds, ray, mode, ray_count, capacity,
                              hit, tag, hit_count, &unused, reason);
}

static const struct world_tracer worlds = {
    .prepare_world = prepare_world,
    .trace_world = trace_world,
    .trace_world_all = trace_world_all,
};

/* Vulkan requires tmin < t < tmax; that closed fans are watertight is only a "should". */
static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self;
    (void)tri;
    return (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_VULKAN, .open = true};
}

static void describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine;
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
static const char *plain_of(const char *name)
{
    struct accel_variant variant;
    struct reason reason;
    const bool is = accel_is_named(name) && !accel_parse(name, &variant, &reason);
    return is ? engine_rayquery.name : NULL;
}

const struct engine engine_rayquery = {
    .name = "rayquery",
    .gpu = true,
    .summary = "the Vulkan driver's own ray queries, where it has them",
    .own_tri = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .worlds = &worlds,
    .model = model,
    .close = close,
    .plain_of = plain_of,
    .describe = describe,
};

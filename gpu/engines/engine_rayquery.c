/* Engine `rayquery`: the driver's own tree and triangle test (VK_KHR_ray_query), where available.
 * Its formula is unknown, so the judge checks geometry only. The job's box and triangle test are
 * not used. */
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
};

_Static_assert(ABI_QUERY_ALL < QUERIES, "a pipeline each");

static void close(void *self)
{
    struct rayquery *r = self;
    if (!r)
        return;
    for (uint32_t q = 0; q < QUERIES && r->base.vk; q++)
        vk_pipeline_free(r->base.vk, r->pipeline[q]);
    world_runner_free(r->worlds);
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
    struct vk_shader make = dispatch_shader(&dispatch);
    enum status status = vk_compile(r->base.vk, &make, reason);
    if (!status && !*pipeline)
        status = vk_pipeline_make(r->base.vk, &make, pipeline, reason);
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

/* --- worlds ----------------------------------------------------------------------------------- */

/* The meshes of a world as the device is given them; owns the buffers. */
struct meshes {
    struct vk_accel_mesh *mesh;
    struct vk_accel_geometry *geometry; /* of all meshes, in order */
    struct vk_accel_instance *instance;
    uint32_t count;
};

static void free_meshes(struct vk *vk, struct meshes *meshes)
{
    for (uint32_t i = 0; i < meshes->count; i++) {
        vk_buffer_free(vk, meshes->mesh[i].vertices);
        vk_buffer_free(vk, meshes->mesh[i].indices);
    }
    free(meshes->mesh);
    free(meshes->geometry);
    free(meshes->instance);
}

static enum status make_room(const struct world *world, struct meshes *out, struct reason *reason)
{
    uint64_t geometries = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        geometries += world->mesh[i].geometry_count;
    out->mesh = alloc_zeroed(world->mesh_count, sizeof *out->mesh);
    out->geometry = alloc_zeroed(geometries, sizeof *out->geometry);
    out->instance = alloc_zeroed(world->instance_count, sizeof *out->instance);
    if (!out->mesh || !out->geometry || !out->instance)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances",
                    world->instance_count);
    out->count = world->mesh_count;
    return STATUS_OK;
}

static enum status upload_meshes(struct rayquery *r, const struct world *world, struct meshes *out,
                                 struct reason *reason)
{
    enum status status = make_room(world, out, reason);
    struct vk_accel_geometry *next = out->geometry;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        const struct world_mesh *from = &world->mesh[i];
        struct vk_accel_mesh *to = &out->mesh[i];
        to->vertex_count = from->scene->vertex_count;
        to->geometry = next;
        to->geometry_count = from->geometry_count;
        for (uint32_t g = 0; g < from->geometry_count; g++)
            *next++ = (struct vk_accel_geometry){from->geometry[g].first, from->geometry[g].count,
                                                 from->geometry[g].opaque, NULL};
        status = vk_buffer_make_of(r->base.vk, from->scene->vertex, 12ull * to->vertex_count,
                                   &to->vertices, reason);
        if (!status)
            status = vk_buffer_make_of(r->base.vk, from->scene->index,
                                       12ull * from->scene->tri_count, &to->indices, reason);
    }
    return status;
}

_Static_assert(VK_ACCEL_NO_MESH == WORLD_NO_MESH, "a null reference");

static enum status build_world(struct rayquery *r, const struct world *world, struct reason *reason)
{
    struct meshes meshes = {0};
    enum status status = upload_meshes(r, world, &meshes, reason);
    for (uint32_t i = 0; i < world->instance_count && !status; i++) {
        const struct instance *from = &world->instance[i];
        struct vk_accel_instance *to = &meshes.instance[i];
        memcpy(to->transform, from->m, sizeof from->m);
        to->mesh = from->mesh;
        to->custom = from->custom;
        to->mask = from->mask;
        to->flags = from->flags;
    }
    const struct vk_accel_world built = {meshes.mesh, meshes.instance, world->mesh_count,
                                         world->instance_count, NULL};
    if (!status)
        status = vk_accel_make_world(r->base.vk, &built, &r->accel, reason);
    free_meshes(r->base.vk, &meshes);
    return status;
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct rayquery *r = self;
    vk_accel_free(r->base.vk, r->accel);
    r->accel = NULL;
    r->base.chosen = NULL;
    if (!r->worlds)
        r->worlds = world_runner_make(r->base.vk, r->base.workgroup);
    if (!r->worlds)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    enum status status = build_world(r, job->world, reason);
    if (!status)
        return world_runner_prepare_query(r->worlds, job, r->accel, reason);
    world_runner_free(r->worlds); /* what it was prepared for is gone */
    r->worlds = NULL;
    return status;
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
    .worlds = &worlds,
    .model = model,
    .close = close,
    .describe = describe,
};

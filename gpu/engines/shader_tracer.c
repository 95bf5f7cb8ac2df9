#include "gpu/engines/shader_tracer.h"

#include "gpu/shaders/glsl_text.h"
#include "gpu/shaders/spirv_interface.h"
#include "gpu/trace/batch.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/files/file.h"
#include "ref/outside/shared_object.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

#define NAME_MOST 160
#define SUFFIX    ".spv"

/* Rays of one dispatch: they double while dispatches are quick and halve when one is slow, so that
 * no driver's watchdog ends a long job. */
#define RAYS_FIRST (1u << 10)
#define RAYS_MOST  (1u << 18)
#define QUICK_NS   100000000u
#define SLOW_NS    1000000000u

enum { BIND_RAYS, BIND_HITS, BIND_VERTICES, BIND_TRIANGLES, BINDINGS };

struct shader_push {
    uint32_t rays, vertices, triangles, query;
};

/* A file that was named: its module, for every time that it is opened. */
struct shader_named {
    char name[NAME_MOST];
    uint32_t *word;
    size_t count;
    struct spirv_interface interface;
};

struct outsider {
    struct batch_engine base;
    const struct shader_named *named;
    struct vk_pipeline *pipeline;
    struct vk_buffer *vertices, *triangles;
    struct shader_push push;
    uint32_t most; /* rays of the next dispatch */
};

static shader_tracer_compile_fn *compile_with;

void shader_tracer_compile_with(shader_tracer_compile_fn *compile)
{
    compile_with = compile;
}

/* --- tracing ---------------------------------------------------------------------------------- */

static void outsider_close(void *self)
{
    struct outsider *o = self;
    if (!o)
        return;
    if (o->base.vk) {
        vk_pipeline_free(o->base.vk, o->pipeline);
        vk_buffer_free(o->base.vk, o->vertices);
        vk_buffer_free(o->base.vk, o->triangles);
    }
    (void)vk_close(o->base.vk, NULL);
    free(o);
}

static uint64_t most(const struct batch_engine *engine)
{
    return ((const struct outsider *)engine)->most;
}

/* Checks that all triangles are in the scene. An invocation that was ended early left what names
 * none. */
static enum status check_hits(const struct outsider *o, size_t first, uint32_t count,
                              struct hit *hit, struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (hit[i].prim == ABI_NO_PRIM)
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        else if (hit[i].prim >= o->push.triangles)
            return fail(reason, STATUS_DEVICE,
                        "%.80s: its answer to ray %zu names triangle %u of %u, or was never "
                        "written",
                        o->named->name, first + i, hit[i].prim, o->push.triangles);
    return STATUS_OK;
}

static enum status answer(struct batch_engine *engine, struct batch *batch, const struct ray *ray,
                          size_t first, uint32_t count, const struct batch_answers *to,
                          struct trace_report *report, struct reason *reason)
{
    struct outsider *o = (struct outsider *)engine;
    struct vk_buffer *const buffer[BINDINGS] = {[BIND_RAYS] = batch->rays,
                                                [BIND_HITS] = batch->hits[0],
                                                [BIND_VERTICES] = o->vertices,
                                                [BIND_TRIANGLES] = o->triangles};
    struct vk_time time = {0};
    struct hit *hit = to->hit + first;
    const uint32_t groups = (count + batch->workgroup - 1) / batch->workgroup;
    o->push.rays = count;
    memset(hit, 0xFE, count * sizeof *hit);
    enum status status = batch_rays(batch, ray + first, count, reason);
    if (!status)
        status = vk_buffer_write(o->base.vk, batch->hits[0], 0, hit, count * sizeof *hit, reason);
    if (!status)
        status = vk_dispatch(o->base.vk, o->pipeline, buffer, &o->push, groups, &time, reason);
    if (!status)
        status = batch_read(batch, 0, 0, count, hit, NULL, reason);
    report->ns += time.ns;
    report->device_clock = report->device_clock && time.device_clock;
    if (time.ns < QUICK_NS && o->most < RAYS_MOST)
        o->most *= 2;
    else if (time.ns > SLOW_NS && o->most > 1)
        o->most /= 2;
    return status ? status : check_hits(o, first, count, hit, reason);
}

static enum status make_pipeline(struct outsider *o, struct reason *reason)
{
    const struct vk_shader make = {.name = o->named->name,
                                   .whole = true,
                                   .word = o->named->word,
                                   .word_count = (uint32_t)o->named->count,
                                   .binding_count = BINDINGS,
                                   .push_bytes = sizeof o->push,
                                   .constant = &o->base.workgroup,
                                   .constant_count = 1};
    return vk_pipeline_make(o->base.vk, &make, &o->pipeline, reason);
}

static enum status outsider_open(const struct engine *engine, const struct engine_options *options,
                                 void **self, struct reason *reason)
{
    const struct shader_named *of = engine->named;
    struct outsider *o = alloc_zeroed(1, sizeof *o);
    const struct vk_options vk_options = vulkan_options(options);
    const uint32_t own = of->interface.local[0] ? of->interface.local[0] : 1;
    *self = NULL;
    if (!o)
        return fail(reason, STATUS_MEMORY, "%.80s: no memory for the engine", of->name);
    o->named = of;
    o->most = RAYS_FIRST;
    o->base.workgroup = !of->interface.local_chosen ? own
                        : options->workgroup        ? options->workgroup
                                                    : ABI_WORKGROUP;
    o->base.most = most;
    o->base.answer = answer;
    enum status status = vk_open(&vk_options, &o->base.vk, reason);
    if (!status)
        status = make_pipeline(o, reason);
    if (status)
        outsider_close(o);
    else
        *self = o;
    return status;
}

static enum status outsider_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct outsider *o = self;
    const struct scene *scene = job->scene;
    struct vk *vk = o->base.vk;
    if (job->query == QUERY_ALL)
        return fail(reason, STATUS_UNSUPPORTED, "%.80s cannot list all hits", o->named->name);
    vk_buffer_free(vk, o->vertices);
    vk_buffer_free(vk, o->triangles);
    o->vertices = o->triangles = NULL;
    o->base.chosen = NULL;
    o->push = (struct shader_push){0, scene->vertex_count, scene->tri_count, (uint32_t)job->query};
    enum status status = vk_buffer_make_of(
        vk, scene->vertex, 3 * sizeof(float) * (uint64_t)scene->vertex_count, &o->vertices, reason);
    if (!status)
        status =
            vk_buffer_make_of(vk, scene->index, 3 * sizeof(uint32_t) * (uint64_t)scene->tri_count,
                              &o->triangles, reason);
    if (!status)
        o->base.chosen = o->pipeline;
    o->base.bytes = status ? 0 : vk_buffer_bytes(o->vertices) + vk_buffer_bytes(o->triangles);
    return status;
}

/* Its formula is its own, and a driver may fuse its operations. */
static struct model outsider_model(const struct engine *engine, void *self,
                                   const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_VULKAN};
}

/* --- the engines ------------------------------------------------------------------------------ */

static const struct engine outsiders = {
    .summary = "a compute shader from outside",
    .gpu = true,
    .own_tri = true,
    .open = outsider_open,
    .prepare = outsider_prepare,
    .trace = batch_trace,
    .model = outsider_model,
    .close = outsider_close,
    .describe = vulkan_describe,
};

static enum status read_spirv(const char *path, uint32_t **word, size_t *count,
                              struct reason *reason)
{
    char *bytes = NULL;
    size_t size = 0;
    *word = NULL;
    *count = 0;
    enum status status = file_read_most(path, GLSL_TEXT_MOST, &bytes, &size, reason);
    if (!status && size % sizeof **word != 0)
        status = fail(reason, STATUS_INPUT, "%.120s: no SPIR-V module: %zu bytes are no words",
                      path, size);
    if (!status) {
        *count = size / sizeof **word;
        *word = alloc_zeroed(*count, sizeof **word);
        if (*word)
            memcpy(*word, bytes, size);
        else
            status = fail(reason, STATUS_MEMORY, "%.120s: no memory for a shader", path);
    }
    free(bytes);
    return status;
}

static enum status read_module(const char *path, struct shader_named *out, struct reason *reason)
{
    struct reason why;
    const size_t length = strlen(path), suffix = strlen(SUFFIX);
    const bool binary = length > suffix && strcmp(path + length - suffix, SUFFIX) == 0;
    enum status status;
    if (binary)
        status = read_spirv(path, &out->word, &out->count, reason);
    else if (compile_with)
        status = compile_with(path, &out->word, &out->count, reason);
    else
        status = fail(reason, STATUS_UNSUPPORTED, "%.120s: no compiler of GLSL: name a .spv", path);
    if (status)
        return status;
    status = spirv_interface(out->word, out->count, BINDINGS, &out->interface, &why);
    return status ? fail(reason, status, "%.120s: %.180s", path, why.text) : STATUS_OK;
}

enum status shader_tracer(const char *name, const struct engine **out, struct reason *reason)
{
    static struct shader_named named[ENGINES_OUTSIDE_MOST];
    static size_t named_count;
    const size_t prefix = strlen(SHADER_PREFIX);
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    if (strncmp(name, SHADER_PREFIX, prefix) != 0 || !name[prefix])
        return fail(reason, STATUS_INPUT, "'%.60s' is not shader:FILE", name);
    if (strlen(name) >= NAME_MOST)
        return fail(reason, STATUS_INPUT, "'%.40s...' is longer than %d characters", name,
                    NAME_MOST - 1);
    if (named_count == ARRAY_COUNT(named))
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d shaders that trace", name,
                    ENGINES_OUTSIDE_MOST);
    struct shader_named *one = &named[named_count];
    strcpy(one->name, name);
    enum status status = read_module(name + prefix, one, reason);
    struct engine engine = outsiders;
    engine.name = one->name;
    engine.named = one;
    if (!status)
        status = engine_add(&engine, out, reason);
    named_count += !status;
    if (status) {
        free(one->word);
        *one = (struct shader_named){.count = 0};
    }
    return status;
}

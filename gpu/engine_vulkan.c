/* Engine `vulkan`: the shaders of shaders/trace_<layout>.comp on any Vulkan 1.1 device. */
#include "gpu/engine_vulkan.h"

#include "gpu/shaders.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BINDINGS  6u
#define CONSTANTS 5u

/* Rays of one dispatch: begun small, doubled while a dispatch is quick, halved when it is slow, so
 * that neither the wait nor a driver's watchdog ends a long job. */
#define BATCH_FIRST 16384u
#define BATCH_MOST  (1u << 20)
#define QUICK_NS    100000000u
#define SLOW_NS     1000000000u

/* Triangles gathered at a time while uploading. */
#define GATHER 8192u

struct cached {
    const struct shader *shader;
    uint32_t constant[CONSTANTS];
    struct vk_pipeline *pipeline;
};

struct self {
    struct vk *vk;
    uint32_t workgroup;
    struct cached *cache;
    size_t cache_count, cache_capacity;
    struct vk_pipeline *pipeline; /* of the job; borrowed from the cache */
    struct vk_buffer *buffer[BINDINGS];
    uint32_t *flag; /* ray_capacity read back */
    uint32_t ray_capacity, batch, stack;
    struct push push;
};

_Static_assert(ABI_BIND_TRIS == BINDINGS - 1, "the tracing shaders have bindings 0 to 5");
_Static_assert(ABI_SPEC_STACK == CONSTANTS - 1, "the tracing shaders have constants 0 to 4");

enum status engine_vulkan_open(const struct vk_options *options, uint32_t workgroup, void **out,
                               struct reason *reason)
{
    struct self *self = alloc_zeroed(1, sizeof *self);
    *out = self;
    if (!self)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the engine");
    self->workgroup = workgroup ? workgroup : ABI_WORKGROUP;
    enum status status = vk_open(options, &self->vk, reason);
    if (!status && self->workgroup > vk_limits(self->vk)->group_size)
        status = fail(reason, STATUS_UNSUPPORTED, "vulkan: workgroups of %u: %s allows 1 to %u",
                      (unsigned)self->workgroup, vk_limits(self->vk)->device,
                      (unsigned)vk_limits(self->vk)->group_size);
    if (status) {
        (void)engine_vulkan_close(self, NULL);
        *out = NULL;
    }
    return status;
}

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
    return engine_vulkan_open(&vk_options, options->workgroup, self, reason);
}

static void free_buffers(struct self *self)
{
    for (uint32_t i = 0; i < BINDINGS; i++) {
        vk_buffer_free(self->vk, self->buffer[i]);
        self->buffer[i] = NULL;
    }
    free(self->flag);
    self->flag = NULL;
    self->ray_capacity = 0;
}

uint32_t engine_vulkan_close(void *data, struct reason *reason)
{
    struct self *self = data;
    if (!self)
        return 0;
    free_buffers(self);
    for (size_t i = 0; i < self->cache_count; i++)
        vk_pipeline_free(self->vk, self->cache[i].pipeline);
    free(self->cache);
    uint32_t messages = vk_close(self->vk, reason);
    free(self);
    return messages;
}

static void close(void *self)
{
    (void)engine_vulkan_close(self, NULL);
}

uint32_t engine_vulkan_pipelines(const void *self)
{
    return (uint32_t)((const struct self *)self)->cache_count;
}

/* Finds or makes the pipeline of the job. */
static enum status choose_pipeline(struct self *self, const struct job *job, struct reason *reason)
{
    char name[64];
    (void)snprintf(name, sizeof name, "trace_%s", job->packed->layout->name);
    struct cached want = {shader_find(name),
                          {self->workgroup, job->box->id, job->tri->id, job->query, self->stack},
                          NULL};
    if (!want.shader)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: there is no shader for layout %s",
                    job->packed->layout->name);
    for (size_t i = 0; i < self->cache_count; i++)
        if (self->cache[i].shader == want.shader &&
            memcmp(self->cache[i].constant, want.constant, sizeof want.constant) == 0) {
            self->pipeline = self->cache[i].pipeline;
            return STATUS_OK;
        }
    void *cache = self->cache;
    if (array_reserve(&cache, &self->cache_capacity, self->cache_count + 1, sizeof want))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the list of pipelines");
    self->cache = cache;
    struct vk_shader shader = {
        .name = want.shader->name,
        .word = want.shader->word,
        .word_count = want.shader->word_count,
        .binding_count = BINDINGS,
        .push_bytes = sizeof(struct push),
        .constant = want.constant,
        .constant_count = CONSTANTS,
    };
    enum status status = vk_pipeline_make(self->vk, &shader, &want.pipeline, reason);
    if (status)
        return status;
    self->cache[self->cache_count++] = want;
    self->pipeline = want.pipeline;
    return STATUS_OK;
}

static enum status upload(struct self *self, uint32_t binding, const void *data, uint64_t bytes,
                          struct reason *reason)
{
    enum status status = vk_buffer_make(self->vk, bytes, &self->buffer[binding], reason);
    if (!status && bytes)
        status = vk_buffer_write(self->vk, self->buffer[binding], 0, data, bytes, reason);
    return status;
}

/* Nine floats per triangle, made a piece at a time. */
static enum status upload_triangles(struct self *self, const struct scene *scene,
                                    struct reason *reason)
{
    struct vk_buffer **to = &self->buffer[ABI_BIND_TRIS];
    const uint64_t bytes = ABI_TRI_FLOATS * sizeof(float);
    enum status status = vk_buffer_make(self->vk, bytes * scene->tri_count, to, reason);
    if (status)
        return status;
    float(*tri)[3][3] = alloc_zeroed(GATHER, sizeof *tri);
    if (!tri)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory to gather triangles");
    for (uint32_t done = 0; done < scene->tri_count && !status;) {
        uint32_t part = scene->tri_count - done < GATHER ? scene->tri_count - done : GATHER;
        for (uint32_t i = 0; i < part; i++)
            scene_tri(scene, done + i, tri[i]);
        status = vk_buffer_write(self->vk, *to, bytes * done, tri, bytes * part, reason);
        done += part;
    }
    free(tri);
    return status;
}

/* The smallest stack class that is enough: a larger private array costs every ray. */
static enum status choose_stack(struct self *self, const struct packed *packed,
                                struct reason *reason)
{
    self->stack = 16;
    while (self->stack < packed->stack_need)
        self->stack *= 2;
    if (self->stack > ABI_STACK_MAX)
        return fail(reason, STATUS_LIMIT, "vulkan: stacks of %u entries, the tree needs %u",
                    ABI_STACK_MAX, (unsigned)packed->stack_need);
    return STATUS_OK;
}

static enum status prepare(void *data, const struct job *job, struct reason *reason)
{
    struct self *self = data;
    const struct packed *packed = job->packed;
    free_buffers(self);
    self->batch = BATCH_FIRST;
    self->push = (struct push){
        .root = packed->root,
        .node_count = packed->node_count,
        .item_count = packed->item_count,
        .tri_count = job->scene->tri_count,
    };
    enum status status = choose_stack(self, packed, reason);
    if (!status)
        status = choose_pipeline(self, job, reason);
    if (!status)
        status = upload(self, ABI_BIND_NODES, packed->word, packed_node_bytes(packed), reason);
    if (!status)
        status = upload(self, ABI_BIND_ITEMS, packed->item, packed_item_bytes(packed), reason);
    if (!status)
        status = upload_triangles(self, job->scene, reason);
    if (status)
        free_buffers(self);
    return status;
}

/* Buffers for `count` rays at a time, or for as many as the device allows. */
static enum status reserve_rays(struct self *self, size_t count, struct reason *reason)
{
    const struct vk_limits *limits = vk_limits(self->vk);
    uint64_t most = limits->buffer_bytes / sizeof(struct ray);
    uint64_t groups = (uint64_t)limits->groups * self->workgroup;
    most = groups < most ? groups : most;
    most = BATCH_MOST < most ? BATCH_MOST : most;
    uint32_t need = (uint32_t)(count < most ? count : most);
    if (need <= self->ray_capacity)
        return STATUS_OK;
    vk_buffer_free(self->vk, self->buffer[ABI_BIND_RAYS]);
    vk_buffer_free(self->vk, self->buffer[ABI_BIND_HITS]);
    vk_buffer_free(self->vk, self->buffer[ABI_BIND_FLAGS]);
    free(self->flag);
    self->buffer[ABI_BIND_RAYS] = self->buffer[ABI_BIND_HITS] = self->buffer[ABI_BIND_FLAGS] = NULL;
    self->ray_capacity = 0;
    self->flag = alloc_zeroed(need, sizeof *self->flag);
    if (!self->flag)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the flags of %u rays",
                    (unsigned)need);
    enum status status = vk_buffer_make(self->vk, (uint64_t)need * sizeof(struct ray),
                                        &self->buffer[ABI_BIND_RAYS], reason);
    if (!status)
        status = vk_buffer_make(self->vk, (uint64_t)need * sizeof(struct hit),
                                &self->buffer[ABI_BIND_HITS], reason);
    if (!status)
        status = vk_buffer_make(self->vk, (uint64_t)need * sizeof *self->flag,
                                &self->buffer[ABI_BIND_FLAGS], reason);
    if (!status)
        self->ray_capacity = need;
    return status;
}

/* What kept a ray from its end, by its flags. */
static const char *cause(uint32_t flag)
{
    if (flag & ABI_FLAG_STACK)
        return "its traversal stack overran: the tree is deeper than its stack_need says";
    if (flag & ABI_FLAG_VISITS)
        return "it visited more nodes than there are: the tree has a cycle";
    if (flag & ABI_FLAG_LOOP)
        return "the driver ended its loop early (lavapipe 22 does after 65,535 iterations)";
    return "its invocation did not run to the end";
}

static enum status check_flags(const struct self *self, size_t first, uint32_t count,
                               struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (self->flag[i] != ABI_FLAG_DONE)
            return fail(reason, STATUS_DEVICE, "vulkan: %s: ray %zu was not finished: %s",
                        vk_limits(self->vk)->device, first + i, cause(self->flag[i]));
    return STATUS_OK;
}

/* Traces `count` rays, `first` is the first one's index for messages. */
static enum status trace_batch(struct self *self, const struct ray *ray, size_t first,
                               uint32_t count, struct hit *hit, struct vk_time *time,
                               struct reason *reason)
{
    struct vk_buffer *flags = self->buffer[ABI_BIND_FLAGS];
    const uint64_t flag_bytes = (uint64_t)count * sizeof *self->flag;
    memset(self->flag, 0, flag_bytes); /* so that a ray never traced has no DONE */
    enum status status = vk_buffer_write(self->vk, flags, 0, self->flag, flag_bytes, reason);
    if (!status)
        status = vk_buffer_write(self->vk, self->buffer[ABI_BIND_RAYS], 0, ray,
                                 (uint64_t)count * sizeof *ray, reason);
    if (status)
        return status;
    self->push.ray_count = count;
    uint32_t groups = (count + self->workgroup - 1) / self->workgroup;
    status = vk_dispatch(self->vk, self->pipeline, self->buffer, &self->push, groups, time, reason);
    if (!status)
        status = vk_buffer_read(self->vk, flags, 0, self->flag, flag_bytes, reason);
    if (!status)
        status = check_flags(self, first, count, reason);
    if (!status)
        status = vk_buffer_read(self->vk, self->buffer[ABI_BIND_HITS], 0, hit,
                                (uint64_t)count * sizeof *hit, reason);
    return status;
}

static enum status trace(void *data, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct self *self = data;
    *report = (struct trace_report){.device_clock = true};
    if (!ray_count)
        return STATUS_OK;
    enum status status = reserve_rays(self, ray_count, reason);
    for (size_t done = 0; done < ray_count && !status;) {
        uint32_t part = self->batch < self->ray_capacity ? self->batch : self->ray_capacity;
        part = ray_count - done < part ? (uint32_t)(ray_count - done) : part;
        struct vk_time time;
        status = trace_batch(self, ray + done, done, part, hit + done, &time, reason);
        report->ns += time.ns;
        report->device_clock = report->device_clock && time.device_clock;
        if (part == self->batch && time.ns < QUICK_NS && self->batch < BATCH_MOST)
            self->batch *= 2;
        else if (time.ns > SLOW_NS && self->batch > self->workgroup)
            self->batch /= 2;
        done += part;
    }
    if (!status && vk_messages(self->vk, reason))
        status = STATUS_DEVICE;
    for (uint32_t i = 0; i < BINDINGS; i++)
        report->memory_bytes += vk_buffer_bytes(self->buffer[i]);
    return status;
}

static void describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    struct vk_options vk_options = options_of(options);
    vk_describe(&vk_options, text, text_bytes);
}

extern const struct engine engine_vulkan;
const struct engine engine_vulkan = {
    .name = "vulkan",
    .summary = "compute shaders on a Vulkan device, one per layout",
    .needs_packed = true,
    .exact = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .close = close,
    .describe = describe,
};

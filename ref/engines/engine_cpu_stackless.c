/* The reference traversal without a stack, by parent links and a trail of bits. */
#include "ref/engines/cpu_rays.h"
#include "ref/packed/packed_walk.h"
#include "ref/trace/trace.h"
#include "ref/twin/model.h"

#include <stdio.h>
#include <stdlib.h>

struct stackless {
    void *rays;
    uint32_t *parent; /* links of the job's tree */
    uint64_t bytes;   /* bytes of `parent` */
};

static enum status answer_all(const struct job *job, const struct ray *ray, uint32_t capacity,
                              struct hit *hit, uint32_t *count)
{
    return trace_ray_all(job, ray, capacity, hit, count, NULL);
}

static void stackless_close(void *self)
{
    struct stackless *s = self;
    if (!s)
        return;
    cpu_rays_close(s->rays);
    free(s->parent);
    free(s);
}

static enum status stackless_open(const struct engine *engine, const struct engine_options *options,
                                  void **self, struct reason *reason)
{
    (void)engine;
    struct stackless *s = alloc_zeroed(1, sizeof *s);
    *self = s;
    if (!s)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    enum status status = cpu_rays_open(options, trace_ray, answer_all, &s->rays, reason);
    if (status) {
        stackless_close(s);
        *self = NULL;
    }
    return status;
}

static enum status stackless_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct stackless *s = self;
    struct job linked = *job;
    free(s->parent);
    enum status status = packed_links(job->packed, &s->parent, reason);
    linked.parent = s->parent;
    s->bytes = s->parent ? 4 * (uint64_t)job->packed->ref_count : 0;
    return status ? status : cpu_rays_prepare(s->rays, &linked, reason);
}

static enum status stackless_trace(void *self, const struct ray *ray, size_t ray_count,
                                   struct hit *hit, struct trace_report *report,
                                   struct reason *reason)
{
    struct stackless *s = self;
    enum status status = cpu_rays_trace(s->rays, ray, ray_count, hit, report, reason);
    report->memory_bytes += s->bytes;
    return status;
}

static enum status stackless_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                       uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                       struct reason *reason)
{
    return cpu_rays_trace_all(((struct stackless *)self)->rays, ray, ray_count, capacity, hit,
                              hit_count, reason);
}

static struct model stackless_model(const struct engine *engine, void *self,
                                    const struct tri_test *tri)
{
    struct model model = cpu_rays_model(engine, self, tri);
    model.bits = true;
    return model;
}

static void stackless_describe(const struct engine *engine, const struct engine_options *options,
                               char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, reference traversal over binary layouts, no stack",
             cpu_rays_threads(options));
}

extern const struct engine engine_cpu_stackless;
const struct engine engine_cpu_stackless = {
    .name = "cpu_stackless",
    .summary = "C, the reference traversal with parent links and a bit trail",
    .needs_packed = true,
    .binary = true,
    .open = stackless_open,
    .prepare = stackless_prepare,
    .trace = stackless_trace,
    .trace_all = stackless_trace_all,
    .model = stackless_model,
    .close = stackless_close,
    .describe = stackless_describe,
};

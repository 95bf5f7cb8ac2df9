/* The reference traversal on all cores. */
#include "ref/engines/cpu_rays.h"
#include "ref/engines/cpu_worlds.h"
#include "ref/trace/trace.h"
#include "ref/store.h"
#include "ref/twin/model.h"

#include <stdio.h>

static void cpu_task(struct engine_task *task)
{
    const struct job *job = &task->job;
    task->status = tri_store_check(job->packed->store, job->tri->id, job->tri->name, &task->reason);
    if (task->status)
        return;
    if (trace_rays(job, task->ray, task->ray_count, task->hit, task->flag, task->work))
        task->status = fail(&task->reason, STATUS_DEVICE,
                            "rays not finished: stack of %u or %u nodes exhausted",
                            job->packed->stack_need, job->packed->node_count);
}

static enum status cpu_tasks(void *self, struct engine_task *task, size_t count,
                             struct reason *reason)
{
    (void)reason;
    cpu_rays_tasks(self, cpu_task, task, count);
    return STATUS_OK;
}

static enum status cpu_ray_all(const struct job *job, const struct ray *ray, uint32_t capacity,
                               struct hit *hit, uint32_t *count)
{
    return trace_ray_all(job, ray, capacity, hit, count, NULL);
}

static enum status cpu_open(const struct engine *engine, const struct engine_options *options,
                            void **self, struct reason *reason)
{
    (void)engine;
    return cpu_rays_open(options, trace_ray, cpu_ray_all, self, reason);
}

static struct model cpu_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    struct model model = cpu_rays_model(engine, self, tri);
    model.bits = true;
    return model;
}

static void cpu_describe(const struct engine *engine, const struct engine_options *options,
                         char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, reference traversal over any layout",
             cpu_rays_threads(options));
}

const struct engine engine_cpu = {
    .name = "cpu",
    .summary = "C, the reference traversal over any layout",
    .reference = true,
    .needs_packed = true,
    .tells_work = true,
    .open = cpu_open,
    .prepare = cpu_rays_prepare,
    .trace = cpu_rays_trace,
    .trace_tasks = cpu_tasks,
    .trace_all = cpu_rays_trace_all,
    .worlds = &cpu_worlds_packed,
    .model = cpu_model,
    .close = cpu_rays_close,
    .describe = cpu_describe,
};

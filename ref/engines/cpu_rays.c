#include "ref/engines/cpu_rays.h"

#include "ref/twin/twin.h"
#include "ref/store.h"

#include <omp.h>
#include <stdlib.h>

unsigned cpu_rays_threads(const struct engine_options *options)
{
    return options->threads ? options->threads : (unsigned)omp_get_max_threads();
}

enum status cpu_rays_open(const struct engine_options *options, cpu_ray_fn *answer,
                          cpu_ray_all_fn *answer_all, void **self, struct reason *reason)
{
    struct cpu_rays *made = alloc_zeroed(1, sizeof *made);
    *self = made;
    if (!made)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    made->answer = answer;
    made->answer_all = answer_all;
    made->threads = cpu_rays_threads(options);
    return STATUS_OK;
}

enum status cpu_rays_prepare(void *self, const struct job *job, struct reason *reason)
{
    ((struct cpu_rays *)self)->job = *job;
    return job->packed ? tri_store_check(job->packed->store, job->tri->id, job->tri->name, reason)
                       : STATUS_OK;
}

/* Bytes that the traversal reads: packed tree, vertices, indices. */
static uint64_t job_bytes(const struct job *job)
{
    uint64_t bytes = 0;
    if (!job->packed || tri_store_reads_scene(job->packed->store))
        bytes += 12 * ((uint64_t)job->scene->vertex_count + job->scene->tri_count);
    if (job->packed)
        bytes += packed_node_bytes(job->packed) + packed_item_bytes(job->packed);
    return bytes;
}

static enum status unfinished_rays(const struct job *job, uint64_t unfinished, size_t ray_count,
                                   long long last, struct reason *reason)
{
    if (!unfinished)
        return STATUS_OK;
    return fail(reason, STATUS_DEVICE,
                "%llu of %zu rays not finished: stack of %u or %u nodes exhausted, last ray %lld",
                (unsigned long long)unfinished, ray_count, job->packed->stack_need,
                job->packed->node_count, last);
}

enum status cpu_rays_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                           struct trace_report *report, struct reason *reason)
{
    struct cpu_rays *rays = self;
    const struct job *job = &rays->job;
    uint64_t boxes = 0, tris = 0, unfinished = 0;
    long long worst = 0;
    uint64_t start = time_ns();
#pragma omp parallel for schedule(dynamic, 64) num_threads(rays->threads) if (ray_count > 64)    \
    reduction(+ : boxes, tris, unfinished) reduction(max : worst)
    for (long long i = 0; i < (long long)ray_count; i++) {
        struct trace_counts counts = {0, 0};
        if (rays->answer(job, &ray[i], &hit[i], &counts)) {
            unfinished++;
            worst = i > worst ? i : worst;
        }
        boxes += counts.boxes;
        tris += counts.tris;
    }
    *report = (struct trace_report){
        .ns = time_ns() - start, .boxes = boxes, .tris = tris, .memory_bytes = job_bytes(job)};
    return unfinished_rays(job, unfinished, ray_count, worst, reason);
}

void cpu_rays_tasks(void *self, void (*run)(struct engine_task *task), struct engine_task *task,
                    size_t count)
{
    const struct cpu_rays *rays = self;
#pragma omp parallel for schedule(dynamic, 1)                                                      \
    num_threads(rays->threads) if (rays->threads > 1 && count > 1)
    for (long long i = 0; i < (long long)count; i++)
        run(&task[i]);
}

enum status cpu_rays_trace_all(void *self, const struct ray *ray, size_t ray_count,
                               uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                               struct reason *reason)
{
    struct cpu_rays *rays = self;
    const struct job *job = &rays->job;
    uint64_t unfinished = 0;
    long long worst = 0;
#pragma omp parallel for schedule(dynamic, 64) num_threads(rays->threads) if (ray_count > 64)    \
    reduction(+ : unfinished) reduction(max : worst)
    for (long long i = 0; i < (long long)ray_count; i++)
        if (rays->answer_all(job, &ray[i], capacity, hit + (size_t)i * capacity, &hit_count[i])) {
            unfinished++;
            worst = i > worst ? i : worst;
        }
    return unfinished_rays(job, unfinished, ray_count, worst, reason);
}

void cpu_rays_close(void *self)
{
    struct cpu_rays *rays = self;
    if (rays)
        free(rays->record);
    free(rays);
}

struct model cpu_rays_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self;
    return model_of_tri(tri, ROUNDING_IEEE, false);
}

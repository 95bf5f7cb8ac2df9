/* Shared by the engines that trace single rays in C: rays are spread over threads and counts are
 * added up. */
#ifndef CPU_RAYS_H
#define CPU_RAYS_H

#include "ref/engine.h"
#include "ref/trace/trace.h"

/* Traces one ray; called from several threads at once. Errors: STATUS_LIMIT not finished. */
typedef enum status cpu_ray_fn(const struct job *job, const struct ray *ray, struct hit *hit,
                               struct trace_counts *counts);

/* Finds all hits of one ray, as trace_ray_all; called from several threads at once. */
typedef enum status cpu_ray_all_fn(const struct job *job, const struct ray *ray, uint32_t capacity,
                                   struct hit *hit, uint32_t *count);

/* The open engine. */
struct cpu_rays {
    cpu_ray_fn *answer;
    cpu_ray_all_fn *answer_all;
    unsigned threads;
    struct job job;
    struct world_job world;         /* ref/engines/cpu_worlds.c */
    struct instance_record *record; /* of the world, if it has no packed one; owned */
};

/* The number of threads that `options` sets, at least 1. */
unsigned cpu_rays_threads(const struct engine_options *options);

/* Implementations of engine.open, .prepare, .trace, .trace_all, .close and .model that call
 * `answer` and `answer_all`; see ref/engine.h. */
enum status cpu_rays_open(const struct engine_options *options, cpu_ray_fn *answer,
                          cpu_ray_all_fn *answer_all, void **self, struct reason *reason) MUST_USE;
enum status cpu_rays_prepare(void *self, const struct job *job, struct reason *reason);
enum status cpu_rays_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                           struct trace_report *report, struct reason *reason);
enum status cpu_rays_trace_all(void *self, const struct ray *ray, size_t ray_count,
                               uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                               struct reason *reason);
/* Runs `run` on every task. A task is run by one thread. */
void cpu_rays_tasks(void *self, void (*run)(struct engine_task *task), struct engine_task *task,
                    size_t count);
void cpu_rays_close(void *self);
struct model cpu_rays_model(const struct engine *engine, void *self, const struct tri_test *tri);

#endif

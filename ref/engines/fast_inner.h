/* The engine `fast`, on scenes (engine_fast.c) and on worlds (fast_worlds.c), and `fast_small`. */
#ifndef FAST_INNER_H
#define FAST_INNER_H

#include "ref/engine.h"
#include "ref/fast/fast_world.h"

#define FAST_CHUNK 512 /* rays of a thread's unit of work */

struct layout;

struct fast {
    struct fast_tree tree;
    struct fast_world world; /* either it or the tree is empty */
    const struct fast_kernel *kernel;
    unsigned threads;
    bool alone;
    bool small; /* trees are small or tiny ones: fast_form_of */
    enum query query;
};

/* Rays of unit `chunk` of a job of `count`, which begin at chunk * FAST_CHUNK. */
static inline size_t fast_chunk(size_t chunk, size_t count)
{
    size_t left = count - chunk * FAST_CHUNK;
    return left < FAST_CHUNK ? left : FAST_CHUNK;
}

/* What the engines share: functions of struct engine, and `open` for plain trees, or small
 * and tiny ones. */
enum status fast_engine_open(const struct engine_options *options, bool small, void **self,
                             struct reason *reason) MUST_USE;
enum status fast_prepare(void *self, const struct job *job, struct reason *reason) MUST_USE;
enum status fast_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                       struct trace_report *report, struct reason *reason) MUST_USE;
enum status fast_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                           struct hit *hit, uint32_t *hit_count, struct reason *reason) MUST_USE;
struct model fast_model(const struct engine *engine, void *self, const struct tri_test *tri);
void fast_close(void *self);

/* Errors: STATUS_UNSUPPORTED a layout as published. */
enum status fast_takes_layout(const struct layout *layout, const char *engine,
                              struct reason *reason) MUST_USE;

extern const struct world_tracer fast_worlds;

#endif

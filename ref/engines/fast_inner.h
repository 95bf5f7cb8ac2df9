/* The engine `fast`, on scenes (engine_fast.c) and on worlds (fast_worlds.c). */
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
    enum query query;
};

/* Rays of unit `chunk` of a job of `count`, which begin at chunk * FAST_CHUNK. */
static inline size_t fast_chunk(size_t chunk, size_t count)
{
    size_t left = count - chunk * FAST_CHUNK;
    return left < FAST_CHUNK ? left : FAST_CHUNK;
}

/* Errors: STATUS_UNSUPPORTED a layout as published. */
enum status fast_takes_layout(const struct layout *layout, struct reason *reason) MUST_USE;

extern const struct world_tracer fast_worlds;

#endif

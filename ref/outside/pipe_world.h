/* Worlds as ref/outside/pipe.h sends them, and what is answered about one. */
#ifndef PIPE_WORLD_H
#define PIPE_WORLD_H

#include "ref/world/world.h"

#define PIPE_NO_CUSTOM 0xFFFFFFFFu /* the peer keeps no custom indices */

/* One ray of a request, one hit of an answer. */
struct pipe_world_ray {
    struct ray ray;
    struct ray_mode mode;
};

struct pipe_world_hit {
    float t, u, v;
    uint32_t instance; /* ABI_NO_PRIM: a miss */
    uint32_t geometry; /* of its mesh */
    uint32_t triangle; /* of the geometry */
    uint32_t side;     /* 1: the front */
    uint32_t custom;   /* or PIPE_NO_CUSTOM */
};

/* What follows the head of a request: filter, meshes, instances, *size bytes. The caller frees it.
 * NULL: no memory. */
char *pipe_world_words(const struct world *world, size_t *size) MUST_USE;

/* Converts an answer to a hit and its tag, as engines give them. t, u and v may be anything: the
 * judge finds wrong ones; so does it with a custom index that is not the instance's. An answer of
 * one that keeps none has the right one.
 *   unnamed   a hit names no triangle
 * Errors: STATUS_INPUT "names instance 7 of 3", "names ... of instance 1, which has no mesh",
 * "has side 2 ...", a miss that has more; then the hit is a miss. */
enum status pipe_world_take(const struct world *world, const struct pipe_world_hit *answer,
                            bool unnamed, struct hit *hit, uint32_t *tag,
                            struct reason *reason) MUST_USE;

#endif

/* Worlds over a pipe: the world and rays that the suites use, and their engine. Includes
 * cmocka.h. */
#ifndef TESTS_WORLD_PIPED_H
#define TESTS_WORLD_PIPED_H

#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"
#include "tests/outside/world_peers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include "tests/outside/peer_engine.h"

#define RAYS 400

static struct world world;
static struct ray *ray;
static struct ray_mode *mode;

static inline struct world_job job_of(enum query query)
{
    return (struct world_job){.world = &world, .tri = tri_test_find("mt"), .query = query};
}

/* What a tracer without a defect answers to ray i. */
static inline void look_at(const struct world_look *look, enum query query, size_t i,
                           struct hit *hit, uint32_t *tag)
{
    const struct hit none = {.prim = ABI_NO_PRIM};
    world_look_trace(look, query, &ray[i], mode[i], &none, hit, tag);
}

static inline int make_world(void **state)
{
    (void)state;
    struct reason reason = {""};
    if (world_open("mixed", 1, &world, &reason) ||
        world_rays_new(&world, ray_sets[0], RAY_MODES_MIXED, 1, RAYS, &ray, &mode, &reason)) {
        print_error("%s\n", reason.text);
        return -1;
    }
    return 0;
}

static inline int free_world(void **state)
{
    (void)state;
    world_free(&world);
    free(ray);
    free(mode);
    return 0;
}

#endif

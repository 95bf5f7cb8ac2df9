/* A world of everything and its rays, for tests of tracers that are given one. Define RAYS before
 * it; include after cmocka.h. */
#ifndef SUPPORT_MIXED_RAYS_H
#define SUPPORT_MIXED_RAYS_H

#include "ref/engine.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <stdlib.h>

static struct world world;
static struct ray *ray;
static struct ray_mode *mode;

static inline struct world_job job_of(enum query query)
{
    return (struct world_job){.world = &world, .tri = tri_test_find("mt"), .query = query};
}

/* Opens the engine, prepares the world and traces its rays so many times; the first status that is
 * not OK. */
static inline enum status play_world(const struct engine *engine,
                                     const struct engine_options *options, enum query query,
                                     int times, struct hit *hit, uint32_t *tag, struct model *model,
                                     struct reason *reason)
{
    const struct world_job job = job_of(query);
    struct trace_report report;
    void *self;
    enum status status = engine_open(engine, options, &self, reason);
    if (status)
        return status;
    status = engine->worlds->prepare_world(self, &job, reason);
    for (int i = 0; i < times && !status; i++)
        status = engine->worlds->trace_world(self, ray, mode, RAYS, hit, tag, &report, reason);
    if (model)
        *model = engine_model(engine, self, job.tri);
    engine->close(self);
    return status;
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

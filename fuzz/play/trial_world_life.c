#include "fuzz/play/trial_world_life.h"

#include "ref/engine.h"
#include "scenes/world_steps.h"

#include <stdlib.h>
#include <string.h>

enum status trial_world_unmove(struct fuzz_trial *trial, const struct step *step,
                               struct reason *reason)
{
    struct trial_meshes meshes;
    if (!motion_is_of_worlds(step->motion)) {
        motion_apply(step, &trial->scene);
        return STATUS_OK;
    }
    enum status status = trial_meshes_make(&trial->world, &trial->scene, &meshes, reason);
    if (status)
        return status;
    status = world_motion_apply(step, &meshes.world, reason);
    if (!status && trial->world.instance_count > 0)
        memcpy(trial->world.instance, meshes.world.instance,
               trial->world.instance_count * sizeof *trial->world.instance);
    trial_meshes_free(&meshes);
    return status;
}

enum status trial_world_life_make(const struct fuzz_trial *trial, struct trial_world_life *out,
                                  struct reason *reason)
{
    *out = (struct trial_world_life){.count = 0};
    if (trial->step_count == 0 || !trial->world.is)
        return STATUS_OK;
    out->count = trial->step_count;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i <= trial->step_count && !status; i++) {
        struct fuzz_trial cut;
        status = trial_life_cut(trial, i, &cut, reason);
        if (!status)
            status = trial_meshes_make(&cut.world, &cut.scene, &out->meshes[i], reason);
        fuzz_trial_free(&cut);
    }
    if (status)
        trial_world_life_free(out);
    return status;
}

void trial_world_life_free(struct trial_world_life *life)
{
    for (uint32_t i = 0; i <= life->count && life->count > 0; i++)
        trial_meshes_free(&life->meshes[i]);
    *life = (struct trial_world_life){.count = 0};
}

enum status trial_world_life_trees(const struct fuzz_trial *trial,
                                   const struct trial_world_life *life, const struct layout *layout,
                                   struct world_life *out, struct reason *reason)
{
    struct world_build build = {.top = trial->builder,
                                .bottom = trial->builder,
                                .top_options = trial->build,
                                .bottom_options = trial->build};
    const struct world_recipe recipe = {&build, layout, layout, trial->store};
    build.top_options.threads = build.bottom_options.threads = 1; /* as of trial_life_trees */
    uint32_t made = 0;
    enum status status = world_life_begin(&recipe, &life->meshes[0].world, &out[0], reason);
    while (!status && made < life->count) {
        status = world_life_step(&recipe, trial->step[made].act, &life->meshes[made + 1].world,
                                 &out[made], &out[made + 1], reason);
        made++;
    }
    for (uint32_t i = 0; i <= made && status; i++)
        world_life_free(&out[i]);
    return status;
}

static bool is_refitted(const struct fuzz_trial *trial, const struct world_life *lived,
                        uint32_t step)
{
    if (step == 0)
        return false;
    return lived ? lived[step].fate == LIFE_REFITTED : trial->step[step - 1].act == LIFE_REFIT;
}

enum status trial_world_life_prepare(const struct fuzz_trial *trial,
                                     const struct trial_world_life *life,
                                     const struct world_life *lived, const struct engine *engine,
                                     void *self, const struct world_job *last,
                                     struct reason *reason)
{
    struct hit *unused = alloc_zeroed(trial->ray_count, sizeof *unused);
    uint32_t *tag = alloc_zeroed(trial->ray_count, sizeof *tag);
    enum status status = STATUS_OK;
    if (!unused || !tag)
        status = fail(reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
    for (uint32_t i = 0; i < life->count && !status; i++) {
        struct trace_report report = {0};
        struct world_job job = *last;
        job.world = &life->meshes[i].world;
        job.packed = lived ? &lived[i].packed : NULL;
        status = engine_follow_world(engine, self, &job, is_refitted(trial, lived, i), reason);
        if (!status)
            status = engine->worlds->trace_world(self, trial->ray, trial->world.mode,
                                                 trial->ray_count, unused, tag, &report, reason);
    }
    free(unused);
    free(tag);
    if (status)
        return status;
    return engine_follow_world(engine, self, last, is_refitted(trial, lived, life->count), reason);
}

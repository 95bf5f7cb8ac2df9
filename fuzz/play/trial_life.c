#include "fuzz/play/trial_life.h"

#include "fuzz/play/trial_world_life.h"
#include "ref/engine.h"

#include <stdlib.h>
#include <string.h>

enum status trial_life_make(const struct fuzz_trial *trial, struct trial_life *out,
                            struct reason *reason)
{
    *out = (struct trial_life){.count = 0};
    if (trial->step_count == 0 || trial->world.is)
        return STATUS_OK;
    enum status status =
        steps_scenes_back(&trial->scene, trial->step, trial->step_count, out->scene, reason);
    out->count = status ? 0 : trial->step_count;
    return status;
}

void trial_life_free(struct trial_life *life)
{
    if (life->count > 0)
        steps_free(life->scene, life->count);
    *life = (struct trial_life){.count = 0};
}

enum status trial_life_trees(const struct fuzz_trial *trial, const struct trial_life *life,
                             const struct layout *layout, struct life_tree *tree,
                             struct reason *reason)
{
    struct build_options build = trial->build;
    const struct life_recipe recipe = {trial->builder, &build, trial->store, layout};
    build.threads = 1; /* trials are small and workers many */
    uint32_t made = 0;
    enum status status = life_begin(&recipe, &life->scene[0], &tree[0], reason);
    while (!status && made < life->count) {
        status = life_step(&recipe, trial->step[made].act, &life->scene[made + 1], &tree[made],
                           &tree[made + 1], reason);
        made++;
    }
    for (uint32_t i = 0; i <= made && status; i++)
        life_tree_free(&tree[i]);
    return status;
}

static void drop_steps(struct fuzz_trial *trial, uint32_t from)
{
    memset(trial->step + from, 0, sizeof *trial->step * (LIFE_STEPS_MOST - from));
    trial->step_count = from;
}

/* The same of a trial of a world, which *out is a copy of. */
static enum status cut_world(uint32_t step, struct fuzz_trial *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t i = out->step_count; i > step && !status; i--)
        status = trial_world_unmove(out, &out->step[i - 1], reason);
    if (status)
        fuzz_trial_free(out);
    else
        drop_steps(out, step);
    return status;
}

enum status trial_life_cut(const struct fuzz_trial *trial, uint32_t step, struct fuzz_trial *out,
                           struct reason *reason)
{
    struct trial_life life;
    enum status status = fuzz_trial_copy(trial, out, reason);
    if (status || step == trial->step_count)
        return status;
    if (trial->world.is)
        return cut_world(step, out, reason);
    status = trial_life_make(trial, &life, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    memcpy(out->scene.vertex, life.scene[step].vertex,
           3 * sizeof *out->scene.vertex * out->scene.vertex_count);
    drop_steps(out, step);
    trial_life_free(&life);
    return STATUS_OK;
}

static bool is_refitted(const struct fuzz_trial *trial, const struct life_tree *tree, uint32_t step)
{
    if (step == 0)
        return false;
    return tree ? tree[step].fate == LIFE_REFITTED : trial->step[step - 1].act == LIFE_REFIT;
}

enum status trial_life_prepare(const struct fuzz_trial *trial, const struct trial_life *life,
                               const struct life_tree *tree, const struct engine *engine,
                               void *self, const struct job *last, struct reason *reason)
{
    struct hit *unused = alloc_zeroed(trial->ray_count, sizeof *unused);
    enum status status =
        unused ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
    for (uint32_t i = 0; i < life->count && !status; i++) {
        struct trace_report report = {0};
        struct job job = *last;
        job.scene = &life->scene[i];
        job.packed = tree ? &tree[i].packed : NULL;
        status = engine_follow(engine, self, &job, is_refitted(trial, tree, i), reason);
        if (!status)
            status = engine->trace(self, trial->ray, trial->ray_count, unused, &report, reason);
    }
    free(unused);
    if (status)
        return status;
    return engine_follow(engine, self, last, is_refitted(trial, tree, life->count), reason);
}

enum status trial_life_enter(const struct fuzz_trial *trial, const struct engine *engine,
                             void *self, const struct job *last, struct reason *reason)
{
    struct trial_life life;
    struct life_tree tree[LIFE_STEPS_MOST + 1] = {{.fate = LIFE_BUILT}};
    if (trial->step_count == 0)
        return engine->prepare(self, last, reason);
    enum status status = trial_life_make(trial, &life, reason);
    if (!status && last->packed)
        status = trial_life_trees(trial, &life, last->packed->layout, tree, reason);
    if (!status)
        status = trial_life_prepare(trial, &life, last->packed ? tree : NULL, engine, self, last,
                                    reason);
    for (uint32_t i = 0; last->packed && i <= life.count && life.count > 0; i++)
        life_tree_free(&tree[i]);
    trial_life_free(&life);
    return status;
}

#include "fuzz/play/trial_tree.h"

#include "fuzz/play/trial_life.h"
#include "ref/packed/refit.h"
#include "scenes/move.h"

#include <stdlib.h>
#include <string.h>

/* Trials are small and workers many: a tree does not depend on the number of threads. */
static struct build_options single(const struct fuzz_trial *trial)
{
    struct build_options build = trial->build;
    build.threads = 1;
    return build;
}

static enum status build_of(const struct fuzz_trial *trial, const struct scene *scene,
                            struct bvh *out, struct reason *reason)
{
    const struct build_options build = single(trial);
    return bvh_build(trial->builder, scene, &build, out, reason);
}

/* The scene as it was when the tree was built; shares the triangles. `vertex` is to be freed. */
static enum status rest_of(const struct fuzz_trial *trial, struct scene *out, float **vertex,
                           struct reason *reason)
{
    size_t bytes = 3 * sizeof **vertex * (size_t)trial->scene.vertex_count;
    *out = trial->scene;
    *vertex = malloc(bytes + 1);
    if (!*vertex)
        return fail(reason, STATUS_MEMORY, "no memory for the vertices of a scene at rest");
    if (bytes > 0)
        memcpy(*vertex, trial->scene.vertex, bytes);
    out->vertex = *vertex;
    scene_move(out, trial->move, trial->move_seed);
    return STATUS_OK;
}

/* Of a trial with steps: the tree of its first scene. */
static enum status build_first(const struct fuzz_trial *trial, struct bvh *out,
                               struct reason *reason)
{
    struct trial_life life;
    enum status status = trial_life_make(trial, &life, reason);
    if (!status)
        status = build_of(trial, &life.scene[0], out, reason);
    trial_life_free(&life);
    return status;
}

enum status fuzz_trial_build(const struct fuzz_trial *trial, struct bvh *out, struct reason *reason)
{
    struct scene rest;
    float *vertex;
    *out = (struct bvh){0};
    if (trial->step_count > 0)
        return build_first(trial, out, reason);
    if (!(trial->move > 0))
        return build_of(trial, &trial->scene, out, reason);
    enum status status = rest_of(trial, &rest, &vertex, reason);
    if (!status)
        status = build_of(trial, &rest, out, reason);
    free(vertex);
    return status;
}

enum status fuzz_trial_pack(const struct fuzz_trial *trial, const struct layout *layout,
                            const struct bvh *bvh, struct packed *out, struct reason *reason)
{
    return packed_make_stored(layout, trial->store, bvh, &trial->scene, out, reason);
}

/* As it would be had it never moved. */
static enum status build_anew(const struct fuzz_trial *trial, const struct layout *layout,
                              struct bvh *bvh, struct packed *out, struct reason *reason)
{
    packed_free(out);
    bvh_free(bvh);
    enum status status = build_of(trial, &trial->scene, bvh, reason);
    return status ? status : fuzz_trial_pack(trial, layout, bvh, out, reason);
}

static enum status refit(const struct fuzz_trial *trial, struct bvh *bvh, struct packed *out,
                         struct reason *reason)
{
    enum status status = packed_refit(out, &trial->scene, reason);
    if (!status)
        status = bvh_refit(bvh, &trial->scene, reason);
    return status;
}

enum trial_motion fuzz_trial_motion(enum life_fate fate)
{
    static const enum trial_motion of[] = {[LIFE_BUILT] = TRIAL_STILL,
                                           [LIFE_REFITTED] = TRIAL_REFITTED,
                                           [LIFE_REBUILT] = TRIAL_REBUILT,
                                           [LIFE_FORCED] = TRIAL_REBUILT};
    return of[fate];
}

/* The tree after the last step. */
static enum status tree_of_life(const struct fuzz_trial *trial, const struct layout *layout,
                                struct bvh *bvh, struct packed *out, enum trial_motion *motion,
                                struct reason *reason)
{
    struct trial_life life;
    struct life_tree tree[LIFE_STEPS_MOST + 1];
    enum status status = trial_life_make(trial, &life, reason);
    if (!status)
        status = trial_life_trees(trial, &life, layout, tree, reason);
    if (!status) {
        const struct life_tree *last = &tree[life.count];
        *bvh = last->bvh;
        *out = last->packed;
        *motion = fuzz_trial_motion(last->fate);
        for (uint32_t i = 0; i < life.count; i++)
            life_tree_free(&tree[i]);
    }
    trial_life_free(&life);
    return status;
}

enum status fuzz_trial_tree(const struct fuzz_trial *trial, const struct layout *layout,
                            struct bvh *bvh, struct packed *out, enum trial_motion *motion,
                            struct reason *reason)
{
    enum trial_motion unused;
    struct scene rest;
    float *vertex = NULL;
    enum trial_motion what = trial->move > 0 ? TRIAL_REFITTED : TRIAL_STILL;
    *bvh = (struct bvh){0};
    *out = (struct packed){0};
    if (trial->step_count > 0)
        return tree_of_life(trial, layout, bvh, out, motion ? motion : &unused, reason);
    enum status status = rest_of(trial, &rest, &vertex, reason);
    if (!status)
        status = build_of(trial, &rest, bvh, reason);
    if (!status)
        status = packed_make_stored(layout, trial->store, bvh, &rest, out, reason);
    if (!status && what == TRIAL_REFITTED) {
        status = refit(trial, bvh, out, reason);
        if (status == STATUS_LIMIT) {
            what = TRIAL_REBUILT;
            status = build_anew(trial, layout, bvh, out, reason);
        }
    }
    free(vertex);
    if (status) {
        packed_free(out);
        bvh_free(bvh);
    }
    if (motion)
        *motion = what;
    return status;
}

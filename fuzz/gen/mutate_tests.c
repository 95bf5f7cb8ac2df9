/* Edits of how a trial is built and tested. Members as published come only into trials that have
 * one. */
#include "fuzz/gen/gen_members.h"
#include "fuzz/gen/mutate_inner.h"

static bool is_faithful(const struct fuzz_trial *trial)
{
    return trial->builder->faithful || trial->box->faithful || trial->tri->faithful;
}

enum status edit_leaf(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t leaf = gen_leaf(rng, is_faithful(trial));
    *changed = leaf != trial->build.leaf;
    trial->build.leaf = leaf;
    return STATUS_OK;
}

enum status edit_builder(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    const struct builder *builder = gen_builder(rng, is_faithful(trial));
    *changed = builder != trial->builder;
    trial->builder = builder;
    if (!builder_takes(builder, "presplit"))
        trial->build.presplit = 0;
    return STATUS_OK;
}

enum status edit_box(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    const struct box_test *box = gen_box_test(rng, is_faithful(trial));
    *changed = box != trial->box;
    trial->box = box;
    return STATUS_OK;
}

enum status edit_tri(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    const struct tri_test *tri = gen_tri_test(rng, is_faithful(trial));
    *changed = tri != trial->tri;
    trial->tri = tri;
    return STATUS_OK;
}

enum status edit_query(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng;
    trial->query = trial->query == QUERY_ANY ? QUERY_CLOSEST : QUERY_ANY;
    *changed = true;
    return STATUS_OK;
}

/* The tree is built of the scene at rest and refitted to the scene as it is; or no longer. No world
 * moves, and no trial with steps. */
enum status edit_refit(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint64_t seed = rng_below(rng, 1000);
    float move = gen_move(rng);
    bool still = trial->move > 0;
    if (trial->world.is || trial->step_count > 0)
        return STATUS_OK;
    trial->move = still ? 0 : move;
    trial->move_seed = still ? 0 : seed;
    *changed = true;
    return STATUS_OK;
}

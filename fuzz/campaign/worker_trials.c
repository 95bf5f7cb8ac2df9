/* The trials of an order, and the members that are drawn for them. */
#include "fuzz/campaign/worker.h"

#include "fuzz/gen/gen_members.h"
#include "ref/scene/quantise.h"
#include "ref/base/rng.h"

/* Mutants have one to so many edits. */
#define EDITS_MOST 4u

static enum status mutate(const struct work_rules *rules, uint64_t index,
                          const struct fuzz_trial *base, struct fuzz_trial *out,
                          struct reason *reason)
{
    struct rng of_seed = rng_make(rules->seed, 0x6D757400u + GEN_SALT);
    struct rng rng = rng_make(rng_u64(&of_seed), index);
    uint32_t edits = 1 + rng_below(&rng, EDITS_MOST);
    enum status status = fuzz_trial_copy(base, out, reason);
    for (uint32_t i = 0; i < edits && !status; i++)
        status = gen_mutate(&rng, out, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    out->origin.seed = rules->seed;
    out->origin.index = index;
    out->origin.version = GEN_VERSION;
    out->origin.mutated = true;
    return STATUS_OK;
}

/* An edit, or the rules' builder, may not go with what the base of a mutant has. */
static void settle(struct fuzz_trial *trial)
{
    if (trial->builder->faithful)
        trial->build.passes = 0;
    if (!builder_takes(trial->builder, "presplit"))
        trial->build.presplit = 0;
    if (!tri_store_answers(trial->store, trial->tri->id))
        trial->store = tri_stores[0];
}

enum status work_trial_make(const struct work_rules *rules, enum work_stream stream, uint64_t index,
                            const struct fuzz_trial *base, struct fuzz_trial *out,
                            struct reason *reason)
{
    enum status status = STATUS_INTERNAL;
    *out = (struct fuzz_trial){0};
    switch (stream) {
    case WORK_CORPUS:
        return fuzz_trial_copy(&rules->corpus[index], out, reason);
    case WORK_KEPT:
        return fuzz_trial_copy(&rules->kept[index], out, reason);
    case WORK_GIVEN:
        return fuzz_trial_copy(base, out, reason);
    case WORK_GEN:
        status = gen_trial(rules->seed, index, &rules->gen, out, reason);
        break;
    case WORK_MUT:
        status = mutate(rules, index, base, out, reason);
        if (!status && rules->gen.steps && out->step_count == 0 && !(out->move > 0))
            gen_steps(rules->seed, index, true, out);
        break;
    }
    if (!status && rules->builder_count > 0)
        out->builder = rules->builder[index % rules->builder_count];
    if (!status)
        settle(out);
    return status;
}

/* Moves the vertices to what a lossy storage can hold. A scene that is too large for it stays. */
static enum status lose_precision(const struct lossy *lossy, struct rng *rng,
                                  struct fuzz_trial *trial, struct reason *reason)
{
    uint32_t bits = lossy->bits_least + rng_below(rng, lossy->bits_most - lossy->bits_least + 1);
    struct scene scene;
    struct quantised quantised;
    enum status status = lossy->move(&trial->scene, bits, &scene, &quantised, reason);
    if (status)
        return status == STATUS_LIMIT ? STATUS_OK : status;
    scene_free(&trial->scene);
    trial->scene = scene;
    return STATUS_OK;
}

/* Gives a trial of stream gen the members drawn, and what they need: passes of optimization, a
 * motion, what a lossy storage can hold. A pure function of rules, index and draw.
 * Errors: STATUS_MEMORY. */
static enum status draw_members(const struct work_rules *rules, uint64_t index,
                                const struct work_draw *draw, struct fuzz_trial *trial,
                                struct reason *reason)
{
    struct rng of_seed = rng_make(rules->seed, 0x64726177u + GEN_SALT);
    struct rng rng = rng_make(rng_u64(&of_seed), index);
    trial->builder = draw->builder;
    trial->store = draw->store;
    trial->tri = draw->tri;
    trial->box = draw->box;
    trial->query = draw->query;
    if (!draw->builder->faithful)
        trial->build.eps = BUILD_EPS_DEFAULT;
    if (!builder_takes(draw->builder, "presplit"))
        trial->build.presplit = 0;
    if (draw->optimized > 0)
        trial->build.passes = 1 + rng_below(&rng, BUILD_PASSES_DEFAULT);
    trial->build.rotates = draw->optimized > 1;
    if (draw->moved || draw->store->head)
        trial->step_count = 0; /* nor are other vertices on a grid */
    if (draw->moved) {
        trial->move = gen_move(&rng);
        trial->move_seed = rng_below(&rng, 1000);
    }
    const struct lossy *lossy = draw->store->lossy;
    return lossy ? lose_precision(lossy, &rng, trial, reason) : STATUS_OK;
}

size_t work_contestant(const struct fuzz_field *field, const struct fuzz_signature *signature)
{
    size_t i = 0;
    for (; i < field->count; i++) {
        struct fuzz_signature mine = *signature;
        fuzz_signature_set_engine(&mine, field->who[i].engine->name);
        mine.layout = field->drawn && field->who[i].engine->needs_packed ? signature->layout
                                                                         : field->who[i].layout;
        if (fuzz_signature_same(&mine, signature))
            break;
    }
    return i;
}

enum status work_trial_ordered(const struct work_rules *rules, const struct work_order *order,
                               uint32_t i, const struct fuzz_trial *base, struct fuzz_trial *out,
                               struct reason *reason)
{
    enum status status = work_trial_make(rules, order->stream, order->first + i, base, out, reason);
    if (!status && order->draw.on) {
        status = draw_members(rules, order->first + i, &order->draw, out, reason);
        if (status)
            fuzz_trial_free(out);
    }
    return status;
}

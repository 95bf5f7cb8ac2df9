#include "tests/truth/world_play.h"

#include "ref/judge/judge_world.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"
#include "tests/exact/gmp_world_redecide.h"

#include <stdlib.h>

enum status world_ground_make(struct world_ground *ground, size_t rays_most,
                              const struct builder *builder, const struct build_options *options,
                              struct reason *reason)
{
    const struct world_build how = {
        .top = builder, .bottom = builder, .top_options = *options, .bottom_options = *options};
    enum status status = oracle_make_world(&ground->world, &ground->oracle, reason);
    if (!status)
        status = world_trees_make(&ground->world, &how, &ground->trees, reason);
    ground->truth = alloc_zeroed(rays_most, sizeof *ground->truth);
    ground->hit = alloc_zeroed(rays_most, sizeof *ground->hit);
    ground->tag = alloc_zeroed(rays_most, sizeof *ground->tag);
    ground->judgement = alloc_zeroed(rays_most, sizeof *ground->judgement);
    if (!status && !(ground->truth && ground->hit && ground->tag && ground->judgement))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", rays_most);
    return status;
}

void world_ground_free(struct world_ground *ground)
{
    free(ground->truth);
    free(ground->hit);
    free(ground->tag);
    free(ground->judgement);
    oracle_free(ground->oracle);
    world_trees_free(&ground->trees);
    world_free(&ground->world);
}

/* Decides the wrong answers again. */
static enum status follow_up(const struct world_ground *ground, const struct tally_contestant *who,
                             const struct model *model, struct tally *tally)
{
    size_t count = 0;
    uint32_t *at = malloc(ground->count * sizeof *at);
    uint8_t *opinion = malloc(ground->count);
    bool done = at && opinion;
    for (size_t i = 0; done && i < ground->count; i++)
        if (ground->judgement[i].verdict == VERDICT_WRONG)
            at[count++] = (uint32_t)i;
#pragma omp parallel for schedule(dynamic, 4)
    for (long long n = 0; n < (long long)count; n++) {
        const uint32_t i = at[n];
        const struct gmp_world_question question = {.world = &ground->world,
                                                    .ray = &ground->ray[i],
                                                    .mode = ground->mode[i],
                                                    .model = model,
                                                    .any = ground->query == QUERY_ANY,
                                                    .hit = &ground->hit[i],
                                                    .tag = ground->tag[i]};
        opinion[n] = (uint8_t)gmp_world_redecide(&question).opinion;
    }
    for (size_t n = 0; n < count; n++) {
        const uint32_t i = at[n];
        struct wrong_answer wrong = {.who = *who,
                                     .cause = CAUSE_UNEXPLAINED,
                                     .rays = ground->rays,
                                     .index = i,
                                     .seed = ground->seed,
                                     .ray = ground->ray[i],
                                     .hit = ground->hit[i],
                                     .mode = ground->mode[i],
                                     .tag = ground->tag[i],
                                     .judgement = ground->judgement[i],
                                     .opinion = opinion[n]};
        snprintf(wrong.scene, sizeof wrong.scene, "%s", ground->spec);
        (void)tally_add(tally, &wrong);
    }
    free(at);
    free(opinion);
    return done ? STATUS_OK : STATUS_MEMORY;
}

static enum status judge_all(const struct world_ground *ground, const struct model *model,
                             struct play_result *out, struct reason *reason)
{
    struct judge *judge;
    int bad = 0;
    enum status status = judge_make(ground->oracle, model, ground->query, &judge, reason);
    if (status)
        return status;
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : bad)
    for (long long i = 0; i < (long long)ground->count; i++)
        bad +=
            judge_world_answer(judge, &ground->ray[i], ground->mode[i], &ground->truth[i],
                               &ground->hit[i], ground->tag[i], &ground->judgement[i]) != STATUS_OK;
    judge_free(judge);
    if (bad)
        return fail(reason, STATUS_MEMORY, "no memory to judge %d answers", bad);
    play_count(out, ground->hit, ground->judgement, ground->count);
    return STATUS_OK;
}

enum status world_play(const struct world_ground *ground, const struct tally_contestant *who,
                       struct pool *pool, struct tally *tally, struct play_result *out,
                       struct reason *reason)
{
    struct packed_world packed = {.mesh_count = 0};
    struct world_job job = {
        .world = &ground->world, .box = who->box, .tri = who->tri, .query = ground->query};
    struct trace_report report;
    enum status status = STATUS_OK;
    *out = (struct play_result){0};
    void *self = pool_get(pool, who->engine, &status, reason);
    if (!status && who->layout) {
        status = packed_world_make(&ground->world, &ground->trees, who->layout, who->layout,
                                   tri_stores[0], &packed, reason);
        job.packed = &packed;
    }
    if (!status)
        status = who->engine->worlds->prepare_world(self, &job, reason);
    if (status) {
        packed_world_free(&packed);
        out->refused = status == STATUS_LIMIT || status == STATUS_UNSUPPORTED;
        return out->refused ? STATUS_OK : status;
    }
    status = who->engine->worlds->trace_world(self, ground->ray, ground->mode, ground->count,
                                              ground->hit, ground->tag, &report, reason);
    const struct model model = engine_model(who->engine, self, who->tri);
    if (!status)
        status = judge_all(ground, &model, out, reason);
    if (!status && out->verdict[VERDICT_WRONG] > 0)
        status = follow_up(ground, who, &model, tally);
    packed_world_free(&packed);
    return status;
}

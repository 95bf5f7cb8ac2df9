#include "fuzz/play/stage_world.h"

#include "ref/explain/judged.h"
#include "ref/judge/judge_world.h"
#include "ref/oracle/oracle_world.h"
#include "ref/twin/model.h"
#include "ref/two_level/world_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- trees ------------------------------------------------------------------------------------ */

static const struct world *world_of(const struct play_stage *stage)
{
    return &stage->world.meshes.world;
}

static enum status make_trees(struct play_stage *stage, struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    struct world_build build = {.top = trial->builder,
                                .bottom = trial->builder,
                                .top_options = trial->build,
                                .bottom_options = trial->build};
    /* Trials are small and workers many: a tree does not depend on the number of threads. */
    build.top_options.threads = build.bottom_options.threads = 1;
    enum status status = world_trees_make(world_of(stage), &build, &stage->world.trees, reason);
    stage->has_tree = status == STATUS_OK;
    if (!status || status == STATUS_LIMIT)
        return STATUS_OK;
    return status == STATUS_MEMORY ? status : fail(reason, STATUS_INTERNAL, "%s", reason->text);
}

/* The kind of fault as of a scene's tree. */
static enum packed_rule rule_of(const struct play_stage *stage, size_t i, enum world_rule rule)
{
    static const enum packed_rule rules[] = {
        [WORLD_NUMBERS] = PACKED_RESULT, [WORLD_RECORD] = PACKED_RECORD,
        [WORLD_BOX] = PACKED_BOUND,      [WORLD_PARTS] = PACKED_LOST,
        [WORLD_WIDTH] = PACKED_BOUND,    [WORLD_STACK] = PACKED_STACK};
    struct packed_faults faults = {.first = PACKED_SOUND};
    if (rule == WORLD_TOP)
        return PACKED_LOST; /* what packed_check knows of the top is about instances */
    if (rule != WORLD_BOTTOM)
        return rules[rule];
    for (uint32_t m = 0; m < world_of(stage)->mesh_count; m++)
        if (packed_check(&stage->world.packed[i].bottom[m], world_of(stage)->mesh[m].scene, &faults,
                         NULL) == STATUS_INPUT)
            break;
    return faults.first;
}

/* True if the trees are such as bytes can be made of: the bytes are at fault, not the builder. */
static bool is_sound(const struct play_stage *stage)
{
    const struct world_trees *trees = &stage->world.trees;
    bool sound = !stage->trial->builder->faithful;
    for (uint32_t m = 0; m < trees->mesh_count && sound; m++)
        sound = bvh_check(&trees->bottom[m], world_of(stage)->mesh[m].scene, NULL) == STATUS_OK;
    return sound;
}

/* Makes the trees of all steps; the last ones are what is traced. */
static enum status pack_life(struct play_stage *stage, const struct layout *layout, size_t i,
                             struct reason *reason)
{
    struct stage_world *world = &stage->world;
    const uint32_t last = world->life.count;
    world->lived[i] = alloc_zeroed(last + (size_t)1, sizeof *world->lived[i]);
    if (!world->lived[i])
        return fail(reason, STATUS_MEMORY, "no memory for the trees of a life");
    enum status status =
        trial_world_life_trees(stage->trial, &world->life, layout, world->lived[i], reason);
    if (status) {
        free(world->lived[i]);
        world->lived[i] = NULL;
        return status;
    }
    world->packed[i] = world->lived[i][last].packed;
    stage->motion[i] = fuzz_trial_motion(world->lived[i][last].fate);
    return STATUS_OK;
}

/* Frees them, with what is shared. */
static void clear_life(struct stage_world *world, size_t i)
{
    for (uint32_t k = 0; k <= world->life.count && world->lived[i]; k++)
        world_life_free(&world->lived[i][k]);
    if (world->lived[i])
        world->packed[i] = (struct packed_world){.mesh_count = 0};
    free(world->lived[i]);
    world->lived[i] = NULL;
}

static enum status pack(struct play_stage *stage, const struct layout *layout, size_t i,
                        struct reason *reason)
{
    struct world_faults faults;
    struct packed_world *packed = &stage->world.packed[i];
    enum status status = stage->world.life.count > 0
                             ? pack_life(stage, layout, i, reason)
                             : packed_world_make(world_of(stage), &stage->world.trees, layout,
                                                 layout, stage->trial->store, packed, reason);
    if (status == STATUS_LIMIT)
        return STATUS_OK;
    stage->has_packed[i] = status == STATUS_OK;
    if (!status)
        status = world_pack_check(world_of(stage), packed, &faults, reason);
    if (status != STATUS_INPUT || !stage->has_packed[i])
        return status;
    if (!is_sound(stage))
        return STATUS_OK;
    stage->fault[i] = FUZZ_KIND_TREE;
    stage->rule[i] = rule_of(stage, i, faults.first);
    snprintf(stage->said[i], FUZZ_SAID_MOST, "%.*s", FUZZ_SAID_MOST - 1, reason->text);
    return STATUS_OK;
}

enum status stage_world_set(struct play_stage *stage, const struct fuzz_player *player,
                            struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    struct instance_record *record = NULL;
    stage->has_tree = false;
    for (size_t i = 0; i < player->layout_count; i++) {
        stage->has_packed[i] = false;
        stage->motion[i] = TRIAL_STILL;
        stage->fault[i] = FUZZ_KIND_COUNT;
        stage->rule[i] = PACKED_SOUND;
        stage->said[i][0] = '\0';
    }
    enum status status =
        trial_meshes_make(&trial->world, &trial->scene, &stage->world.meshes, reason);
    if (!status)
        status = world_records_make(world_of(stage), &record, reason);
    free(record);
    stage->world.beyond = status == STATUS_LIMIT;
    if (stage->world.beyond)
        return STATUS_OK;
    if (!status)
        status = trial_world_life_make(trial, &stage->world.life, reason);
    if (!status)
        status = make_trees(stage, reason);
    for (size_t i = 0; i < player->layout_count && !status && stage->has_tree; i++) {
        status = pack(stage, player->layout[i], i, reason);
        if (status && status != STATUS_MEMORY)
            status = fail(reason, STATUS_INTERNAL, "a world's tree: %.200s", reason->text);
    }
    return status;
}

enum status stage_world_truth(struct play_stage *stage, struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    enum status status = oracle_make_world(world_of(stage), &stage->oracle, reason);
    if (status == STATUS_UNSUPPORTED)
        status = STATUS_INTERNAL; /* an engine left the float environment changed */
    if (status)
        return status;
    return oracle_closest_world(stage->oracle, ORACLE_TREE, ORACLE_CLOSED, trial->ray,
                                trial->world.mode, trial->ray_count, 1, stage->truth, NULL, reason);
}

void stage_world_clear(struct play_stage *stage)
{
    for (size_t i = 0; i < LAYOUTS_MOST; i++) {
        clear_life(&stage->world, i);
        packed_world_free(&stage->world.packed[i]);
    }
    trial_world_life_free(&stage->world.life);
    world_trees_free(&stage->world.trees);
    trial_meshes_free(&stage->world.meshes);
    stage->world.beyond = false;
}

bool stage_is_split(const struct play_stage *stage, size_t layout)
{
    return stage->trial->world.is ? stage->world.packed[layout].split : stage->packed[layout].split;
}

/* --- engines ---------------------------------------------------------------------------------- */

static struct world_job world_job_of(const struct play_stage *stage, const struct seat *seat)
{
    const struct fuzz_trial *trial = stage->trial;
    return (struct world_job){.world = world_of(stage),
                              .packed =
                                  seat->layout ? &stage->world.packed[seat->layout_index] : NULL,
                              .box = trial->box,
                              .tri = trial->tri,
                              .query = trial->query};
}

enum status stage_prepare(const struct play_stage *stage, const struct seat *seat,
                          struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    if (!trial->world.is) {
        const struct job job = stage_job(stage, seat);
        if (trial->step_count == 0)
            return seat->engine->prepare(seat->self, &job, reason);
        const struct life_tree *tree = seat->layout ? stage->tree[seat->layout_index] : NULL;
        return trial_life_prepare(trial, &stage->life, tree, seat->engine, seat->self, &job,
                                  reason);
    }
    if (!seat->engine->worlds)
        return fail(reason, STATUS_REFUSED, "%s traces scenes, not worlds", seat->engine->name);
    const struct world_job job = world_job_of(stage, seat);
    if (trial->step_count == 0)
        return seat->engine->worlds->prepare_world(seat->self, &job, reason);
    return trial_world_life_prepare(trial, &stage->world.life,
                                    seat->layout ? stage->world.lived[seat->layout_index] : NULL,
                                    seat->engine, seat->self, &job, reason);
}

enum status stage_trace(const struct play_stage *stage, const struct seat *seat, uint32_t first,
                        uint32_t count, struct answers *answers, struct trace_report *report,
                        struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    const struct ray *ray = trial->ray + first;
    struct hit *hit = answers->hit + first;
    if (!trial->world.is)
        return seat->engine->trace(seat->self, ray, count, hit, report, reason);
    return seat->engine->worlds->trace_world(seat->self, ray, trial->world.mode + first, count, hit,
                                             answers->tag + first, report, reason);
}

/* --- states and causes ------------------------------------------------------------------------ */

void stage_world_cover(const struct play_stage *stage, const struct fuzz_player *player,
                       uint64_t map[COVERAGE_WORDS])
{
    const struct fuzz_trial *trial = stage->trial;
    const struct world_trees *trees = &stage->world.trees;
    const struct box empty = box_empty();
    const struct box *root = trees->top.node_count ? &trees->top.node[0].bounds : &empty;
    for (uint32_t i = 0; i < trial->ray_count; i++)
        coverage_add_truth(map, &trial->ray[i], root, &stage->truth[i]);
    for (uint32_t m = 0; m < trees->mesh_count && stage->has_tree; m++)
        coverage_add_tree(map, trial, &trees->bottom[m]);
    for (size_t i = 0; i < player->layout_count; i++) {
        const struct packed_world *packed = &stage->world.packed[i];
        if (!stage->has_packed[i])
            continue;
        coverage_add_packed(map, &packed->top);
        for (uint32_t m = 0; m < packed->mesh_count; m++)
            coverage_add_packed(map, &packed->bottom[m]);
    }
    coverage_add_world(map, &trial->world, trial->ray_count);
}

/* stage_world_ask with an engine that is prepared. */
static enum status ask_prepared(const struct play_stage *stage, const struct seat *seat,
                                struct judged_ray *out, struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    const bool split = seat->layout && stage_is_split(stage, seat->layout_index);
    const struct model model = seat_model(seat, trial, split);
    uint32_t tag = 0;
    struct trace_report report = {0};
    struct judge *judge = NULL;
    struct answers answers = {.hit = &out->answer.hit, .tag = &tag};
    enum status status = stage_trace(stage, seat, 0, 1, &answers, &report, reason);
    out->answer.finished = status == STATUS_OK;
    if (status == STATUS_MEMORY)
        return status;
    status = judge_make(stage->oracle, &model, trial->query, &judge, reason);
    if (!status)
        status = judge_world_answer(judge, trial->ray, trial->world.mode[0], stage->truth,
                                    &out->answer.hit, tag, &out->judgement);
    out->why.opinion.allowed = out->judgement.verdict != VERDICT_WRONG;
    judge_free(judge);
    return status;
}

enum status stage_world_ask(const struct play_stage *stage, const struct seat *seat,
                            struct judged_ray *out, bool *possible, struct reason *reason)
{
    *out = (struct judged_ray){.ray = stage->trial->ray[0], .truth = stage->truth[0]};
    out->answer.hit.prim = ABI_NO_PRIM;
    enum status status = stage_prepare(stage, seat, reason);
    *possible = status == STATUS_OK;
    if (status)
        return status == STATUS_MEMORY ? status : STATUS_OK;
    return ask_prepared(stage, seat, out, reason);
}

/* Whether the engine, opened anew and prepared with the last world alone, is right about the first
 * ray. Errors: STATUS_MEMORY. */
static enum status is_right_anew(const struct play_stage *stage, const struct seat *seat,
                                 const struct engine_options *options, bool *right,
                                 struct reason *reason)
{
    const struct world_job job = world_job_of(stage, seat);
    struct judged_ray answer = {.ray = stage->trial->ray[0], .truth = stage->truth[0]};
    struct seat fresh = *seat;
    struct reason why = {""};
    *right = false;
    fresh.self = NULL;
    enum status status = engine_open(fresh.engine, options, &fresh.self, &why);
    if (!status)
        status = fresh.engine->worlds->prepare_world(fresh.self, &job, &why);
    if (!status)
        status = ask_prepared(stage, &fresh, &answer, &why);
    *right = status == STATUS_OK && answer.answer.finished && answer.why.opinion.allowed;
    if (fresh.self && fresh.engine->close)
        fresh.engine->close(fresh.self);
    return status == STATUS_MEMORY ? fail(reason, status, "%s", why.text) : STATUS_OK;
}

enum status stage_world_explain(const struct play_stage *stage, const struct seat *seat,
                                const struct engine_options *options, struct fuzz_finding *finding,
                                struct reason *reason)
{
    const bool finished = finding->signature.kind != FUZZ_KIND_UNFINISHED;
    struct hit hit = {.prim = ABI_NO_PRIM};
    uint32_t tag = 0;
    struct trace_report report = {0};
    struct fuzz_trial alone = fuzz_trial_rays_from(stage->trial, finding->ray, 1);
    struct play_stage part = *stage; /* borrows */
    struct answers answers = {.hit = &hit, .tag = &tag};
    part.trial = &alone;
    enum status status = stage_prepare(&part, seat, reason);
    if (!status)
        status = stage_trace(&part, seat, 0, 1, &answers, &report, reason);
    if (status == STATUS_MEMORY)
        return status;
    bool same = (status == STATUS_OK) == finished;
    if (finished && same)
        same = memcmp(&hit, &finding->answer, sizeof hit) == 0 && tag == finding->tag;
    bool right = false;
    part.truth = stage->truth + finding->ray;
    if (same && alone.step_count > 0)
        status = is_right_anew(&part, seat, options, &right, reason);
    if (status == STATUS_MEMORY)
        return status;
    const struct model model = engine_model(seat->engine, seat->self, stage->trial->tri);
    finding->signature.cause = right                        ? CAUSE_STALE
                               : !same                      ? CAUSE_NOT_REPEATABLE
                               : twin_is_own(model.formula) ? CAUSE_UNEXPLAINED
                                                            : CAUSE_WORLD;
    return STATUS_OK;
}

/* Calls an engine, with many trials or one after the other, and records what fails. */
#include "fuzz/play/stage_world.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* An engine that takes longer to fail hung; else it crashed. */
#define HANG_NS 5000000000u

struct model seat_model(const struct seat *seat, const struct fuzz_trial *trial, bool split)
{
    struct model model = engine_model(seat->engine, seat->self, trial->tri);
    if (model.formula == TWIN_MT_RTRS)
        model.formula = TWIN_MT; /* its threshold is one of the faults to be found */
    if (seat->layout && (split || !trial->box->watertight))
        model.watertight = false; /* the triangle test is, but its boxes are not */
    return model;
}

/* True if the engine can still answer a ray on an empty scene. */
static bool is_alive(const struct seat *seat)
{
    struct scene scene = {0};
    struct packed packed = {.layout = seat->layout, .store = tri_stores[0]};
    struct job job = {.scene = &scene,
                      .packed = seat->layout ? &packed : NULL,
                      .box = box_tests[0],
                      .tri = tri_tests[0],
                      .query = QUERY_CLOSEST};
    struct ray ray = {.dir = {0.0f, 0.0f, 1.0f}, .tmax = 1.0f};
    struct hit hit;
    struct trace_report report;
    struct reason reason;
    return seat->engine->prepare(seat->self, &job, &reason) == STATUS_OK &&
           seat->engine->trace(seat->self, &ray, 1, &hit, &report, &reason) == STATUS_OK;
}

/* Opens the engine of a seat again, for all its seats. */
static enum status revive(struct fuzz_player *player, size_t seat, struct reason *reason)
{
    const struct engine *engine = player->seat[seat].engine;
    void *self = NULL;
    engine->close(player->seat[seat].self);
    enum status status = engine_open(engine, &player->options, &self, reason);
    for (size_t i = 0; i < player->seat_count; i++)
        if (player->seat[i].engine == engine)
            player->seat[i].self = status ? NULL : self;
    return status;
}

static void fared_badly(struct answers *answers, enum fuzz_kind kind, size_t ray)
{
    answers->fared = FARED_FAULTY;
    answers->kind = kind;
    answers->ray = (uint32_t)ray;
}

/* The result of a job that failed with this status. An engine may refuse the trees of a layout, and
 * the transforms of a world, such as those of which Embree dies. */
static void fared_by_status(const struct seat *who, bool world, struct answers *answers,
                            enum status status)
{
    bool other = who->layout && !engine_takes(who->engine, who->layout);
    if (status == STATUS_REFUSED || status == STATUS_LIMIT ||
        (status == STATUS_UNSUPPORTED && (other || world))) {
        answers->fared = FARED_REFUSED;
        answers->declined = status != STATUS_UNSUPPORTED || !other;
    } else {
        fared_badly(answers, status == STATUS_INPUT ? FUZZ_KIND_PROTOCOL : FUZZ_KIND_REFUSED, 0);
    }
}

/* Traces the rays one by one, after some of them were not finished. */
static enum status ask_singly(struct fuzz_player *player, size_t seat, struct play_stage *stage,
                              struct reason *reason)
{
    const struct seat *who = &player->seat[seat];
    struct answers *answers = &stage->answers[seat];
    size_t finished = 0;
    answers->fared = FARED_PLAYED;
    for (uint32_t i = 0; i < stage->trial->ray_count; i++) {
        struct trace_report report = {0};
        uint64_t start = time_ns();
        enum status status = stage_trace(stage, who, i, 1, answers, &report, reason);
        answers->flag[i] = status ? ABI_FLAG_EXHAUSTED | report.flags : ABI_FLAG_DONE;
        finished += status == STATUS_OK;
        if (status == STATUS_MEMORY)
            return status;
        if (!status || is_alive(who)) {
            if (status && stage_prepare(stage, who, reason))
                status = STATUS_UNSUPPORTED;
            if (status != STATUS_UNSUPPORTED)
                continue;
        }
        fared_badly(answers, time_ns() - start > HANG_NS ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH, i);
        return revive(player, seat, reason);
    }
    /* Rays that fail only together cannot be named. */
    if (finished == stage->trial->ray_count)
        fared_badly(answers, FUZZ_KIND_UNFINISHED, 0);
    return STATUS_OK;
}

/* Records the fault of an engine in a process of its own, which the next call starts again. False:
 * the engine has no such process. */
static bool peer_failed(const struct seat *who, const struct play_stage *stage,
                        struct answers *answers)
{
    static const enum fuzz_kind kinds[] = {[ENGINE_FINE] = FUZZ_KIND_PROTOCOL,
                                           [ENGINE_ENDED] = FUZZ_KIND_CRASH,
                                           [ENGINE_LATE] = FUZZ_KIND_HANG,
                                           [ENGINE_NONSENSE] = FUZZ_KIND_PROTOCOL};
    if (!who->engine->fault)
        return false;
    size_t ray = 0;
    enum engine_fault fault = who->engine->fault(who->self, &ray);
    fared_badly(answers, kinds[fault], ray < stage->trial->ray_count ? ray : 0);
    return true;
}

/* Traces one stage by prepare and trace. */
static enum status ask_alone(struct fuzz_player *player, size_t seat, struct play_stage *stage,
                             struct reason *reason)
{
    const struct seat *who = &player->seat[seat];
    struct answers *answers = &stage->answers[seat];
    struct trace_report report = {0};
    uint64_t start = time_ns();
    enum status status = stage_prepare(stage, who, reason);
    if (status == STATUS_REFUSED || status == STATUS_LIMIT || status == STATUS_UNSUPPORTED ||
        status == STATUS_INPUT) {
        fared_by_status(who, stage->trial->world.is, answers, status);
        return STATUS_OK;
    }
    if (!status)
        status = stage_trace(stage, who, 0, stage->trial->ray_count, answers, &report, reason);
    if (status == STATUS_OK) {
        answers->fared = FARED_PLAYED;
        for (uint32_t i = 0; i < stage->trial->ray_count; i++)
            answers->flag[i] = ABI_FLAG_DONE;
        return STATUS_OK;
    }
    if (status == STATUS_MEMORY)
        return status;
    if (status != STATUS_DEVICE) {
        fared_by_status(who, stage->trial->world.is, answers, status);
        return STATUS_OK;
    }
    if (peer_failed(who, stage, answers))
        return STATUS_OK;
    if (is_alive(who)) {
        status = stage_prepare(stage, who, reason);
        return status ? status : ask_singly(player, seat, stage, reason);
    }
    fared_badly(answers, time_ns() - start > HANG_NS ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH, 0);
    return revive(player, seat, reason);
}

/* True if the seat has a tree to trace, or needs none; else records why not. */
static bool can_ask(const struct seat *seat, struct play_stage *stage, struct answers *answers)
{
    answers->fared = FARED_NOT;
    answers->declined = false;
    if (!stage->world.beyond && (!seat->layout || stage->has_packed[seat->layout_index]))
        return true;
    answers->fared = FARED_REFUSED;
    return false;
}

/* The work of the rays in engine cpu on the same tree, if that was traced before. It decides the
 * order in which they are traced, but no answer. */
static const uint32_t *expected_work(const struct play_stage *stage, const struct seat *seat)
{
    if (seat->reference >= SEATS_MOST || !stage->answers[seat->reference].has_work)
        return NULL;
    return stage->answers[seat->reference].work;
}

static enum status ask_together(struct fuzz_player *player, size_t seat, size_t count,
                                struct reason *reason)
{
    const struct seat *who = &player->seat[seat];
    size_t tasks = 0;
    for (size_t i = 0; i < count; i++) {
        struct play_stage *stage = &player->stage[i];
        struct answers *answers = &stage->answers[seat];
        if (!can_ask(who, stage, answers))
            continue;
        struct engine_task *task = &player->task[tasks++];
        task->job = stage_job(stage, who);
        task->ray = stage->trial->ray;
        task->ray_count = stage->trial->ray_count;
        task->hit = answers->hit;
        task->flag = answers->flag;
        task->work = answers->work;
        task->expected = expected_work(stage, who);
        task->status = STATUS_OK;
    }
    enum status status = who->engine->trace_tasks(who->self, player->task, tasks, reason);
    tasks = 0;
    for (size_t i = 0; i < count && !status; i++) {
        struct answers *answers = &player->stage[i].answers[seat];
        if (answers->fared == FARED_REFUSED)
            continue;
        const struct engine_task *task = &player->task[tasks++];
        if (task->status == STATUS_OK || task->status == STATUS_DEVICE)
            answers->fared = FARED_PLAYED;
        else
            fared_by_status(who, false, answers, task->status);
        answers->has_work = who->engine->tells_work && task->status == STATUS_OK;
    }
    return status;
}

enum status seat_ask(struct fuzz_player *player, size_t seat, size_t count, struct reason *reason)
{
    enum status status = STATUS_OK;
    const struct seat *who = &player->seat[seat];
    const struct fuzz_trial *trial = player->stage[0].trial;
    if (who->engine->trace_tasks && !trial->world.is && trial->step_count == 0) {
        status = ask_together(player, seat, count, reason);
        if (status != STATUS_DEVICE)
            return status;
        status = is_alive(who) ? STATUS_OK : revive(player, seat, reason);
    }
    for (size_t i = 0; i < count && !status; i++) {
        if (player->mark) { /* only this one is at risk */
            atomic_store(&player->mark->trial, player->mark_first + i);
            atomic_store(&player->mark->count, 1);
        }
        if (can_ask(who, &player->stage[i], &player->stage[i].answers[seat]))
            status = ask_alone(player, seat, &player->stage[i], reason);
    }
    return status;
}

/* The child process in which raydiff replay plays, and the parent's requests to it. The files are
 * read before the fork, so pointers to files and tables are valid on both sides. */
#include "cmd/fuzz/cmd_replay.h"

#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "fuzz/play/trial_life.h"
#include "fuzz/play/trial_tree.h"
#include "fuzz/findings/versions.h"
#include "cmd/explain/cmd_explain.h"
#include "ref/match/match.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum worker_task { TASK_PLAY, TASK_PAGE, TASK_VERSIONS };

struct request {
    enum worker_task task;
    size_t file;
    struct fuzz_contestant who;
    uint32_t ray;
    const struct engine *engine[FUZZ_CONTESTANTS_MOST]; /* for TASK_VERSIONS */
    size_t engine_count;
};

struct worker_reply {
    enum replay_fate fate;
    struct reason reason;
    struct fuzz_finding finding[FUZZ_FINDINGS_MOST];
    size_t finding_count;
    bool printed;
    char versions[1024];
};

/* --- the child ------------------------------------------------------------------------------- */

/* A player with a single contestant, so that one that cannot run does not stop the others. */
struct open_player {
    struct fuzz_contestant who;
    struct fuzz_player *player; /* NULL: it cannot run */
    enum status status;
    struct reason reason;
};

struct troupe {
    const struct replay_options *options;
    const struct replay_file *files;
    struct open_player *open;
    size_t open_count, open_capacity;
    struct pool pool; /* for pages */
};

static struct open_player *get_player(struct troupe *troupe, const struct fuzz_contestant *who)
{
    for (size_t i = 0; i < troupe->open_count; i++)
        if (troupe->open[i].who.engine == who->engine && troupe->open[i].who.layout == who->layout)
            return &troupe->open[i];
    void *array = troupe->open;
    if (array_reserve(&array, &troupe->open_capacity, troupe->open_count + 1, sizeof *troupe->open))
        return NULL;
    troupe->open = array;
    struct open_player *open = &troupe->open[troupe->open_count++];
    *open = (struct open_player){.who = *who};
    struct fuzz_field field = {.who = {*who}, .count = 1, .options = troupe->options->engines};
    open->status = fuzz_player_open(&field, &open->player, &open->reason);
    return open;
}

static enum status explain_all(struct open_player *open, const struct fuzz_trial *trial,
                               struct fuzz_result *result, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < result->finding_count && !status; i++)
        status = fuzz_explain(open->player, trial, &result->finding[i], reason);
    return status;
}

static bool has_expected(const struct troupe *troupe, const struct finding_file *file,
                         const struct fuzz_result *result)
{
    for (size_t i = 0; i < result->finding_count; i++)
        if (replay_is_expected(troupe->options, file, &result->finding[i].signature))
            return true;
    return false;
}

/* The player keeps the first finding of each kind, which may have another cause than the expected
 * one. If it has, this plays the remaining rays one by one. */
static enum status look_behind(struct troupe *troupe, struct open_player *open,
                               const struct finding_file *file, struct fuzz_result *result,
                               struct reason *reason)
{
    size_t masking = 0;
    while (masking < result->finding_count &&
           result->finding[masking].signature.kind != file->signature.kind)
        masking++;
    if (!file->has_signature || masking == result->finding_count ||
        has_expected(troupe, file, result))
        return STATUS_OK;
    enum status status = STATUS_OK;
    for (uint32_t i = result->finding[masking].ray + 1; i < file->trial.ray_count && !status; i++) {
        const struct fuzz_trial alone = fuzz_trial_rays_from(&file->trial, i, 1);
        struct fuzz_result one = {0};
        status = fuzz_play(open->player, &alone, 1, &one, NULL, NULL, reason);
        if (!status)
            status = explain_all(open, &alone, &one, reason);
        for (size_t k = 0; k < one.finding_count && !status; k++)
            if (replay_is_expected(troupe->options, file, &one.finding[k].signature)) {
                one.finding[k].ray = i;
                result->finding[masking] = one.finding[k];
                return STATUS_OK;
            }
    }
    return status;
}

static void play(struct troupe *troupe, const struct request *request, struct worker_reply *reply)
{
    const struct finding_file *file = &troupe->files[request->file].file;
    struct open_player *open = get_player(troupe, &request->who);
    struct fuzz_result *result = alloc_zeroed(1, sizeof *result);
    enum status status = open && result ? STATUS_OK : STATUS_MEMORY;
    reply->fate = REPLAYED;
    if (!status && !open->player) {
        /* Other errors mean that it failed before the first request, such as a peer that exits. */
        reply->fate = open->status == STATUS_UNSUPPORTED ? REPLAY_SKIPPED : REPLAY_CRASHED;
        reply->reason = open->reason;
        free(result);
        return;
    }
    if (!status)
        status = fuzz_play(open->player, &file->trial, 1, result, NULL, NULL, &reply->reason);
    if (!status)
        status = explain_all(open, &file->trial, result, &reply->reason);
    if (!status)
        status = look_behind(troupe, open, file, result, &reply->reason);
    if (status) {
        reply->fate = REPLAY_FAILED;
        if (!reply->reason.text[0])
            fail(&reply->reason, status, "%s", status_text(status));
    } else if (result->finding_count == 0 && result->refused > 0) {
        reply->fate = REPLAY_REFUSED;
        fail(&reply->reason, STATUS_LIMIT, "a limit of the layout or the engine");
    } else {
        reply->finding_count = result->finding_count;
        memcpy(reply->finding, result->finding, sizeof reply->finding);
    }
    free(result);
}

/* What a page is made of: the engine's tree, the truth and the explained ray. */
struct page_parts {
    struct bvh bvh;
    struct packed packed;
    struct oracle *oracle;
    struct judged judged;
    struct judged_ray ray;
};

static enum status explain_ray(struct troupe *troupe, const struct request *request,
                               struct page_parts *parts, struct reason *reason)
{
    const struct fuzz_trial *trial = &troupe->files[request->file].file.trial;
    enum status status =
        judged_explain(&parts->judged, &trial->ray[request->ray], &parts->ray, reason);
    if (!status && trial->step_count > 0)
        status = judged_stale(&parts->judged, &troupe->pool.options, &parts->ray, reason);
    const struct open_player *open = status ? NULL : get_player(troupe, &request->who);
    if (open && open->player)
        status = fuzz_explain_scaled(open->player, trial, request->ray, &parts->ray, reason);
    return status;
}

static enum status make_page(struct troupe *troupe, const struct request *request,
                             struct page_parts *parts, struct reason *reason)
{
    const struct fuzz_trial *trial = &troupe->files[request->file].file.trial;
    const struct layout *layout = request->who.layout;
    enum status status = STATUS_OK;
    if (layout)
        status = fuzz_trial_tree(trial, layout, &parts->bvh, &parts->packed, NULL, reason);
    if (!status)
        status = oracle_make(&trial->scene, &parts->oracle, reason);
    if (status)
        return status;
    void *self = pool_get(&troupe->pool, request->who.engine, &status, reason);
    const struct job job = {.scene = &trial->scene,
                            .packed = layout ? &parts->packed : NULL,
                            .box = trial->box,
                            .tri = trial->tri,
                            .query = trial->query};
    if (!status)
        status = trial_life_enter(trial, request->who.engine, self, &job, reason);
    if (status)
        return status;
    const struct judged_job from = {request->who.engine, self, &job, layout ? &parts->bvh : NULL,
                                    parts->oracle};
    status = judged_make(&from, &parts->judged, reason);
    if (!status)
        status = explain_ray(troupe, request, parts, reason);
    if (status)
        return status;
    char again[EXPLAIN_COMMAND_MOST] = "raydiff replay";
    const char *path = troupe->files[request->file].path;
    command_word(again, sizeof again, path);
    command_word(again, sizeof again, "--engine");
    command_word(again, sizeof again, request->who.engine->name);
    if (layout)
        plugin_command(again, sizeof again, layout);
    if (request->who.engine->gpu && troupe->options->engines.driver) {
        command_word(again, sizeof again, "--driver");
        command_word(again, sizeof again, troupe->options->engines.driver);
    }
    const struct explain_of of = {.spec = path,
                                  .engine = request->who.engine,
                                  .layout = layout,
                                  .store = trial->store,
                                  .builder = trial->builder,
                                  .build = trial->build,
                                  .box = trial->box,
                                  .tri = trial->tri,
                                  .query = trial->query};
    const struct explain_page page = {.of = &of,
                                      .scene = &trial->scene,
                                      .judged = &parts->judged,
                                      .ray = &parts->ray,
                                      .index = request->ray,
                                      .count = trial->ray_count,
                                      .again = again,
                                      .screen = screen_make(&troupe->options->screen)};
    explain_print(&page);
    explain_free(&parts->ray.why);
    return STATUS_OK;
}

static void print_page(struct troupe *troupe, const struct request *request,
                       struct worker_reply *reply)
{
    struct page_parts parts = {0};
    if (troupe->files[request->file].file.trial.world.is)
        return; /* what explains answers knows scenes alone */
    reply->printed = make_page(troupe, request, &parts, &reply->reason) == STATUS_OK;
    judged_free(&parts.judged);
    oracle_free(parts.oracle);
    packed_free(&parts.packed);
    bvh_free(&parts.bvh);
}

/* Main loop of the child, until the parent closes its end. */
static void serve(struct child *parent, void *user)
{
    const struct replay_worker *worker = user;
    struct troupe troupe = {.options = worker->options, .files = worker->files};
    struct request request;
    troupe.pool.options = worker->options->engines;
    while (child_receive_into(parent, &request, sizeof request, CHILD_FOREVER)) {
        struct worker_reply *reply = alloc_zeroed(1, sizeof *reply);
        if (!reply)
            return;
        if (request.task == TASK_PLAY)
            play(&troupe, &request, reply);
        else if (request.task == TASK_PAGE)
            print_page(&troupe, &request, reply);
        else
            fuzz_versions(request.engine, request.engine_count, &worker->options->engines,
                          reply->versions, sizeof reply->versions);
        fflush(stdout);
        bool sent = child_send(parent, reply, sizeof *reply, CHILD_FOREVER);
        free(reply);
        if (!sent)
            return;
    }
    for (size_t i = 0; i < troupe.open_count; i++)
        fuzz_player_close(troupe.open[i].player);
    free(troupe.open);
    pool_free(&troupe.pool);
}

/* --- the parent ------------------------------------------------------------------------------ */

static void ask(struct replay_worker *worker, const struct request *request,
                struct worker_reply *reply)
{
    struct child *child = &worker->child;
    struct child_fate fate;
    const void *bytes;
    size_t size;
    *reply = (struct worker_reply){.fate = REPLAY_FAILED};
    if (!child->pid && child_start(serve, worker, child, &reply->reason))
        return;
    enum child_got got = CHILD_GONE;
    if (child_send(child, request, sizeof *request, worker->options->seconds * 1000))
        got = child_receive(child, sizeof *reply, worker->options->seconds * 1000, &bytes, &size);
    if (got == CHILD_GOT && size == sizeof *reply) {
        memcpy(reply, bytes, size);
        return;
    }
    child_end(child, got == CHILD_LATE ? 0 : 1000, &fate);
    reply->fate = got == CHILD_LATE ? REPLAY_HUNG : REPLAY_CRASHED;
    if (got == CHILD_LATE)
        fail(&reply->reason, STATUS_DEVICE, "no answer within %u s", worker->options->seconds);
    else
        fail(&reply->reason, STATUS_DEVICE, "%s", fate.text);
}

void replay_play(struct replay_worker *worker, size_t i, struct replay_played *played)
{
    const struct request request = {.task = TASK_PLAY, .file = i, .who = played->who};
    struct worker_reply reply;
    ask(worker, &request, &reply);
    played->fate = reply.fate;
    played->finding_count = reply.finding_count;
    memcpy(played->finding, reply.finding, sizeof played->finding);
    snprintf(played->reason, sizeof played->reason, "%.*s", REPLAY_REASON - 1, reply.reason.text);
}

bool replay_page(struct replay_worker *worker, size_t i, const struct fuzz_contestant *who,
                 uint32_t ray)
{
    const struct request request = {.task = TASK_PAGE, .file = i, .who = *who, .ray = ray};
    struct worker_reply reply;
    if (ray >= worker->files[i].file.trial.ray_count)
        return false;
    ask(worker, &request, &reply);
    return reply.printed;
}

void replay_versions(struct replay_worker *worker, size_t i)
{
    struct replay_file *file = &worker->files[i];
    struct request request = {.task = TASK_VERSIONS, .file = i};
    struct worker_reply reply;
    for (size_t k = 0; k < file->played_count; k++) {
        const struct engine *engine = file->played[k].who.engine;
        size_t seen = 0;
        while (seen < request.engine_count && request.engine[seen] != engine)
            seen++;
        if (seen == request.engine_count && file->played[k].fate != REPLAY_SKIPPED)
            request.engine[request.engine_count++] = engine;
    }
    ask(worker, &request, &reply);
    snprintf(file->now, sizeof file->now, "%s",
             reply.versions[0] ? reply.versions : reply.reason.text);
}

void replay_end(struct replay_worker *worker)
{
    child_end(&worker->child, 10000, NULL);
}

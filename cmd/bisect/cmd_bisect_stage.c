/* Modules are played in child processes: a driver may crash or hang on an odd one. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/bisect/cmd_bisect.h"

#include "gpu/shaders/shaders.h"
#include "ref/judge/judge_world.h"
#include "ref/match/match_engine.h"
#include "ref/outside/child.h"
#include "ref/twin/model.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PLAYED_MOST  64 /* by one child: drivers keep what they compiled */
#define MODULE_MOST  ((size_t)64 << 20)
#define TRIED_FACTOR 10u /* times that the slowest took before */
#define TRIED_MS     3000u

/* A request, followed by the words of the module; none: as built. */
struct bisect_request {
    bool promised; /* the compiler promises the bits and the bounds of the shaders as built */
    uint32_t count;
};

/* A reply, followed by hits, tags and WRONG, if status is STATUS_OK. */
struct bisect_reply {
    enum status status;
    struct reason reason;
    char shader[64];
    uint32_t constant[VK_CONSTANTS_MAX], constant_count;
    uint32_t shaders; /* that the engine asked for */
    uint64_t ns;
};

void answers_free(struct bisect_answers *answers)
{
    free(answers->hit);
    free(answers->tag);
    free(answers->wrong);
    *answers = (struct bisect_answers){0};
}

static enum status answers_make(const struct match *match, struct bisect_answers *out,
                                struct reason *reason)
{
    const size_t count = match->ray_count;
    *out = (struct bisect_answers){.hit = alloc_zeroed(count, sizeof *out->hit),
                                   .tag = alloc_zeroed(match->world ? count : 0, sizeof *out->tag),
                                   .wrong = alloc_zeroed(count, 1)};
    return out->hit && out->tag && out->wrong
               ? STATUS_OK
               : fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
}

/* --- the child -------------------------------------------------------------------------------- */

/* The engine of the child, and the module that its next pipeline has. */
struct player {
    struct bisect_stage *stage;
    struct vk_compiler hook;
    void *self; /* NULL: not open */
    struct bisect_reply *reply;
    const uint32_t *word;
    uint32_t count;
};

static enum status put_module(void *user, struct vk_shader *shader, struct reason *reason)
{
    struct player *p = user;
    struct bisect_reply *reply = p->reply;
    (void)reason;
    reply->shaders++;
    snprintf(reply->shader, sizeof reply->shader, "%s", shader->name);
    reply->constant_count = shader->constant_count;
    memcpy(reply->constant, shader->constant, shader->constant_count * sizeof reply->constant[0]);
    if (p->count > 0) {
        shader->word = p->word;
        shader->word_count = p->count;
    }
    return STATUS_OK;
}

/* As the engine with compiled shaders has it (gpu/engines/compiled.c). */
static struct model model_of(const struct player *p, bool promised)
{
    const struct match *match = &p->stage->match;
    const struct engine *engine = p->stage->options->engine;
    struct model model = engine_model(engine, p->self, match->options.tri);
    model.bits = promised && model.bits;
    model.watertight = promised && model.watertight && match_keeps_watertight(match, engine);
    return model;
}

static enum status judge_all(const struct player *p, bool promised, struct bisect_answers *answers,
                             struct reason *reason)
{
    const struct match *match = &p->stage->match;
    const struct model model = model_of(p, promised);
    struct judge *judge;
    enum status status = judge_make(match->oracle, &model, match->options.query, &judge, reason);
    for (size_t i = 0; i < match->ray_count && !status; i++) {
        struct judgement judgement;
        status = match->world ? judge_world_answer(judge, &match->ray[i], match_mode(match, i),
                                                   &match->truth[i], &answers->hit[i],
                                                   answers->tag[i], &judgement)
                              : judge_answer(judge, &match->ray[i], &match->truth[i],
                                             &answers->hit[i], &judgement);
        answers->wrong[i] = judgement.verdict == VERDICT_WRONG;
    }
    judge_free(judge);
    return status;
}

static enum status play(struct player *p, bool promised, struct bisect_answers *answers,
                        struct reason *reason)
{
    struct bisect_stage *stage = p->stage;
    const struct engine *engine = stage->options->engine;
    struct engine_options options = stage->options->engines;
    struct trace_report report;
    enum status status = STATUS_OK;
    options.compiler = &p->hook;
    if (!p->self)
        status = engine_open(engine, &options, &p->self, reason);
    if (!status)
        status = match_prepare(&stage->match, engine, p->self, reason);
    if (!status)
        status = match_trace(&stage->match, engine, p->self, stage->match.ray_count, answers->hit,
                             stage->match.world ? answers->tag : NULL, &report, reason);
    return status ? status : judge_all(p, promised, answers, reason);
}

/* Sends the reply and what follows it as one message. */
static bool send_all(struct child *parent, const struct bisect_stage *stage,
                     const struct bisect_reply *reply, const struct bisect_answers *answers)
{
    const size_t count = reply->status ? 0 : stage->match.ray_count;
    const size_t hits = count * sizeof *answers->hit;
    const size_t tags = stage->match.world ? count * sizeof *answers->tag : 0;
    const size_t size = sizeof *reply + hits + tags + count;
    char *bytes = alloc_zeroed(size, 1);
    if (!bytes)
        return false;
    memcpy(bytes, reply, sizeof *reply);
    if (count > 0) {
        memcpy(bytes + sizeof *reply, answers->hit, hits);
        if (tags > 0)
            memcpy(bytes + sizeof *reply + hits, answers->tag, tags);
        memcpy(bytes + sizeof *reply + hits + tags, answers->wrong, count);
    }
    const bool sent = child_send(parent, bytes, size, CHILD_FOREVER);
    free(bytes);
    return sent;
}

/* What a driver says of an odd module is not for the user. */
static void be_quiet(void)
{
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nothing >= 0) {
        (void)dup2(nothing, STDOUT_FILENO);
        (void)dup2(nothing, STDERR_FILENO);
    }
}

/* Main loop of the child, until the parent closes its end. Words of modules stay: pipelines are
 * known by them. */
static void serve(struct child *parent, void *user)
{
    struct player p = {.stage = user, .hook = {.compile = put_module}};
    struct bisect_answers answers;
    struct reason reason;
    const void *bytes;
    size_t size;
    p.hook.user = &p;
    be_quiet();
    if (answers_make(&p.stage->match, &answers, &reason))
        return;
    while (child_receive(parent, MODULE_MOST, CHILD_FOREVER, &bytes, &size) == CHILD_GOT) {
        struct bisect_request request;
        struct bisect_reply reply = {.status = STATUS_OK};
        memcpy(&request, bytes, sizeof request);
        p.reply = &reply;
        p.count = request.count;
        p.word = alloc_copy((const char *)bytes + sizeof request, request.count, 4);
        const uint64_t start = time_ns();
        reply.status = play(&p, request.promised, &answers, &reply.reason);
        reply.ns = time_ns() - start;
        if (!send_all(parent, p.stage, &reply, &answers))
            return;
    }
    if (p.self && p.stage->options->engine->close)
        p.stage->options->engine->close(p.self);
}

/* --- the parent ------------------------------------------------------------------------------- */

enum status bisect_stage_open(const struct bisect_options *o, const struct bisect_subject *s,
                              struct bisect_stage *out, struct reason *reason)
{
    *out = (struct bisect_stage){.options = o, .subject = s, .promised = true};
    const struct match_options options = {.builder = o->builder,
                                          .build = o->build,
                                          .store = o->store,
                                          .box = o->box,
                                          .tri = o->tri,
                                          .query = o->query,
                                          .rest = s->moved ? &s->rest : NULL,
                                          .repeats = 1};
    out->child = alloc_zeroed(1, sizeof *out->child);
    if (!out->child)
        return fail(reason, STATUS_MEMORY, "no memory for a child process");
    enum status status = s->is_world ? match_make_world(s->is_world, s->ray, s->mode, s->ray_count,
                                                        &options, &out->pool, &out->match, reason)
                                     : match_make(&s->scene, s->ray, s->ray_count, &options,
                                                  &out->pool, &out->match, reason);
    return !status && o->layout ? match_pack(&out->match, o->layout, reason) : status;
}

static void end_child(struct bisect_stage *stage, uint32_t ms, struct child_fate *fate)
{
    child_end(stage->child, ms, fate);
    stage->played = 0;
}

void bisect_stage_close(struct bisect_stage *stage)
{
    if (stage->child)
        end_child(stage, 10000, NULL);
    free(stage->child);
    match_free(&stage->match);
    *stage = (struct bisect_stage){0};
}

static uint32_t limit_ms(const struct bisect_stage *stage, bool tried)
{
    const uint32_t most = stage->options->seconds * 1000;
    const uint64_t usual = TRIED_MS + TRIED_FACTOR * (stage->slowest / 1000000u);
    return tried && usual < most ? (uint32_t)usual : most;
}

static enum status send_request(struct bisect_stage *stage, const uint32_t *word, size_t count,
                                struct reason *reason)
{
    const struct bisect_request request = {stage->promised, (uint32_t)count};
    const size_t size = sizeof request + count * sizeof *word;
    char *bytes = alloc_zeroed(size, 1);
    if (!bytes)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    memcpy(bytes, &request, sizeof request);
    if (count > 0)
        memcpy(bytes + sizeof request, word, count * sizeof *word);
    const bool sent = child_send(stage->child, bytes, size, stage->options->seconds * 1000);
    free(bytes);
    return sent ? STATUS_OK : fail(reason, STATUS_DEVICE, "the child process is gone");
}

/* Notes the shader that was used. */
static enum status take_shader(struct bisect_stage *stage, const struct bisect_reply *reply,
                               struct reason *reason)
{
    const struct shader *found = shader_find(reply->shader);
    if (!found || reply->shaders != 1)
        return fail(reason, STATUS_INTERNAL, "the engine used %u shaders, the last one '%s'",
                    reply->shaders, reply->shader);
    memcpy(stage->constant, reply->constant, sizeof stage->constant);
    stage->shader = (struct vk_shader){.name = found->name,
                                       .word = found->word,
                                       .word_count = found->word_count,
                                       .constant = stage->constant,
                                       .constant_count = reply->constant_count};
    return STATUS_OK;
}

static enum status take_reply(struct bisect_stage *stage, const void *bytes, size_t size,
                              struct bisect_answers *out, struct reason *reason)
{
    struct bisect_reply reply;
    const size_t count = stage->match.ray_count, hits = count * sizeof *out->hit;
    const size_t tags = stage->match.world ? count * sizeof *out->tag : 0;
    if (size < sizeof reply)
        return fail(reason, STATUS_INTERNAL, "a reply of %zu bytes", size);
    memcpy(&reply, bytes, sizeof reply);
    if (reply.status) {
        *reason = reply.reason;
        return reply.status;
    }
    enum status status = take_shader(stage, &reply, reason);
    if (!status)
        status = answers_make(&stage->match, out, reason);
    if (status)
        return status;
    const char *at = (const char *)bytes + sizeof reply;
    memcpy(out->hit, at, hits);
    memcpy(out->tag, at + hits, tags);
    memcpy(out->wrong, at + hits + tags, count);
    for (size_t i = 0; i < count; i++)
        out->wrong_count += out->wrong[i];
    out->ns = reply.ns;
    return STATUS_OK;
}

/* What became of a child that does not answer. */
static enum status lost(struct bisect_stage *stage, enum child_got got, bool tried,
                        struct reason *reason)
{
    struct child_fate fate;
    const uint32_t ms = limit_ms(stage, tried);
    end_child(stage, got == CHILD_LATE ? 0 : 1000, &fate);
    stage->hung += got == CHILD_LATE;
    stage->crashed += got != CHILD_LATE;
    return got == CHILD_LATE
               ? fail(reason, STATUS_DEVICE, "no answer within %.1f s", (double)ms / 1000)
               : fail(reason, STATUS_DEVICE, "%s", fate.text);
}

enum status bisect_stage_play(struct bisect_stage *stage, const uint32_t *word, size_t count,
                              bool tried, struct bisect_answers *out, struct reason *reason)
{
    const void *bytes;
    size_t size;
    enum status status = STATUS_OK;
    *out = (struct bisect_answers){0};
    if (stage->played == PLAYED_MOST)
        end_child(stage, 10000, NULL);
    if (!stage->child->pid)
        status = child_start(serve, stage, stage->child, reason);
    if (!status)
        status = send_request(stage, word, count, reason);
    if (status) {
        end_child(stage, 0, NULL);
        return status;
    }
    stage->played++;
    const enum child_got got =
        child_receive(stage->child, (size_t)1 << 30, limit_ms(stage, tried), &bytes, &size);
    if (got != CHILD_GOT)
        return lost(stage, got, tried, reason);
    status = take_reply(stage, bytes, size, out, reason);
    if (status) { /* a device may be lost */
        answers_free(out);
        end_child(stage, 1000, NULL);
    } else if (!tried && out->ns > stage->slowest) {
        stage->slowest = out->ns;
    }
    return status;
}

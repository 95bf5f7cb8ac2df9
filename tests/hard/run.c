#include "tests/hard/run.h"

#include "tests/hard/hard_crossings.h"
#include "tests/hard/hard_world.h"
#include "ref/packed/packed_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

unsigned hard_member_published(const struct hard_member *m)
{
    unsigned tree = m->layout ? (unsigned)m->layout->faithful + (unsigned)m->builder->faithful +
                                    (unsigned)m->box->faithful
                              : 0;
    return tree + (unsigned)m->tri->faithful;
}

void hard_member_print(const struct hard_member *m, char name[HARD_NAME_MOST])
{
    snprintf(name, HARD_NAME_MOST, "%s.%s.%s%s%s.%s.%s.%s", query_name(m->query), m->engine->name,
             m->top ? m->top->name : "", m->top ? "/" : "", m->layout ? m->layout->name : "-",
             m->builder ? m->builder->name : "-", m->box ? m->box->name : "-", m->tri->name);
}

void hard_name_print(const struct hard_case *one, const struct hard_member *member,
                     char name[HARD_NAME_MOST])
{
    char who[HARD_NAME_MOST];
    hard_member_print(member, who);
    int used = snprintf(name, HARD_NAME_MOST, "hard.%02u-%s.", one->number, one->name);
    snprintf(name + used, HARD_NAME_MOST - (size_t)used, "%.100s", who);
}

/* --- stage ------------------------------------------------------------------------------------ */

static void stage_drop(struct hard_stage *stage)
{
    for (size_t i = 0; stage->made && stage->cache && i < stage->made->part_count; i++)
        cache_free(&stage->cache[i]);
    if (stage->made)
        hard_free(stage->made);
    free(stage->cache);
    free(stage->made);
    stage->made = NULL;
    stage->cache = NULL;
    stage->one = NULL;
}

void hard_stage_free(struct hard_stage *stage)
{
    stage_drop(stage);
    pool_free(&stage->pool);
    pool_free(&stage->many);
}

/* Engines opened on one driver do for all cases on it. */
static void stage_drive(struct hard_stage *stage, const char *driver)
{
    const char *wanted = driver ? driver : stage->options.driver, *now = stage->pool.options.driver;
    if (wanted == now || (wanted && now && strcmp(wanted, now) == 0))
        return;
    pool_free(&stage->pool);
    pool_free(&stage->many);
    stage->pool.options.driver = stage->many.options.driver = wanted;
}

struct hard_stage hard_stage_make(const struct engine_options *options)
{
    struct hard_stage stage = {
        .options = *options, .pool = {.options = *options}, .many = {.options = *options}};
    stage.pool.options.threads = 1;
    return stage;
}

static enum status stage_set(struct hard_stage *stage, const struct hard_case *one,
                             struct reason *reason)
{
    if (stage->one == one)
        return STATUS_OK;
    stage_drop(stage);
    stage_drive(stage, one->driver);
    stage->made = alloc_zeroed(1, sizeof *stage->made);
    if (!stage->made)
        return fail(reason, STATUS_MEMORY, "no memory for a hard case");
    enum status status = hard_make(one, stage->made, reason);
    if (!status) {
        stage->cache = alloc_zeroed(stage->made->part_count, sizeof *stage->cache);
        if (!stage->cache)
            status = fail(reason, STATUS_MEMORY, "no memory for a hard case");
    }
    for (size_t i = 0; !status && i < stage->made->part_count; i++)
        status = cache_make(&stage->made->part[i], &stage->cache[i], reason);
    if (status)
        stage_drop(stage);
    else
        stage->one = one;
    return status;
}

/* --- one part --------------------------------------------------------------------------------- */

static bool names(const char *list, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = list; at && (at = strstr(at, name)) != NULL; at++)
        if ((at == list || at[-1] == ' ') && (at[length] == '\0' || at[length] == ' '))
            return true;
    return false;
}

void play_refused(struct hard_play *play, const struct reason *why)
{
    play->result->refused++;
    if (why->text[0] == '\0')
        play_broken(play, PROPERTY_REFUSAL, SIZE_MAX);
    if (play->result->reason.text[0] == '\0')
        play->result->reason = *why;
}

/* Builds and packs. *go is false if that is all. */
static enum status play_tree(struct hard_play *play, bool *go)
{
    const struct hard_member *m = play->member;
    struct hard_cache *cache = play->cache;
    enum status status = cache_pack(cache, m);
    *go = !status;
    if (status == STATUS_MEMORY)
        return fail(play->reason, status, "%s", cache->reason.text);
    if (status) {
        play_refused(play, &cache->reason);
        return STATUS_OK;
    }
    if (names(play->part->must_refuse, m->layout->name) && !m->builder->faithful) {
        play_broken(play, PROPERTY_REFUSAL, SIZE_MAX);
        *go = false;
    }
    bool repaired = !m->builder->faithful && !m->layout->faithful;
    if (!cache->checked && !play->part->bad_scene) {
        cache->structure = packed_check(&cache->packed, &play->part->scene, NULL, &cache->reason);
        cache->checked = true;
    }
    if (!play->part->bad_scene && cache->structure &&
        (repaired || play->stage->one->flags & HARD_STRUCTURE))
        play_broken(play, PROPERTY_STRUCTURE, SIZE_MAX);
    return STATUS_OK;
}

/* The engine cannot hold the part. */
static bool is_refusal(enum status status)
{
    return status == STATUS_LIMIT || status == STATUS_REFUSED;
}

static enum status play_part(struct hard_play *play)
{
    const struct hard_member *m = play->member;
    bool go = true;
    enum status status = STATUS_OK;
    play->cache->answered = false;
    if (play->part->is_world)
        return play_world(play);
    if (m->engine->needs_packed)
        status = play_tree(play, &go);
    if (status || !go)
        return status;
    play->job = cache_job(play->cache, m);
    play->result->asked++;
    status = m->engine->prepare(play->self, &play->job, play->reason);
    if (is_refusal(status) || status == STATUS_UNSUPPORTED) {
        play->result->declined += is_refusal(status);
        play_refused(play, play->reason);
        return STATUS_OK;
    }
    if (status)
        return status;
    play->result->played++;
    play->model = engine_model(m->engine, play->self, m->tri);
    if (!job_keeps_watertight(&play->job))
        play->model.watertight = false; /* the triangle test is, but its boxes are not */
    if (m->query == QUERY_ALL)
        return play_crossings(play);
    status = play_trace(play, play->self, play->cache->answer);
    if (status == STATUS_REFUSED) {
        play->result->played--;
        play->result->declined++;
        play_refused(play, play->reason);
        return STATUS_OK;
    }
    return status ? status : play_check(play);
}

/* --- a case ----------------------------------------------------------------------------------- */

/* A status that the engine is allowed to return: the trial fails, the run goes on. */
static bool is_confession(enum status status)
{
    return status == STATUS_DEVICE || status == STATUS_UNSUPPORTED || is_refusal(status);
}

static void sum_up(const struct hard_stage *stage, struct hard_result *out)
{
    if (out->outcome != HARD_PASSED)
        return;
    if (out->played == 0 && out->refused > 0)
        out->outcome = HARD_REFUSED;
    bool hits_wanted = !(stage->one->flags & HARD_NO_HITS);
    size_t truly = 0;
    for (size_t p = 0; p < stage->made->part_count; p++)
        truly += cache_truly(&stage->cache[p]);
    if (hits_wanted && truly == 0) {
        out->outcome = HARD_FAILED;
        (void)fail(&out->reason, STATUS_OK, "vacuous: no ray of this case truly hits anything");
    }
}

enum status hard_run(struct hard_stage *stage, const struct hard_case *one,
                     const struct hard_member *member, struct hard_result *out,
                     struct reason *reason)
{
    *out = (struct hard_result){.outcome = HARD_PASSED};
    if (one->probe) {
        stage_drop(stage);
        stage_drive(stage, one->driver);
        one->probe(&stage->pool.options, out);
        return STATUS_OK;
    }
    enum status status = stage_set(stage, one, reason);
    if (status)
        return status;
    void *self = pool_get(&stage->pool, member->engine, &status, &out->reason);
    if (status) {
        out->outcome = status == STATUS_UNSUPPORTED ? HARD_SKIPPED : HARD_FAILED;
        out->absent = status == STATUS_UNSUPPORTED;
        out->unfinished = status != STATUS_UNSUPPORTED;
        return STATUS_OK;
    }
    for (size_t p = 0; p < stage->made->part_count; p++) {
        struct reason why = {""};
        struct hard_play play = {.stage = stage,
                                 .member = member,
                                 .index = p,
                                 .part = &stage->made->part[p],
                                 .cache = &stage->cache[p],
                                 .self = self,
                                 .result = out,
                                 .reason = &why};
        status = play_part(&play);
        if (status && !is_confession(status)) {
            *reason = why;
            return status;
        }
        if (status && !out->unfinished) {
            out->outcome = HARD_FAILED;
            out->unfinished = true;
            (void)fail(&out->reason, STATUS_OK, "part %s: %.250s", stage->made->part[p].label,
                       why.text);
        }
    }
    sum_up(stage, out);
    return STATUS_OK;
}

#include "tests/hard/causes.h"

#include "ref/explain/judged.h"
#include "ref/explain/outside.h"
#include "tests/hard/cache.h"

#include "ref/trace/trace.h"

#include <stdio.h>
#include <string.h>

static void note(struct hard_causes *out, enum cause cause)
{
    out->count[cause]++;
    out->explained++;
    if (out->most == CAUSE_NONE || out->count[cause] > out->count[out->most])
        out->most = cause;
}

/* Explains wrong rays of one part until there are HARD_EXPLAINED. */
static enum status explain_rays(struct judged *judged, const struct hard_part *part,
                                struct hard_causes *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; out->explained < HARD_EXPLAINED && !status; i++) {
        struct judged_ray ray;
        status = judged_find(judged, part->ray, i, part->ray_count, &i, reason);
        if (status || i == part->ray_count)
            break;
        status = judged_explain(judged, &part->ray[i], &ray, reason);
        if (status)
            break;
        if (ray.why.cause != CAUSE_NONE)
            note(out, ray.why.cause);
        explain_free(&ray.why);
    }
    return status;
}

/* A tree must hit something where the same triangle test on every triangle does. */
struct causes_brute {
    const struct scene *scene;
    const struct tri_test *tri;
};

static void brute_opinion(const void *user, const struct ray *ray, const struct hit *answer,
                          struct opinion *out)
{
    const struct causes_brute *brute = user;
    struct hit hit;
    trace_brute(brute->scene, brute->tri, QUERY_CLOSEST, ray, &hit);
    bool lost = hit.prim != ABI_NO_PRIM && answer->prim == ABI_NO_PRIM;
    *out = (struct opinion){!lost, lost ? "culled" : "right", hit.prim};
}

static bool ask(void *user, const struct ray *ray, size_t count, struct hit *out)
{
    const struct judged_job *from = user;
    struct trace_report report;
    return from->engine->trace(from->self, ray, count, out, &report, NULL) == STATUS_OK;
}

/* Explains rays that the tree loses though the judge lets the triangle test decide either way. */
static enum status explain_culled(struct judged_job *from, const struct judged *judged,
                                  const struct hard_part *part, struct hard_causes *out,
                                  struct reason *reason)
{
    const struct job *job = from->job;
    struct causes_brute brute = {job->scene, job->tri};
    struct explain_case the = {
        .replay = {.scene = job->scene,
                   .tree = &judged->tree,
                   .box_id = job->box->id,
                   .tri_id = job->tri->id,
                   .query = job->query},
        .judge = brute_opinion,
        .judge_user = &brute,
        .ask = ask,
        .ask_user = from,
        .bits = judged->model.bits,
        .exact = true,
        .known = true,
    };
    enum status status = STATUS_OK;
    for (size_t i = 0; i < part->ray_count && out->explained < HARD_EXPLAINED && !status; i++) {
        struct explain_answer answer = {.finished = true};
        struct explanation why;
        struct opinion opinion;
        the.ray = part->ray[i];
        answer.finished = ask(from, &the.ray, 1, &answer.hit);
        brute_opinion(&brute, &the.ray, &answer.hit, &opinion);
        if (answer.finished && opinion.allowed)
            continue;
        status = explain_make(&the, &answer, &why, reason);
        if (status)
            break;
        note(out, why.cause);
        explain_free(&why);
    }
    return status;
}

/* Adds all hints about one lost ray. */
static void add_hints(const struct outside_hint *hint, size_t hints, struct hard_causes *out)
{
    note(out, hints > 0 ? hint[0].cause : CAUSE_OUTSIDE);
    for (size_t i = 0; i < hints; i++) {
        size_t used = strlen(out->hint);
        if (hint[i].cause == hint[0].cause && !strstr(out->hint, hint[i].text))
            snprintf(out->hint + used, sizeof out->hint - used, "%s%s", used ? "; or " : "",
                     hint[i].text);
    }
}

/* For a closed engine only its lost hits can be explained: by the box tests that lose them too. */
static enum status explain_closed(const struct judged_job *from, const struct hard_cache *cache,
                                  const struct hard_part *part, struct hard_causes *out,
                                  struct reason *reason)
{
    struct trace_report report;
    enum status status =
        from->engine->trace(from->self, part->ray, part->ray_count, cache->again, &report, reason);
    for (size_t i = 0; i < part->ray_count && !status && out->explained < HARD_LOST; i++) {
        struct outside_hint hint[OUTSIDE_HINTS];
        bool asked = part->want[i].what & (WANT_HIT | WANT_T) || !out->most;
        if (!asked || cache->truth[i].prim == ABI_NO_PRIM || cache->again[i].prim != ABI_NO_PRIM)
            continue;
        size_t hints = explain_outside(&part->scene, &part->ray[i], cache->truth[i].prim, hint);
        add_hints(hint, hints, out);
    }
    return status;
}

static bool is_closed(const struct hard_member *member, void *self)
{
    enum twin_formula formula = engine_model(member->engine, self, member->tri).formula;
    return formula == TWIN_EMBREE || formula == TWIN_EMBREE_ROBUST || formula == TWIN_UNKNOWN;
}

static enum status explain_part(struct hard_stage *stage, size_t p, const struct hard_member *m,
                                const struct hard_result *result, void *self,
                                struct hard_causes *out, struct reason *reason)
{
    const struct hard_part *part = &stage->made->part[p];
    struct hard_cache *cache = &stage->cache[p];
    if (part->bad_scene || (m->engine->needs_packed && cache_pack(cache, m)))
        return STATUS_OK; /* refused */
    struct job job = cache_job(cache, m);
    struct judged_job from = {.engine = m->engine,
                              .self = self,
                              .job = &job,
                              .bvh = m->engine->needs_packed ? &cache->bvh : NULL,
                              .oracle = cache->oracle};
    struct judged judged;
    enum status status = m->engine->prepare(self, &job, reason);
    if (status)
        return status == STATUS_LIMIT ? STATUS_OK : status;
    status = judged_make(&from, &judged, reason);
    if (status)
        return status;
    if (judged.known)
        status = explain_rays(&judged, part, out, reason);
    if (judged.has_tree && !status && out->explained == 0 && result->broken[PROPERTY_CULLED])
        status = explain_culled(&from, &judged, part, out, reason);
    if (is_closed(m, self) && !status)
        status = explain_closed(&from, cache, part, out, reason);
    judged_free(&judged);
    return status;
}

enum status hard_explain(struct hard_stage *stage, const struct hard_member *member,
                         const struct hard_result *result, struct hard_causes *out,
                         struct reason *reason)
{
    *out = (struct hard_causes){.most = CAUSE_NONE};
    enum status status = STATUS_OK;
    void *self = pool_get(&stage->pool, member->engine, &status, reason);
    for (size_t p = 0; p < stage->made->part_count && !status; p++)
        status = explain_part(stage, p, member, result, self, out, reason);
    return status;
}

void hard_causes_print(const struct hard_causes *causes, char *text, size_t text_bytes)
{
    if (causes->explained == 0)
        snprintf(text, text_bytes, "no answer is wrong alone");
    else
        snprintf(text, text_bytes, "%s (%zu of %zu rays explained)%s%s", cause_name(causes->most),
                 causes->count[causes->most], causes->explained, causes->hint[0] ? "; " : "",
                 causes->hint);
}

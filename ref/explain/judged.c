#include "ref/explain/judged.h"

#include <stdlib.h>
#include <string.h>

/* Rays traced at a time during the search for a wrong one. */
#define SEARCH_BATCH 4096u

static bool is_known(const struct judged *judged)
{
    if (!twin_is_own(judged->model.formula))
        return false;
    return judged->from.job->packed != NULL || judged->from.engine->brute;
}

enum status judged_make(const struct judged_job *from, struct judged *out, struct reason *reason)
{
    const struct job *job = from->job;
    enum status status = STATUS_OK;
    *out = (struct judged){.from = *from};
    out->model = engine_model(from->engine, from->self, job->tri);
    if (out->model.formula == TWIN_MT_RTRS)
        out->model.formula = TWIN_MT;
    if (!job_keeps_watertight(job))
        out->model.watertight = false; /* the triangle test is, but its boxes are not */
    out->known = is_known(out);
    out->has_tree = job->packed && job->packed->node_count > 0;
    if (out->has_tree)
        status = explain_tree_make(job->scene, from->bvh, job->packed, &out->tree, reason);
    if (!status)
        status = judge_make(from->oracle, &out->model, job->query, &out->judge, reason);
    if (status)
        judged_free(out);
    return status;
}

void judged_free(struct judged *judged)
{
    judge_free(judged->judge);
    if (judged->has_tree)
        explain_tree_free(&judged->tree);
    *judged = (struct judged){0};
}

/* One ray for the judge. */
struct question {
    const struct judged *judged;
    const struct oracle_answer *truth;
};

static void opinion(const void *user, const struct ray *ray, const struct hit *answer,
                    struct opinion *out)
{
    const struct question *question = user;
    struct judgement judgement;
    /* Without memory the ray counts as out of contract. */
    (void)judge_answer(question->judged->judge, ray, question->truth, answer, &judgement);
    out->allowed = judgement.verdict != VERDICT_WRONG;
    out->text = out->allowed ? verdict_name(judgement.verdict) : wrong_name(judgement.wrong);
    out->expected = judgement.behind ? judgement.lost : judgement.expected;
}

/* Barycentric coordinates to more than float precision: w_i / D of ref/oracle/oracle.h. */
static void exact_weights(const struct scene *scene, const struct ray *ray, uint32_t prim,
                          struct hit *out)
{
    float v[3][3];
    long double a[3][3], w[3], sum = 0;
    scene_tri(scene, prim, v);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            a[c][k] = (long double)v[c][k] - (long double)ray->org[k];
    for (int i = 0; i < 3; i++) {
        const long double *b = a[(i + 1) % 3], *c = a[(i + 2) % 3];
        w[i] = 0;
        for (int k = 0; k < 3; k++) {
            int y = (k + 1) % 3, z = (k + 2) % 3;
            w[i] += (long double)ray->dir[k] * (b[y] * c[z] - b[z] * c[y]);
        }
        sum += w[i];
    }
    out->u = (float)(w[1] / sum);
    out->v = (float)(w[2] / sum);
}

static bool exact_hit(const void *user, const struct ray *ray, uint32_t prim, struct hit *out)
{
    const struct judged *judged = user;
    struct oracle_pair pair;
    oracle_pair(judged->from.oracle, ray, prim, &pair);
    if (!oracle_is_hit(&pair) ||
        !oracle_in_range(&pair, judged->model.open ? ORACLE_OPEN : ORACLE_CLOSED))
        return false;
    exact_weights(judged->from.job->scene, ray, prim, out);
    out->t = (float)(0.5 * (pair.t_lo + pair.t_hi));
    out->prim = prim;
    return true;
}

static bool ask(void *user, const struct ray *ray, size_t count, struct hit *out)
{
    struct judged *judged = user;
    struct trace_report report;
    struct reason reason;
    return judged->from.engine->trace(judged->from.self, ray, count, out, &report, &reason) ==
           STATUS_OK;
}

static struct explain_case case_of(struct judged *judged, const struct ray *ray,
                                   const struct question *question)
{
    const struct job *job = judged->from.job;
    const struct rounding ieee = ROUNDING_IEEE, *rounding = &judged->model.rounding;
    return (struct explain_case){
        .replay = {.scene = job->scene,
                   .tree = judged->has_tree ? &judged->tree : NULL,
                   .box_id = job->packed ? job->box->id : 0,
                   .tri_id = job->tri->id,
                   .query = job->query,
                   .exact = exact_hit,
                   .exact_user = judged},
        .ray = *ray,
        .judge = opinion,
        .judge_user = question,
        .ask = ask,
        .ask_user = judged,
        .bits = judged->model.bits,
        .exact = rounding->add == ieee.add && rounding->mul == ieee.mul &&
                 rounding->div == ieee.div && rounding->tiny == ieee.tiny,
        .known = judged->known,
    };
}

/* Judges and explains what the engine answered, or that it did not finish. */
static enum status explain_answer(struct judged *judged, struct judged_ray *out,
                                  struct reason *reason)
{
    struct question question = {judged, &out->truth};
    enum status status =
        judge_answer(judged->judge, &out->ray, &out->truth, &out->answer.hit, &out->judgement);
    if (status)
        return fail(reason, status, "no memory to judge a ray");
    struct explain_case the = case_of(judged, &out->ray, &question);
    return explain_make(&the, &out->answer, &out->why, reason);
}

/* Traces one ray alone, and finds what is true of it. */
static enum status ask_alone(struct judged *judged, const struct ray *ray, struct judged_ray *out,
                             struct reason *reason)
{
    struct trace_report report = {0};
    *out = (struct judged_ray){.ray = *ray, .answer.hit.prim = ABI_NO_PRIM};
    enum status status = oracle_closest(judged->from.oracle, ORACLE_AUTO, ORACLE_CLOSED, ray, 1, 1,
                                        &out->truth, NULL, reason);
    if (status)
        return status;
    struct hit hit;
    status = judged->from.engine->trace(judged->from.self, ray, 1, &hit, &report, &out->reason);
    if (status == STATUS_MEMORY)
        return fail(reason, status, "%s", out->reason.text);
    out->answer.finished = status == STATUS_OK;
    out->answer.flags = report.flags;
    if (out->answer.finished)
        out->answer.hit = hit;
    return STATUS_OK;
}

enum status judged_explain(struct judged *judged, const struct ray *ray, struct judged_ray *out,
                           struct reason *reason)
{
    enum status status = ask_alone(judged, ray, out, reason);
    return status ? status : explain_answer(judged, out, reason);
}

/* True if this answer is wrong, or not the bits that it should have. */
static bool is_wrong(struct judged *judged, const struct ray *ray,
                     const struct oracle_answer *truth, const struct hit *hit)
{
    struct question question = {judged, truth};
    struct explain_case the = case_of(judged, ray, &question);
    struct replay_change plain = {0};
    struct opinion what;
    struct hit expected;
    opinion(&question, ray, hit, &what);
    if (!what.allowed)
        return true;
    if (!the.bits)
        return false;
    return replay_run(&the.replay, &plain, ray, &expected, NULL) != REPLAY_DONE ||
           memcmp(&expected, hit, sizeof *hit) != 0;
}

/* The rays that are traced together with ray `index` of `count`: *part from *at on. */
static void company_of(size_t index, size_t count, size_t *at, size_t *part)
{
    *at = index - index % SEARCH_BATCH;
    *part = count - *at < SEARCH_BATCH ? count - *at : SEARCH_BATCH;
}

enum status judged_explain_among(struct judged *judged, const struct ray *ray, size_t count,
                                 size_t index, struct judged_ray *out, struct reason *reason)
{
    size_t at, part;
    company_of(index, count, &at, &part);
    enum status status = ask_alone(judged, &ray[index], out, reason);
    if (status || part == 1 || !out->answer.finished)
        return status ? status : explain_answer(judged, out, reason);
    struct hit *hit = alloc_zeroed(part, sizeof *hit);
    if (!hit)
        return fail(reason, STATUS_MEMORY, "no memory to trace %zu rays", part);
    const struct hit alone = out->answer.hit, *among = &hit[index - at];
    if (ask(judged, ray + at, part, hit) && memcmp(among, &alone, sizeof alone) != 0 &&
        is_wrong(judged, &out->ray, &out->truth, among)) {
        out->answer.hit = *among;
        out->alone = alone;
        out->among = part;
        status = judge_answer(judged->judge, &out->ray, &out->truth, &alone, &out->alone_judgement);
    }
    free(hit);
    return status ? fail(reason, status, "no memory to judge a ray")
                  : explain_answer(judged, out, reason);
}

/* The first of these rays that the engine does not finish alone, or `count`. */
static size_t first_unfinished(struct judged *judged, const struct ray *ray, size_t count)
{
    struct hit hit;
    for (size_t i = 0; i < count; i++)
        if (!ask(judged, &ray[i], 1, &hit))
            return i;
    return count;
}

enum status judged_find(struct judged *judged, const struct ray *ray, size_t first, size_t count,
                        size_t *index, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct oracle_answer *truth = alloc_zeroed(SEARCH_BATCH, sizeof *truth);
    struct hit *hit = alloc_zeroed(SEARCH_BATCH, sizeof *hit);
    if (!truth || !hit)
        status = fail(reason, STATUS_MEMORY, "no memory to look for a wrong ray");
    *index = count;
    for (size_t at, part, from = first; from < count && !status && *index == count;
         from = at + part) {
        company_of(from, count, &at, &part);
        bool finished = ask(judged, ray + at, part, hit);
        if (!finished) {
            size_t which = first_unfinished(judged, ray + from, at + part - from);
            if (from + which < at + part)
                *index = from + which;
            continue; /* rays that fail only together cannot be named */
        }
        status = oracle_closest(judged->from.oracle, ORACLE_AUTO, ORACLE_CLOSED, ray + at, part, 0,
                                truth, NULL, reason);
        for (size_t i = from - at; i < part && !status && *index == count; i++)
            if (is_wrong(judged, &ray[at + i], &truth[i], &hit[i]))
                *index = at + i;
    }
    free(truth);
    free(hit);
    return status;
}

#include "tests/truth/play.h"

#include <stdlib.h>
#include <string.h>

void stand_free(struct play_stand *stand)
{
    if (stand->has_judged)
        judged_free(&stand->judged);
    packed_free(&stand->packed);
    *stand = (struct play_stand){0};
}

enum status stand_tree(const struct scene *scene, struct bvh *out, struct reason *reason)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    return builders[0]->build(scene, &build, out, reason);
}

bool stand_make(const struct tally_contestant *who, void *self, const struct scene *scene,
                const struct bvh *bvh, const struct oracle *oracle, struct play_stand *out,
                struct reason *reason)
{
    *out = (struct play_stand){.who = who, .scene = scene, .bvh = bvh, .oracle = oracle};
    out->job =
        (struct job){.scene = scene, .box = who->box, .tri = who->tri, .query = QUERY_CLOSEST};
    enum status status = STATUS_OK;
    if (who->layout) {
        status = packed_make(who->layout, bvh, scene, &out->packed, reason);
        out->job.packed = &out->packed;
    }
    if (!status)
        status = who->engine->prepare(self, &out->job, reason);
    if (!status) {
        struct judged_job from = {
            .engine = who->engine, .self = self, .job = &out->job, .bvh = bvh, .oracle = oracle};
        status = judged_make(&from, &out->judged, reason);
        out->has_judged = status == STATUS_OK;
    }
    return status == STATUS_OK;
}

static struct wrong_answer wrong_at(const struct ground *ground, const struct tally_contestant *who,
                                    size_t i)
{
    struct wrong_answer wrong = {.who = *who,
                                 .cause = CAUSE_UNEXPLAINED,
                                 .rays = ground->rays,
                                 .index = i,
                                 .seed = ground->seed,
                                 .ray = ground->ray[i],
                                 .hit = ground->hit[i],
                                 .judgement = ground->judgement[i]};
    snprintf(wrong.scene, sizeof wrong.scene, "%s", ground->spec);
    return wrong;
}

/* Decides `count` wrong answers again, the rays wrong[0 .. count - 1] of the ground. */
static void redecide(const struct ground *ground, const struct model *model, const uint32_t *wrong,
                     size_t count, uint8_t *opinion)
{
#pragma omp parallel for schedule(dynamic, 4)
    for (long long n = 0; n < (long long)count; n++) {
        uint32_t i = wrong[n];
        opinion[n] = (uint8_t)exact_gmp_redecide(&ground->scene, &ground->ray[i], model, false,
                                                 &ground->hit[i])
                         .opinion;
    }
}

/* Decides the wrong answers again, explains the first of them, cuts each new kind down. */
static enum status follow_up(const struct ground *ground, const struct tally_contestant *who,
                             struct play_stand *stand, void *self, struct tally *tally)
{
    size_t count = 0, known = tally->count;
    uint32_t *at = malloc(ground->count * sizeof *at);
    uint8_t *opinion = malloc(ground->count);
    for (size_t i = 0; at && i < ground->count; i++)
        if (ground->judgement[i].verdict == VERDICT_WRONG)
            at[count++] = (uint32_t)i;
    if (at && opinion)
        redecide(ground, &stand->judged.model, at, count, opinion);
    for (size_t n = 0; at && opinion && n < count; n++) {
        struct wrong_answer wrong = wrong_at(ground, who, at[n]);
        struct judged_ray one;
        struct reason reason;
        wrong.opinion = opinion[n];
        if (n < WRONG_EXPLAINED && !judged_explain(&stand->judged, &wrong.ray, &one, &reason)) {
            wrong.cause = one.why.cause;
            explain_free(&one.why);
        }
        (void)tally_add(tally, &wrong);
    }
    for (size_t i = known; i < tally->count; i++)
        reduce(&tally->signature[i].first, &ground->scene, self, &tally->signature[i].smallest);
    bool done = at && opinion;
    free(at);
    free(opinion);
    return done ? STATUS_OK : STATUS_MEMORY;
}

void play_count(struct play_result *out, const struct hit *hit, const struct judgement *judgement,
                size_t count)
{
    for (size_t i = 0; i < count; i++) {
        out->verdict[judgement[i].verdict]++;
        out->hits += hit[i].prim != ABI_NO_PRIM;
        if (judgement[i].over > out->worst_over)
            out->worst_over = judgement[i].over;
    }
    out->judged = count;
}

enum status play(const struct ground *ground, const struct tally_contestant *who, struct pool *pool,
                 struct tally *tally, struct play_result *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct trace_report report;
    struct play_stand stand = {0};
    *out = (struct play_result){0};
    void *self = pool_get(pool, who->engine, &status, reason);
    if (status ||
        !stand_make(who, self, &ground->scene, &ground->bvh, ground->oracle, &stand, reason)) {
        stand_free(&stand);
        out->refused = true;
        return STATUS_OK;
    }
    status = who->engine->trace(self, ground->ray, ground->count, ground->hit, &report, reason);
    int bad = 0;
    if (!status) {
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : bad)
        for (long long i = 0; i < (long long)ground->count; i++)
            bad += judge_answer(stand.judged.judge, &ground->ray[i], &ground->truth[i],
                                &ground->hit[i], &ground->judgement[i]) != STATUS_OK;
        if (bad)
            status = fail(reason, STATUS_MEMORY, "no memory to judge %d answers", bad);
    }
    if (!status)
        play_count(out, ground->hit, ground->judgement, ground->count);
    if (!status && out->verdict[VERDICT_WRONG] > 0)
        status = follow_up(ground, who, &stand, self, tally);
    stand_free(&stand);
    return status;
}

#include "cmd/bench/cmd_bench_known.h"

#include "bench/measure/error_measure.h"

#include <math.h>
#include <stdlib.h>

void known_free(struct known_rays *known)
{
    free(known->ray);
    free(known->truth);
    *known = (struct known_rays){0};
}

enum status known_alloc(size_t count, struct known_rays *out, struct reason *reason)
{
    *out = (struct known_rays){.ray = alloc_zeroed(count, sizeof *out->ray),
                               .truth = alloc_zeroed(count, sizeof *out->truth),
                               .count = count};
    if (out->ray && out->truth)
        return STATUS_OK;
    known_free(out);
    return fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
}

enum status known_decide(const struct oracle *oracle, const struct scene *scene, unsigned threads,
                         uint64_t brute_pairs, struct known_rays *known, struct reason *reason)
{
    bool few = (uint64_t)known->count * scene->tri_count < brute_pairs;
    return oracle_closest(oracle, few ? ORACLE_BRUTE : ORACLE_TREE, ORACLE_CLOSED, known->ray,
                          known->count, threads, known->truth, NULL, reason);
}

enum status known_trace(const struct known_rays *known, const struct contestant *c, struct hit *hit,
                        struct trace_report *report, struct reason *reason)
{
    *report = (struct trace_report){0};
    return c->engine->trace(c->self, known->ray, known->count, hit, report, reason);
}

bool known_is_judged(const struct contestant *c)
{
    return !(c->layout && (c->layout->faithful || c->box->faithful));
}

enum status known_judge(const struct oracle *oracle, const struct known_rays *known,
                        const struct contestant *c, enum query query, const struct hit *hit,
                        struct known_verdicts *sum, struct reason *reason)
{
    struct model model = engine_model(c->engine, c->self, c->tri);
    struct judge *judge;
    size_t wrong = 0, allowed = 0, failed = 0;
    double over = 0, displacement = 0;
    enum status status = judge_make(oracle, &model, query, &judge, reason);
    if (status)
        return status;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : wrong, allowed, failed) \
    reduction(max : over, displacement)
    for (long long i = 0; i < (long long)known->count; i++) {
        struct judgement judgement;
        failed +=
            judge_answer(judge, &known->ray[i], &known->truth[i], &hit[i], &judgement) != STATUS_OK;
        wrong += judgement.verdict == VERDICT_WRONG;
        allowed += judgement.verdict != VERDICT_WRONG && judgement.verdict != VERDICT_RIGHT;
        over = fmax(over, judgement.over);
        displacement = fmax(displacement, judgement.displacement);
    }
    judge_free(judge);
    if (failed)
        return fail(reason, STATUS_MEMORY, "no memory to judge %zu answers", failed);
    const struct known_verdicts more = {.compared = known->count,
                                        .allowed = allowed,
                                        .wrong = wrong,
                                        .over = over,
                                        .displacement = displacement};
    known_add(sum, &more);
    return STATUS_OK;
}

void known_add(struct known_verdicts *sum, const struct known_verdicts *more)
{
    sum->compared += more->compared;
    sum->allowed += more->allowed;
    sum->wrong += more->wrong;
    sum->over = fmax(sum->over, more->over);
    sum->displacement = fmax(sum->displacement, more->displacement);
}

size_t known_hits(const struct known_rays *known)
{
    size_t hits = 0;
    for (size_t i = 0; i < known->count; i++)
        hits += known->truth[i].prim != ABI_NO_PRIM;
    return hits;
}

void bench_rate(int width, size_t events, size_t count)
{
    char text[32];
    error_rate_text(events, count, text, sizeof text);
    printf(" %*s", width, text);
}

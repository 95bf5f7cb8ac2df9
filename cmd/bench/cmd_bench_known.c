#include "cmd/bench/cmd_bench_known.h"

#include "bench/measure/error_measure.h"

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

void bench_rate(int width, size_t events, size_t count)
{
    char text[32];
    error_rate_text(events, count, text, sizeof text);
    printf(" %*s", width, text);
}

/* Rays with their exact answers. For commands only. */
#ifndef CMD_BENCH_KNOWN_H
#define CMD_BENCH_KNOWN_H

#include "cmd/bench/cmd_bench_race.h"
#include "ref/oracle/oracle.h"

/* Owns both arrays; known_free frees them. */
struct known_rays {
    struct ray *ray;
    struct oracle_answer *truth;
    size_t count;
};

/* Allocates arrays of zeros. Errors: STATUS_MEMORY; *out is then zero. */
enum status known_alloc(size_t count, struct known_rays *out, struct reason *reason) MUST_USE;

/* Fills in the exact answers: by brute force if rays times triangles are fewer than `brute_pairs`,
 * else by the oracle's own tree. Errors: as oracle_closest. */
enum status known_decide(const struct oracle *oracle, const struct scene *scene, unsigned threads,
                         uint64_t brute_pairs, struct known_rays *known,
                         struct reason *reason) MUST_USE;

/* Traces all rays with the contestant. Errors: as engine.trace. */
enum status known_trace(const struct known_rays *known, const struct contestant *c, struct hit *hit,
                        struct trace_report *report, struct reason *reason) MUST_USE;

/* Verdicts of the judge on a contestant's answers. */
struct known_verdicts {
    size_t compared;     /* answers judged */
    size_t allowed;      /* of these in an allowed class */
    size_t wrong;        /* WRONG */
    double over;         /* largest error of t over its proven bound; 0: no bounds */
    double displacement; /* the largest that answers of an unknown formula need, see judge.h */
};

/* False if a member as published takes part, whose answers are known to be wrong: its verdicts are
 * only counted. */
bool known_is_judged(const struct contestant *c);

/* Judges the contestant's answers to `query` on the oracle's scene and adds the verdicts to *sum.
 * Errors: STATUS_MEMORY. */
enum status known_judge(const struct oracle *oracle, const struct known_rays *known,
                        const struct contestant *c, enum query query, const struct hit *hit,
                        struct known_verdicts *sum, struct reason *reason) MUST_USE;

/* Adds verdicts to *sum. */
void known_add(struct known_verdicts *sum, const struct known_verdicts *more);

/* How many of the rays hit something exactly. */
size_t known_hits(const struct known_rays *known);

void known_free(struct known_rays *known);

/* Prints a blank and the text of error_rate_text, at least `width` wide. */
void bench_rate(int width, size_t events, size_t count);

#endif

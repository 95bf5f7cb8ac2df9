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

void known_free(struct known_rays *known);

/* Prints a blank and the text of error_rate_text, at least `width` wide. */
void bench_rate(int width, size_t events, size_t count);

#endif

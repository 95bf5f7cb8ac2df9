/* Workers of the fuzzing benchmark: processes that each play trials on request. */
#ifndef CMD_BENCH_FUZZ_H
#define CMD_BENCH_FUZZ_H

#include "ref/outside/child.h"
#include "fuzz/play/player.h"

#define CREW_MOST 64u

/* What one worker did in one turn or while warming up. */
struct crew_report {
    struct fuzz_time time;
    uint64_t ns, core_ns; /* wall-clock time; core time of all threads of the process */
    uint64_t trials, triangles, rays, judged, wrong, refused;
    enum status status;
    struct reason reason;
};

struct crew {
    struct child worker[CREW_MOST];
    size_t count;
};

/* Starts `count` processes. Each opens the field and plays some trials, so that pipelines exist.
 * The calling process must not have opened any engine. Errors: STATUS_DEVICE a process could not be
 * started or died; else the first error of a worker. Call crew_stop in any case. */
enum status crew_start(const struct fuzz_field *field, uint64_t seed, size_t count,
                       struct crew *out, struct reason *reason) MUST_USE;

/* Lets the first `workers` processes play `trials` trials each at the same time. Worker i begins at
 * trial first + i * trials and fills report[i]. Errors: those of a worker; STATUS_DEVICE it
 * died. */
enum status crew_play(struct crew *crew, size_t workers, uint64_t first, uint64_t trials,
                      struct crew_report *report, struct reason *reason) MUST_USE;

void crew_stop(struct crew *crew);

#endif

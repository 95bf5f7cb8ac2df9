/* Worker processes of the fuzzing benchmark. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/bench/cmd_bench_fuzz.h"

#include "fuzz/gen/gen.h"

#include <stdlib.h>
#include <time.h>

/* Trials of few rays, played before anything is measured. They make every pipeline except those of
 * the deepest stacks. */
#define WARM_TRIALS 1536u
#define WARM_RAYS   8u

/* An order for a worker: the first trial and the number of trials. */
struct crew_order {
    uint64_t first, trials;
};

static uint64_t core_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static struct fuzz_trial trial[FUZZ_BATCH];
static struct fuzz_result result[FUZZ_BATCH];

static enum status play_some(struct fuzz_player *player, uint64_t seed, uint64_t first,
                             size_t count, uint32_t rays, struct crew_report *report)
{
    const struct gen_options options = {.triangles_least = 16, .triangles_most = 64, .rays = rays};
    enum status status = STATUS_OK;
    size_t made = 0;
    uint64_t start = time_ns();
    while (made < count && !status) {
        status = gen_trial(seed, first + made, &options, &trial[made], &report->reason);
        made += status == STATUS_OK;
    }
    report->time.generate += time_ns() - start;
    if (!status)
        status = fuzz_play(player, trial, count, result, &report->time, NULL, &report->reason);
    for (size_t i = 0; i < made; i++) {
        report->triangles += trial[i].scene.tri_count;
        report->rays += trial[i].ray_count;
        report->judged += status ? 0 : result[i].judged;
        report->wrong += status ? 0 : result[i].wrong;
        report->refused += status ? 0 : result[i].refused;
        fuzz_trial_free(&trial[i]);
    }
    report->trials += count;
    return status;
}

static struct crew_report play_turn(struct fuzz_player *player, uint64_t seed,
                                    struct crew_order order, uint32_t rays)
{
    struct crew_report report = {0};
    uint64_t start = time_ns(), core = core_ns();
    for (uint64_t done = 0; done < order.trials && !report.status; done += FUZZ_BATCH) {
        uint64_t left = order.trials - done;
        report.status = play_some(player, seed, order.first + done,
                                  left < FUZZ_BATCH ? (size_t)left : FUZZ_BATCH, rays, &report);
    }
    report.ns = time_ns() - start;
    report.core_ns = core_ns() - core;
    return report;
}

/* Settings of a worker. The child process has a copy. */
struct crew_work {
    const struct fuzz_field *field;
    uint64_t seed;
};

/* Runs in a worker process until the parent ends it. */
static void work(struct child *parent, void *user)
{
    const struct crew_work *of = user;
    struct fuzz_player *player = NULL;
    struct crew_report report = {0};
    struct crew_order order = {0, WARM_TRIALS};
    /* Each worker has one core, so further driver threads would only wait for each other. */
    setenv("LP_NUM_THREADS", "0", 0);
    report.status = fuzz_player_open(of->field, &player, &report.reason);
    if (!report.status)
        report = play_turn(player, of->seed ^ 0x5741524Du, order, WARM_RAYS);
    while (child_send(parent, &report, sizeof report, CHILD_FOREVER) && !report.status &&
           child_receive_into(parent, &order, sizeof order, CHILD_FOREVER))
        report = play_turn(player, of->seed, order, 500);
    fuzz_player_close(player);
}

static enum status hear(struct crew *crew, size_t i, struct crew_report *report,
                        struct reason *reason)
{
    struct child_fate fate;
    if (!child_receive_into(&crew->worker[i], report, sizeof *report, CHILD_FOREVER)) {
        child_end(&crew->worker[i], 1000, &fate);
        return fail(reason, STATUS_DEVICE, "a worker %s while it played", fate.text);
    }
    if (report->status)
        *reason = report->reason;
    return report->status;
}

enum status crew_start(const struct fuzz_field *field, uint64_t seed, size_t count,
                       struct crew *out, struct reason *reason)
{
    struct crew_work of = {field, seed};
    enum status status = STATUS_OK;
    *out = (struct crew){.count = 0};
    for (; out->count < count && !status; out->count += status == STATUS_OK)
        status = child_start(work, &of, &out->worker[out->count], reason);
    for (size_t i = 0; i < out->count && !status; i++) {
        struct crew_report report;
        status = hear(out, i, &report, reason);
    }
    return status;
}

enum status crew_play(struct crew *crew, size_t workers, uint64_t first, uint64_t trials,
                      struct crew_report *report, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < workers; i++) {
        const struct crew_order order = {first + i * trials, trials};
        if (!child_send(&crew->worker[i], &order, sizeof order, 10000))
            return fail(reason, STATUS_DEVICE, "a worker died");
    }
    for (size_t i = 0; i < workers && !status; i++)
        status = hear(crew, i, &report[i], reason);
    return status;
}

void crew_stop(struct crew *crew)
{
    for (size_t i = 0; i < crew->count; i++)
        child_end(&crew->worker[i], 10000, NULL);
    crew->count = 0;
}

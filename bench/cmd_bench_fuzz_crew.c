/* Worker processes of the fuzzing benchmark. */
#define _POSIX_C_SOURCE 200809L
#include "bench/cmd_bench_fuzz.h"

#include "fuzz/gen.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Trials that are played before anything is measured, of few rays: enough to meet every pipeline
 * but those of the deepest stacks. */
#define WARM_TRIALS 1536u
#define WARM_RAYS   8u

/* A worker's orders: the first trial and how many; none: it ends. */
struct order {
    uint64_t first, trials;
};

static bool send_all(int file, const void *data, size_t bytes)
{
    const char *at = data;
    while (bytes > 0) {
        ssize_t done = write(file, at, bytes);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        at += done;
        bytes -= (size_t)done;
    }
    return true;
}

static bool receive_all(int file, void *data, size_t bytes)
{
    char *at = data;
    while (bytes > 0) {
        ssize_t done = read(file, at, bytes);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        at += done;
        bytes -= (size_t)done;
    }
    return true;
}

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

static struct crew_report play_turn(struct fuzz_player *player, uint64_t seed, struct order order,
                                    uint32_t rays)
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

/* The life of a worker; nothing of the parent's is flushed or freed here. */
static _Noreturn void work(const struct fuzz_field *field, uint64_t seed, int ask, int answer)
{
    struct fuzz_player *player = NULL;
    struct crew_report report = {0};
    struct order order = {0, WARM_TRIALS};
    /* A core for each worker: the driver's own threads would only wait for each other. */
    setenv("LP_NUM_THREADS", "0", 0);
    report.status = fuzz_player_open(field, &player, &report.reason);
    if (!report.status)
        report = play_turn(player, seed ^ 0x5741524Du, order, WARM_RAYS);
    while (send_all(answer, &report, sizeof report) && !report.status &&
           receive_all(ask, &order, sizeof order) && order.trials > 0)
        report = play_turn(player, seed, order, 500);
    fuzz_player_close(player);
    _exit(0);
}

static enum status start_one(const struct fuzz_field *field, uint64_t seed, struct crew *crew,
                             struct reason *reason)
{
    int ask[2], answer[2];
    if (pipe(ask))
        return fail(reason, STATUS_INTERNAL, "no pipe: %s", strerror(errno));
    if (pipe(answer)) {
        close(ask[0]), close(ask[1]);
        return fail(reason, STATUS_INTERNAL, "no pipe: %s", strerror(errno));
    }
    pid_t pid = fork();
    if (pid == 0) {
        for (size_t i = 0; i < crew->count; i++)
            close(crew->worker[i].ask), close(crew->worker[i].answer);
        close(ask[1]), close(answer[0]);
        work(field, seed, ask[0], answer[1]);
    }
    close(ask[0]), close(answer[1]);
    if (pid < 0) {
        close(ask[1]), close(answer[0]);
        return fail(reason, STATUS_INTERNAL, "no process: %s", strerror(errno));
    }
    crew->worker[crew->count].pid = pid;
    crew->worker[crew->count].ask = ask[1];
    crew->worker[crew->count++].answer = answer[0];
    return STATUS_OK;
}

static enum status hear(const struct crew *crew, size_t i, struct crew_report *report,
                        struct reason *reason)
{
    if (!receive_all(crew->worker[i].answer, report, sizeof *report))
        return fail(reason, STATUS_DEVICE, "a worker died while it played");
    if (report->status)
        *reason = report->reason;
    return report->status;
}

enum status crew_start(const struct fuzz_field *field, uint64_t seed, size_t count,
                       struct crew *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    *out = (struct crew){.count = 0};
    signal(SIGPIPE, SIG_IGN); /* a dead worker is an error of a write */
    for (size_t i = 0; i < count && !status; i++)
        status = start_one(field, seed, out, reason);
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
        const struct order order = {first + i * trials, trials};
        if (!send_all(crew->worker[i].ask, &order, sizeof order))
            return fail(reason, STATUS_DEVICE, "a worker died");
    }
    for (size_t i = 0; i < workers && !status; i++)
        status = hear(crew, i, &report[i], reason);
    return status;
}

void crew_stop(struct crew *crew)
{
    const struct order end = {0, 0};
    for (size_t i = 0; i < crew->count; i++) {
        (void)send_all(crew->worker[i].ask, &end, sizeof end);
        close(crew->worker[i].ask);
        close(crew->worker[i].answer);
    }
    for (size_t i = 0; i < crew->count; i++)
        while (waitpid(crew->worker[i].pid, NULL, 0) < 0 && errno == EINTR)
            continue;
    crew->count = 0;
}

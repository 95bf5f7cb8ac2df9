/* Speed of fuzzing trials: on one core, and on all cores with one process each. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/bench/cmd_bench_fuzz.h"

#include "cmd/bench/cmd_bench.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TRIALS 512 /* per worker and turn */

static const char about[] =
    "generated trials of 16 to 64 triangles and 500 rays, played on cpu, vulkan and "
    "embree_robust and f32 and rf16 unless told otherwise. Each worker is a process "
    "with one thread; --count is trials of a worker and round. A judged ray has a "
    "verdict for every contestant. The harness makes trials, builds and packs trees, "
    "decides rays exactly and judges; pipelines were made before. What it finds is "
    "counted only: use raydiff fuzz to keep findings. us of core time: also where other work on "
    "the machine takes cores away.\n"
    "";

/* Parts of the harness. */
static const char *const part_name[] = {"generate", "build", "truth", "judge"};
#define PARTS ARRAY_COUNT(part_name)

/* Results for one number of workers, one value per round. */
struct bench_setting {
    size_t workers;
    double trials[BENCH_ROUNDS], judged[BENCH_ROUNDS]; /* per second, all workers */
    double share[BENCH_ROUNDS];                        /* the harness's share of the time */
    double ratio[BENCH_ROUNDS]; /* time of the harness over that of the engines */
    double core[BENCH_ROUNDS];  /* us of core time per trial */
    double us[FUZZ_CONTESTANTS_MOST + PARTS][BENCH_ROUNDS]; /* per trial: engines, then parts */
    uint64_t all, triangles, wrong, refused;
};

/* Adds up one round. All workers begin at the same time, and each measures its speed by its own
 * clock. */
static void take_round(struct bench_setting *setting, const struct fuzz_field *field, size_t round,
                       const struct crew_report *report)
{
    double asked = 0, harness = 0, core = 0, trials = 0, ns[FUZZ_CONTESTANTS_MOST + PARTS] = {0};
    setting->trials[round] = setting->judged[round] = 0;
    for (size_t w = 0; w < setting->workers; w++) {
        const struct crew_report *one = &report[w];
        const uint64_t part[PARTS] = {one->time.generate, one->time.build, one->time.truth,
                                      one->time.judge};
        setting->trials[round] += (double)one->trials / ((double)one->ns * 1e-9);
        setting->judged[round] += (double)one->judged / ((double)one->ns * 1e-9);
        for (size_t i = 0; i < field->count + PARTS; i++)
            ns[i] += (double)(i < field->count ? one->time.engine[i] : part[i - field->count]);
        core += (double)one->core_ns;
        trials += (double)one->trials;
        setting->all += one->trials;
        setting->triangles += one->triangles;
        setting->wrong += one->wrong;
        setting->refused += one->refused;
    }
    for (size_t i = 0; i < field->count + PARTS; i++) {
        if (i < field->count)
            asked += ns[i];
        else
            harness += ns[i];
        setting->us[i][round] = ns[i] * 1e-3 / trials;
    }
    setting->share[round] = harness / (harness + asked);
    setting->ratio[round] = harness / asked;
    setting->core[round] = core * 1e-3 / trials;
}

static void report_setting(struct bench *bench, const struct fuzz_field *field,
                           struct bench_setting *setting)
{
    size_t rounds = (size_t)bench->rounds;
    struct spread trials = spread_of(setting->trials, rounds);
    struct spread judged = spread_of(setting->judged, rounds);
    struct spread share = spread_of(setting->share, rounds);
    double ratio = spread_of(setting->ratio, rounds).median;
    double core = spread_of(setting->core, rounds).median;
    double triangles = (double)setting->triangles / (double)setting->all;
    const struct screen *screen = &bench->screen_is;
    screen_text(screen, "%s: %.0f (%.0f-%.0f) trials/s, %.3f (%.3f-%.3f) million judged rays/s\n",
                COUNTED(setting->workers, "worker"), trials.median, trials.least, trials.most,
                judged.median * 1e-6, judged.least * 1e-6, judged.most * 1e-6);
    printf("  harness %.1f %% (%.1f-%.1f) of the time, %.2f of the engines'\n"
           "  %.0f us of core time a trial\n",
           share.median * 100, share.least * 100, share.most * 100, ratio, core);
    screen_text(screen, "  %s of %.1f triangles, %s at fault, %s\n", COUNTED(setting->all, "trial"),
                triangles, COUNTED(setting->wrong, "answer"), COUNTED(setting->refused, "refusal"));
    json_t *row = json_record(
        "workers=%zu trials=%zu trials_per_s=%g trials_per_s_least=%g "
        "trials_per_s_most=%g judged_rays_per_s=%g harness_share=%g "
        "harness_to_engines=%g core_us_per_trial=%g triangles=%g at_fault=%zu "
        "refused=%zu",
        setting->workers, setting->all, trials.median, trials.least, trials.most, judged.median,
        share.median, ratio, core, triangles, setting->wrong, setting->refused);
    for (size_t i = 0; i < field->count + PARTS; i++) {
        char name[96];
        double us = spread_of(setting->us[i], rounds).median;
        if (i < field->count)
            snprintf(name, sizeof name, "%s_%s_us", field->who[i].engine->name,
                     field->who[i].layout ? field->who[i].layout->name : "alone");
        else
            snprintf(name, sizeof name, "%s_us", part_name[i - field->count]);
        printf("  %-24s %8.1f us a trial\n", name, us);
        json_add(row, "%s=%g", name, us);
    }
    bench_row(bench, &bench_fuzz, row);
}

/* Makes the field of the members that the user named, or of the benchmark's own. */
static enum status make_field(const struct bench *bench, struct fuzz_field *out,
                              struct reason *reason)
{
    static const char *const own_engine[] = {"cpu", "vulkan", "embree_robust", NULL};
    static const char *const own_layout[] = {"f32", "rf16", NULL};
    const void *engines_chosen[LIST_MOST], *layouts_chosen[LIST_MOST];
    const struct engine *engine[LIST_MOST];
    const struct layout *layout[LIST_MOST];
    size_t engine_count = bench_members(TABLE_ENGINES, &bench->engine, own_engine, engines_chosen);
    size_t layout_count = bench_members(TABLE_LAYOUTS, &bench->layout, own_layout, layouts_chosen);
    struct engine_options options = bench->engines;
    options.threads = 1;
    for (size_t i = 0; i < engine_count; i++)
        engine[i] = engines_chosen[i];
    for (size_t i = 0; i < layout_count; i++)
        layout[i] = layouts_chosen[i];
    return fuzz_field_make(engine, engine_count, layout, layout_count, &options, out, reason);
}

static enum status measure(struct bench *bench, const struct fuzz_field *field, struct crew *crew,
                           struct bench_setting *setting, size_t settings, struct reason *reason)
{
    static struct crew_report report[CREW_MOST];
    uint64_t trials = bench_rays_count(bench, TRIALS), first = 0;
    enum status status = STATUS_OK;
    for (size_t round = 0; round < bench->rounds && !status; round++)
        for (size_t i = 0; i < settings && !status; i++) {
            progress_step(&bench->progress, "round %zu, %zu workers", round, setting[i].workers);
            status = crew_play(crew, setting[i].workers, first, trials, report, reason);
            first += setting[i].workers * trials;
            if (!status)
                take_round(&setting[i], field, round, report);
        }
    progress_end(&bench->progress);
    return status;
}

static int run(struct bench *bench)
{
    static struct bench_setting setting[2];
    struct fuzz_field field;
    struct crew crew = {.count = 0};
    struct reason reason = {""};
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    size_t workers = cores < 1 ? 1 : cores > (long)CREW_MOST ? CREW_MOST : (size_t)cores;
    size_t settings = workers > 1 ? 2 : 1;
    setting[0].workers = 1;
    setting[1].workers = workers;
    puts("\nfuzz");
    fflush(stdout); /* else each worker would print the buffered text again */
    enum status status = make_field(bench, &field, &reason);
    if (!status)
        status = crew_start(&field, bench->seed, workers, &crew, &reason);
    if (!status)
        status = measure(bench, &field, &crew, setting, settings, &reason);
    crew_stop(&crew);
    bench_failed(bench, NULL, status, &reason);
    for (size_t i = 0; i < settings && !status; i++)
        report_setting(bench, &field, &setting[i]);
    return bench->code;
}

const struct benchmark bench_fuzz = {
    .name = "fuzz",
    .shown = "times; answers at fault are counted, not judged",
    .summary = "trials and judged rays a second, and where the time goes",
    .takes = "count rounds csv json seed engine layout driver device workgroup" BENCH_OUTSIDE
        BENCH_COMPILERS,
    .about = about,
    .run = run,
};

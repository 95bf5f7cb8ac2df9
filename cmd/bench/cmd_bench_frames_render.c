/* raydiff render --benchmark: measures the frames that render draws. */
#include "cmd/bench/cmd_bench_frames.h"

#include "fuzz/findings/versions.h"
#include "ref/base/command.h"
#include "cmd/render/cmd_render.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

extern const struct render_mode render_mode_benchmark;

/* The run of one handler. */
struct benchmark_run {
    struct render_stage stage;
    struct renderer *renderer;
    uint32_t *pixel;
    struct frames_run run;
    struct frames_about about;
    const char *base; /* base name of the files */
    struct progress progress;
    char title[200], versions[FRAMES_VERSIONS];
};

static enum status draw(void *user, size_t contestant, double angle, struct frames_sample *out,
                        struct reason *reason)
{
    struct benchmark_run *b = user;
    struct view view = render_stage_view(&b->stage, angle);
    struct frame frame = {.pixel = b->pixel};
    struct trace_report report = {0};
    (void)contestant;
    progress_done(&b->progress, b->run.done, b->run.settings.frames, NULL);
    progress_step(&b->progress, "frame %u of %u", b->run.done + 1, b->run.settings.frames);
    enum status status = renderer_frame(b->renderer, &view, &frame, &report, reason);
    *out = (struct frames_sample){1e-6 * (double)report.ns, report.device_clock};
    return status;
}

static enum status tell(void *user, const struct frames_run *run, struct reason *reason)
{
    struct benchmark_run *b = user;
    return frames_write(run, &b->about, b->base, reason);
}

/* The handler's name in RTRS's chart. */
static const char *handler_name(const struct render_settings *settings)
{
    static const char *const names[][2] = {
        {"naive", "Naive"}, {"bvh", "BVH"}, {"bvh-rf", "RF-BVH"}, {"blank", "Blank"}};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        if (strcmp(settings->handler->name, names[i][0]) == 0)
            return names[i][1];
    return settings->handler->name;
}

static enum status prepare(const struct render_settings *settings, struct benchmark_run *b,
                           struct reason *reason)
{
    const struct frame_job *job = &b->stage.job;
    char handler[48];
    const struct packed *packed = job->job.packed;
    uint64_t bytes = packed ? packed_node_bytes(packed) + packed_item_bytes(packed) : 0;
    bool turns = b->stage.camera.orbit || option_was_given("benchmark-turns");
    struct frames_settings frames = {.frames = (uint32_t)settings->benchmark.frames,
                                     .turns = turns ? (uint32_t)settings->benchmark.turns : 0,
                                     .warm_up = (uint32_t)settings->benchmark.warm_up,
                                     .stop = frames_stop_flag()};
    b->pixel = alloc_zeroed((size_t)job->width * job->height, sizeof *b->pixel);
    if (!b->pixel)
        return fail(reason, STATUS_MEMORY, "no memory for a picture");
    snprintf(handler, sizeof handler, "%s (%s%s%s)", handler_name(settings), settings->engine->name,
             packed ? " " : "", packed ? packed->layout->name : "");
    enum status status = frames_make(&frames, &b->run, reason);
    if (!status)
        status = frames_enter(&b->run, handler, bytes, reason);
    if (status)
        return status;
    b->run.contestant[0].rays_alone = settings->waves || !settings->engine->renderer;
    snprintf(b->title, sizeof b->title, "%.60s: %s, %u x %u pixels, %s", b->stage.name,
             COUNTED(b->stage.tri_count, "triangle"), job->width, job->height,
             COUNTED(job->look.bounces, "bounce"));
    fuzz_versions(&settings->engine, 1, &settings->engine_options, b->versions, sizeof b->versions);
    b->base = settings->benchmark.base;
    b->about = (struct frames_about){
        .title = b->title,
        .note = {{"scene", b->stage.name},
                 {"profile", job->look.profile == PROFILE_RTRS ? "rtrs" : "repaired"},
                 {"versions", b->versions}},
        .base = SIZE_MAX};
    return STATUS_OK;
}

static enum status open_all(const struct render_settings *settings, struct benchmark_run *b,
                            struct reason *reason)
{
    struct render_settings shared = *settings; /* bench frames draws the same */
    shared.framing = FRAMING_OVERVIEW;
    enum status status = render_stage_open("render", &shared, &b->stage, reason);
    if (!status)
        status = renderer_open(settings->engine, &settings->engine_options, settings->waves,
                               &b->renderer, reason);
    if (!status)
        status = renderer_prepare(b->renderer, &b->stage.job, reason);
    if (!status)
        status = prepare(settings, b, reason);
    return status;
}

static int run(const struct render_settings *settings, const char *value)
{
    struct reason reason = {""};
    struct benchmark_run *b = calloc(1, sizeof *b);
    (void)value;
    if (!b)
        return EXIT_INTERNAL;
    b->progress = progress_make("render");
    frames_catch_signals();
    enum status status = frames_try(settings->benchmark.base, &reason);
    if (!status)
        status = open_all(settings, b, &reason);
    if (!status)
        status = frames_measure(&b->run, draw, tell, b, &reason);
    progress_end(&b->progress);
    struct screen screen = screen_make(&(struct screen_options){.wide = false});
    int code = frames_finish("render", &b->run, &b->about, settings->benchmark.base, &screen,
                             status, &reason);
    frames_free(&b->run);
    free(b->pixel);
    renderer_close(b->renderer);
    render_stage_close(&b->stage);
    free(b);
    return code;
}

#define ROWS_OF struct render_settings

const struct option_row render_benchmark_rows[] = {
    {"benchmark-frames", "N", "measured", OF_COUNT(benchmark.frames, 1, FRAMES_MOST),
     .standard = FRAMES_DEFAULT},
    {"benchmark-turns", "N", "around the target in them; fixed cameras stand",
     OF_COUNT(benchmark.turns, 0, FRAMES_MOST), .standard = FRAMES_TURNS},
    {"benchmark-warm-up", "N", "frames before them, dropped",
     OF_COUNT(benchmark.warm_up, 0, FRAMES_MOST), .standard = FRAMES_WARM_UP},
    {"benchmark-out", "BASE", "name of the files", OF_OUTPUT(benchmark.base), .value = "benchmark"},
    {0},
};

const struct render_mode render_mode_benchmark = {
    .name = "benchmark",
    .row = render_benchmark_rows,
    .never = "out frames angle paths json",
    .run = run,
};

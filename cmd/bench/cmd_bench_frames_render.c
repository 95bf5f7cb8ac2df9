/* raydiff render --benchmark: frames of what render would draw, measured. */
#include "cmd/bench/cmd_bench_frames.h"

#include "fuzz/findings/versions.h"
#include "ref/base/command.h"
#include "cmd/render/cmd_render.h"

#include <stdlib.h>
#include <string.h>

extern const struct render_mode render_mode_benchmark;

enum {
    OPT_FRAMES = OPT_RENDER_LAST + 100, /* other modes have numbers, too */
    OPT_TURNS,
    OPT_WARM_UP,
    OPT_OUT
};

static struct {
    uint64_t frames, turns, warm_up;
    bool turns_given;
    const char *base;
} chosen = {.frames = FRAMES_DEFAULT,
            .turns = FRAMES_TURNS,
            .warm_up = FRAMES_WARM_UP,
            .base = "benchmark"};

static enum status take(void *user, int option, char *text, struct reason *reason)
{
    (void)user;
    switch (option) {
    case OPT_FRAMES:
        return parse_count("--benchmark-frames", text, 1, FRAMES_MOST, &chosen.frames, reason);
    case OPT_TURNS:
        chosen.turns_given = true;
        return parse_count("--benchmark-turns", text, 0, FRAMES_MOST, &chosen.turns, reason);
    case OPT_WARM_UP:
        return parse_count("--benchmark-warm-up", text, 0, FRAMES_MOST, &chosen.warm_up, reason);
    default:
        chosen.base = text;
        return STATUS_OK;
    }
}

/* The run of one handler. */
struct benchmark_run {
    struct render_stage stage;
    struct renderer *renderer;
    uint32_t *pixel;
    struct frames_run run;
    struct frames_about about;
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
    progress_step(&b->progress, "frame %u of %u", b->run.done + 1, b->run.settings.frames);
    enum status status = renderer_frame(b->renderer, &view, &frame, &report, reason);
    *out = (struct frames_sample){1e-6 * (double)report.ns, report.device_clock};
    return status;
}

static enum status tell(void *user, const struct frames_run *run, struct reason *reason)
{
    struct benchmark_run *b = user;
    return frames_write(run, &b->about, chosen.base, reason);
}

/* As RTRS's chart names it. */
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
    bool turns = b->stage.camera.orbit || chosen.turns_given;
    struct frames_settings frames = {.frames = (uint32_t)chosen.frames,
                                     .turns = turns ? (uint32_t)chosen.turns : 0,
                                     .warm_up = (uint32_t)chosen.warm_up,
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
    b->run.contestant[0].rays_alone = settings->waves || !settings->engine->frame;
    snprintf(b->title, sizeof b->title, "%.60s: %u triangles, %u x %u pixels, %u bounces",
             b->stage.name, b->stage.tri_count, job->width, job->height, job->look.bounces);
    fuzz_versions(&settings->engine, 1, &settings->engine_options, b->versions, sizeof b->versions);
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
    enum status status = render_stage_open("render", settings, &b->stage, reason);
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
    enum status status = open_all(settings, b, &reason);
    if (!status) /* a file that cannot be written ends it now */
        status = frames_write(&b->run, &b->about, chosen.base, &reason);
    if (!status)
        status = frames_measure(&b->run, draw, tell, b, &reason);
    progress_end(&b->progress);
    if (b->run.done > 0 || b->run.stopped)
        frames_print(&b->run, &b->about, status ? NULL : chosen.base);
    int code = exit_of_status(status);
    if (status)
        fprintf(stderr, "raydiff render: %s\n", reason.text);
    else if (b->run.stopped)
        code = frames_signal_code();
    frames_free(&b->run);
    free(b->pixel);
    renderer_close(b->renderer);
    render_stage_close(&b->stage);
    free(b);
    return code;
}

static const struct option own[] = {{"benchmark-frames", 1, NULL, OPT_FRAMES},
                                    {"benchmark-turns", 1, NULL, OPT_TURNS},
                                    {"benchmark-warm-up", 1, NULL, OPT_WARM_UP},
                                    {"benchmark-out", 1, NULL, OPT_OUT},
                                    {NULL, 0, NULL, 0}};

const struct render_mode render_mode_benchmark = {
    .name = "benchmark",
    .help =
        "  --benchmark     ms per frame in place of pictures: benchmark.csv, .json, .svg, .png,\n"
        "                  written anew every 10 frames; bench frames compares several\n"
        "  --benchmark-frames N      measured                                [200]\n"
        "  --benchmark-turns N       around the target in them; fixed cameras stand  [5]\n"
        "  --benchmark-warm-up N     frames before them, dropped             [3]\n"
        "  --benchmark-out BASE      name of the files                       [benchmark]\n",
    .option = own,
    .take = take,
    .never = "out frames angle paths json fps",
    .run = run,
};

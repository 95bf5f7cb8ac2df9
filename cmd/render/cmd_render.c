/* raydiff render: draws pictures of a scene with any engine; RTRS's workload. */
#include "cmd/render/cmd_render.h"

#include "cmd/common/cmd_use.h"
#include "cmd/common/cmd_progress.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "cmd/common/cmd_process.h"
#include "cmd/render/cmd_render_out.h"
#include "scenes/picture/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Modes that share the picture options; NULL-terminated. */
extern const struct render_mode render_mode_show, render_mode_benchmark, render_mode_window;
static const struct render_mode *const modes[] = {&render_mode_show, &render_mode_benchmark,
                                                  &render_mode_window, NULL};

#define FRAMES_MOST 100000u
/* Segments are kept for counting up to this many bytes; --paths always keeps them. */
#define SEGMENT_BYTES ((size_t)256 << 20)

/* The settings of the command. */
struct render {
    struct render_settings settings;
    const char *paths;
    uint32_t frames;
    float angle; /* degrees */
    const struct render_mode *mode;
    const char *mode_value;
};

static volatile sig_atomic_t caught;

static enum status take_mode(void *options, const struct option_value *given, struct reason *reason)
{
    struct render *r = options;
    const struct render_mode *const *mode = modes;
    while (strcmp((*mode)->name, given->row->name) != 0)
        mode++;
    if (r->mode)
        return fail(reason, STATUS_INPUT, "--%s and --%s do not go together", r->mode->name,
                    (*mode)->name);
    r->mode = *mode;
    r->mode_value = given->text;
    return STATUS_OK;
}

#define ROWS_OF struct render

static const struct option_row rows[] = {
    {"out", "FILE.png", "written to a temporary name and renamed", OF_OUTPUT(settings.out),
     .value = "render.png"},
    {"frames", "N",
     "a turn of an orbiting camera in N pictures: FILE-0001.png and so on, or FILE%04d.png as "
     "printf has it",
     OF_COUNT(frames, 1, FRAMES_MOST), .value = "1"},
    {"angle", "DEG", "the turn between two pictures", OF_REAL(angle, -INFINITY, INFINITY),
     .shown = "360 / N"},
    {"paths", "FILE", ".csv or .json: what every ray hit, t to the bit", OF_OUTPUT(paths)},
    {"json", "FILE", "what was drawn, times, rays, bytes", OF_DATA(settings.json)},
    {"show", "WHAT",
     "not the scene, but in false colours, per layout or, with --layout A,B, as the difference B - "
     "A: t, prim, normal of any engine's hits; boxes, triangles (tested), depth (of the stack), "
     "overlap (boxes of leaves that the hit lies in; overlap-all: of all nodes), inflation (of "
     "boxes by their quantisation) of the walk in C; error (of t, in its proven bound), class "
     "(verdict of the judge) of any engine's hits",
     OF_OWN(take_mode)},
    {"benchmark", NULL,
     "ms per frame in place of pictures: benchmark.csv, .json, .svg, .png, written anew every 10 "
     "frames; bench frames compares several",
     OF_ACT(take_mode)},
    {"window", NULL,
     "a window: the left and right arrow keys turn an orbiting camera, Esc ends. Without -w and "
     "-h the picture has the window's size. --out FILE.png is the last picture; without a display "
     "it is the only one, else 77",
     OF_ACT(take_mode)},
    {0},
};

static const struct option_set set = {
    .command = "render",
    .usage = "render [SCENE] [OPTIONS]",
    .about = "Draws a scene with shadows and reflections, each ray traced by an engine.",
    .group = {GROUP(rows), GROUP_AT(render_show_rows, settings),
              GROUP_AT(render_benchmark_rows, settings), GROUP_AT(render_window_rows, settings),
              GROUP_AT(render_rows, settings), GROUP_AT(build_rows, settings.build),
              GROUP_AT(engine_rows, settings.engine_options),
              GROUP_AT(outside_rows, settings.engine_options)},
    .codes = "0, 1 --show class has wrong answers, 2 bad input, or a layout that refuses the "
             "scene, 3 an engine did not finish, 4 no memory, or counts of --show that disagree, "
             "77 the engine cannot run here, 128 + the signal that ended it (--json and --paths "
             "are then of the whole pictures, unless the one being drawn took too long)",
    .example = "render sphere -w 384 -h 288 --out sphere.png\n"
               "render --profile rtrs --handler-bvh-rf --engine vulkan --frames 4",
};

/* The buffers that pictures are drawn into. */
struct render_canvas {
    struct image image;
    struct segment *segment; /* NULL: not kept */
    struct frame frame;
};

static void canvas_free(struct render_canvas *canvas)
{
    image_free(&canvas->image);
    free(canvas->segment);
}

static enum status canvas_make(const struct render *r, const struct render_stage *stage,
                               struct render_canvas *out, struct reason *reason)
{
    *out = (struct render_canvas){.segment = NULL};
    const struct frame_job *job = &stage->job;
    enum status status = image_make(job->width, job->height, &out->image, reason);
    if (status)
        return status;
    size_t segments = (size_t)job->width * job->height * job->look.bounces;
    if (r->paths || segments <= SEGMENT_BYTES / sizeof *out->segment)
        out->segment = alloc_zeroed(segments, sizeof *out->segment);
    if (r->paths && !out->segment)
        return fail(reason, STATUS_MEMORY, "--paths: no memory for %zu segments", segments);
    out->frame = (struct frame){.pixel = out->image.pixel, .segment = out->segment};
    return STATUS_OK;
}

/* How far a run has come. */
struct drawing {
    struct progress progress;
    uint32_t done, of; /* pictures */
};

static void show_progress(void *user, double share)
{
    struct drawing *drawing = user;
    progress_done(&drawing->progress, (uint64_t)(1000 * (drawing->done + share)),
                  1000 * (uint64_t)drawing->of, NULL);
    progress_step(&drawing->progress, "%.0f %% of a picture", 100 * share);
}

static enum status draw_one(const struct render *r, const struct render_stage *stage,
                            struct renderer *renderer, struct render_canvas *canvas, uint32_t i,
                            struct frame_record *record, struct reason *reason)
{
    const struct frame_job *job = &stage->job;
    double step = option_was_given("angle") ? (double)r->angle : 360.0 / r->frames;
    record->angle = i * step * (acos(-1.0) / 180);
    record->view = render_stage_view(stage, record->angle);
    enum status status =
        frame_path(r->settings.out, i + 1, r->frames, record->path, sizeof record->path, reason);
    if (status)
        return status;
    uint64_t start = time_ns();
    status = renderer_frame(renderer, &record->view, &canvas->frame, &record->report, reason);
    record->wall_ns = time_ns() - start;
    if (status)
        return status;
    record->counted = canvas->segment != NULL;
    if (record->counted)
        record->rays =
            frame_count(canvas->segment, (size_t)job->width * job->height, job->look.bounces);
    return image_write(record->path, &canvas->image, reason);
}

static void print_one(const struct render_stage *stage, const struct frame_record *record)
{
    const struct frame_job *job = &stage->job;
    const struct packed *packed = job->job.packed;
    printf("%s: %u x %u, ", record->path, job->width, job->height);
    if (record->counted)
        printf("%s (%llu of them to lights), ",
               COUNTED(record->rays.closest + record->rays.shadow, "ray"),
               (unsigned long long)record->rays.shadow);
    printf("%.1f ms tracing by the %s's clock, %.1f ms in all", (double)record->report.ns * 1e-6,
           record->report.device_clock ? "device" : "host", (double)record->wall_ns * 1e-6);
    if (packed)
        printf(", %s: %s", packed->layout->name,
               COUNTED(packed_node_bytes(packed) + packed_item_bytes(packed), "byte"));
    puts("");
}

/* Draws all pictures. *done counts the finished ones. */
static enum status draw_all(const struct render *r, const struct render_stage *stage,
                            struct renderer *renderer, struct render_canvas *canvas,
                            struct paths_out *paths, struct frame_record *record, uint32_t *done,
                            struct reason *reason)
{
    struct drawing drawing = {progress_make("render"), 0, r->frames};
    struct progress *progress = &drawing.progress;
    renderer_watch(renderer, show_progress, &drawing);
    enum status status = STATUS_OK;
    for (*done = 0; *done < r->frames && !caught && !status; ++*done) {
        struct frame_record *one = &record[*done];
        status = draw_one(r, stage, renderer, canvas, *done, one, reason);
        if (status)
            break;
        if (paths)
            paths_add(paths, *done + 1, stage, canvas->segment);
        if (r->frames == 1) {
            progress_end(progress);
            print_one(stage, one);
        }
        drawing.done = *done + 1;
        progress_step(progress, "%u of %u pictures", *done + 1, r->frames);
    }
    progress_end(progress);
    process_signal_taken();
    if (!status && r->frames > 1) {
        uint64_t ns = 0;
        for (uint32_t i = 0; i < *done; i++)
            ns += record[i].report.ns;
        printf("%u picture%s, %s and on: %.1f ms tracing each by the %s's clock\n", *done,
               plural(*done), *done ? record[0].path : "none",
               *done ? (double)ns * 1e-6 / *done : 0.0,
               *done && record[0].report.device_clock ? "device" : "host");
    }
    return status;
}

/* Draws and writes everything, with stage and renderer open. */
static enum status render(const struct render *r, const struct render_stage *stage,
                          struct renderer *renderer, struct reason *reason)
{
    struct render_canvas canvas;
    struct paths_out paths = {.json = false};
    uint32_t done = 0;
    struct frame_record *record = alloc_zeroed(r->frames, sizeof *record);
    enum status status = canvas_make(r, stage, &canvas, reason);
    if (!record)
        status = fail(reason, STATUS_MEMORY, "no memory for %u pictures", r->frames);
    if (!status && r->paths)
        status = paths_open(r->paths, stage, &r->settings, &paths, reason);
    if (!status)
        status =
            draw_all(r, stage, renderer, &canvas, r->paths ? &paths : NULL, record, &done, reason);
    if (!status && r->paths)
        status = paths_close(&paths, reason);
    if (!status && r->settings.json)
        status = render_json(r->settings.json, &r->settings, stage, record, done, reason);
    file_out_discard(&paths.file);
    canvas_free(&canvas);
    free(record);
    return status;
}

/* Reports output errors before anything is opened. */
static enum status check_outputs(const struct render *r, struct reason *reason)
{
    char path[512];
    enum status status = frame_path(r->settings.out, 1, r->frames, path, sizeof path, reason);
    if (!status)
        status = output_try(path, reason);
    return status ? status : output_try(r->paths, reason);
}

static enum status run(const struct render *r, struct reason *reason)
{
    struct render_stage stage = {0};
    struct renderer *renderer = NULL;
    enum status status = check_outputs(r, reason);
    if (!status)
        status = render_stage_open("render", &r->settings, &stage, reason);
    if (!status && r->frames > 1 && !stage.camera.orbit)
        status =
            fail(reason, STATUS_INPUT,
                 "--frames %u: the scene's camera is fixed; --camera-orbit turns it", r->frames);
    if (!status)
        status = renderer_open(r->settings.engine, &r->settings.engine_options, r->settings.waves,
                               &renderer, reason);
    if (!status)
        status = renderer_prepare(renderer, &stage.job, reason);
    if (!status)
        status = render(r, &stage, renderer, reason);
    renderer_close(renderer);
    render_stage_close(&stage);
    return status;
}

/* Finishes the settings after the options were read: the scene may also be an argument. */
static int finish_options(struct render *r, int argc, char **argv, int first, struct reason *reason)
{
    if (first < argc && r->settings.scene)
        return usage_error("render", "'%s' and --path %s: one scene", argv[first],
                           r->settings.scene);
    if (first + 1 < argc)
        return usage_error("render", "unexpected argument '%s'", argv[first + 1]);
    if (first < argc)
        r->settings.scene = argv[first];
    r->settings.framing = r->frames > 1 ? FRAMING_TURN : FRAMING_MODEL;
    if (render_settings_finish("render", &r->settings, reason))
        return usage_error("render", "%s", reason->text);
    return -1;
}

/* Rejects options that the mode, or plain pictures without one, does not use, including options of
 * other modes. */
static enum status check_use(const struct render *r, struct reason *reason)
{
    char by[40], never[600];
    const struct list engine = list_of_one(TABLE_ENGINES, r->settings.engine);
    snprintf(by, sizeof by, "%s%s", r->mode ? "--" : "pictures", r->mode ? r->mode->name : "");
    snprintf(never, sizeof never, "%s", r->mode ? r->mode->never : "");
    for (size_t m = 0; modes[m]; m++)
        for (size_t i = 0; modes[m] != r->mode && modes[m]->row[i].name; i++)
            text_append(never, sizeof never, " %s", modes[m]->row[i].name);
    const struct option_use of_mode = {.by = by, .never = never};
    const struct option_use alone = {.by = "one picture", .never = r->frames == 1 ? "angle" : ""};
    enum status status = options_check(&of_mode, reason);
    if (!status)
        status = options_check(&alone, reason);
    return status ? status : render_options_check(&r->settings, &engine, reason);
}

int cmd_render(int argc, char **argv)
{
    struct render r = {.settings = render_settings_default()};
    struct reason reason = {""};
    int first, code = options_read(&set, &r, argc, argv, &first);
    if (code < 0)
        code = finish_options(&r, argc, argv, first, &reason);
    if (code >= 0)
        return code;
    if (r.settings.versus && (!r.mode || !r.mode->two_layouts))
        return usage_error("render", "--layout: one; two are for the difference of --show");
    if (check_use(&r, &reason))
        return usage_error("render", "%s", reason.text);
    if (r.mode)
        return r.mode->run(&r.settings, r.mode_value);
    process_signals_caught(&caught);
    enum status status = run(&r, &reason);
    return !status && caught ? 128 + (int)caught : exit_with_reason("render", status, &reason);
}

/* Compares the pipeline made for a scene with the general one. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/bench/cmd_bench.h"
#include "cmd/bench/cmd_bench_frames.h"
#include "cmd/bench/cmd_bench_paper.h"

#include "cmd/common/cmd_grid.h"
#include "ref/base/command.h"
#include "scenes/scenes.h"
#include "ref/base/json_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char about[] =
    "each scene drawn by the pipeline made for it (stack, lights and bounces as its "
    "constants, no more than it needs) and by the general one: the same shader with the "
    "same early exits, its counts read at run time, its constants at their most. Both "
    "must draw the same bits (exit code 1 if not), frame by frame in one run. The ratio "
    "is general to special; exit code 1 if its median is below 1 with 95 % confidence. "
    "Whether a scene without lights and reflections pays for the bounces that were "
    "asked for is shown by a third contestant, which asks for one.\n"
    "";

#define CHECKED_ANGLES 5
#define BOUNCES        4u

extern const struct benchmark bench_special;

enum { SPECIAL, GENERAL, ONE_BOUNCE, CONTESTANTS };

/* A scene, and which of its lights and reflections are kept. */
struct special_scene {
    const char *name, *spec;
    uint32_t lights; /* at most so many of its lights */
    bool dull;       /* reflections are removed */
};

static const struct special_scene scenes[] = {
    {"no lights, no reflection", "sphere:n=20", 0, true},
    {"one light", "cornell:n=8", 1, true},
    {"3 lights, reflection", "rtrs", 3, false},
    {"teapot, 2 lights, reflection", "teapot", 2, false},
};

/* Results of a scene. */
struct special_result {
    struct spread ratio, paid; /* general to special; four bounces to one */
    double ratio_most;         /* upper end of the median's 95 % interval */
    bool equal;                /* the checked frames have the same bits */
    bool slower;               /* special is slower, beyond noise */
};

static void strip(const struct special_scene *what, struct scene *scene)
{
    scene->light_count = scene->light_count < what->lights ? scene->light_count : what->lights;
    for (uint32_t i = 0; what->dull && i < scene->material_count; i++)
        scene->material[i].albedo[2] = 0;
}

static enum status open_scene(const struct special_scene *what, struct scene *out,
                              struct reason *reason)
{
    struct paper_scene paper = {.spec = NULL};
    enum status status = strcmp(what->spec, "teapot") == 0
                             ? paper_scene_open(PAPER_TEAPOT, &paper, reason)
                             : scene_open(what->spec, 1, &paper.scene, reason);
    *out = paper.scene;
    if (!status)
        strip(what, out);
    return status;
}

static enum status enter(struct bench *bench, const struct scene *scene, bool dull,
                         struct frames_session *session, struct reason *reason)
{
    static const char *const names[CONTESTANTS] = {"special", "general", "special, 1 bounce"};
    struct painter_plan plan = {
        .engine = engine_find("vulkan"),
        .layout = bench->layout.count ? layouts_all[bench->layout.index[0]] : layout_find("f32"),
        .builder = builders[0],
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .box = box_tests[0],
        .tri = tri_tests[0],
        .look = {.profile = PROFILE_REPAIRED, .bounces = BOUNCES, .ambience = 0.1f},
        .width = (uint32_t)bench->picture.width,
        .height = (uint32_t)bench->picture.height,
        .tile = 16,
    };
    enum status status = STATUS_OK;
    for (int i = 0; i < (dull ? CONTESTANTS : ONE_BOUNCE) && !status; i++) {
        plan.handler = names[i];
        plan.general = i == GENERAL;
        plan.look.bounces = i == ONE_BOUNCE ? 1 : BOUNCES;
        status = frames_session_enter(session, &plan, scene, &bench->engines, reason);
    }
    return status;
}

/* Checks whether the two pipelines draw the same bits, at some angles of the run. */
static enum status check(struct frames_session *session, bool *equal, struct reason *reason)
{
    struct sheet sheet[2] = {{.width = 0}};
    enum status status = STATUS_OK;
    *equal = true;
    for (int i = 0; i < 2 && !status; i++)
        status = sheet_make(&session->painter[i].plan, &sheet[i], reason);
    for (int k = 0; k < CHECKED_ANGLES && !status && *equal; k++) {
        for (int i = 0; i < 2 && !status; i++) {
            struct frames_sample sample;
            progress_step(session->progress, "%s: comparing", session->label);
            status = painter_sheet(&session->painter[i], 1.25 * k, &sheet[i], &sample, reason);
        }
        *equal = !status && sheet_equal(&sheet[0], &sheet[1]);
    }
    sheet_free(&sheet[0]);
    sheet_free(&sheet[1]);
    return status;
}

static void take_result(const struct frames_session *session, struct special_result *out)
{
    const struct frames_run *run = &session->run;
    if (run->done == 0)
        return;
    out->ratio = frames_ratio(run, GENERAL, SPECIAL);
    for (uint32_t i = 0; i < run->done; i++)
        run->scratch[i] = run->contestant[GENERAL].ms[i] / run->contestant[SPECIAL].ms[i];
    out->ratio_most = spread_median_most(run->scratch, run->done);
    out->slower = out->ratio_most < 1;
    if (run->count > ONE_BOUNCE)
        out->paid = frames_ratio(run, SPECIAL, ONE_BOUNCE);
}

static void add_row(struct bench *bench, const struct special_scene *what,
                    const struct frames_session *session, const struct special_result *result)
{
    const struct frames_run *run = &session->run;
    struct frames_stats special = frames_stats_of(run, SPECIAL);
    struct frames_stats general = frames_stats_of(run, GENERAL);
    bool paid = run->count > ONE_BOUNCE;
    json_t *row = json_record(
        "scene=%s what=%s layout=%s frames=%u bits_equal=%i clock=%s special_ms=%g general_ms=%g "
        "ratio_median=%g ratio_min=%g ratio_max=%g ratio_median_95_most=%g four_to_one_bounce=%g "
        "four_to_one_bounce_min=%g four_to_one_bounce_max=%g",
        what->spec, what->name, session->painter[0].plan.layout->name, run->done, result->equal,
        frames_clock(&run->contestant[SPECIAL]), special.median, general.median,
        result->ratio.median, result->ratio.least, result->ratio.most, result->ratio_most,
        paid ? result->paid.median : NAN, paid ? result->paid.least : NAN,
        paid ? result->paid.most : NAN);
    bench_row(bench, &bench_special, row);
}

static void add_result(struct row_grid *grid, const struct special_scene *what,
                       const struct frames_session *session, const struct special_result *result)
{
    const struct frames_run *run = &session->run;
    char paid[48] = "-\t-";
    if (run->count > ONE_BOUNCE)
        snprintf(paid, sizeof paid, "%.3f\t%.3f-%.3f", result->paid.median, result->paid.least,
                 result->paid.most);
    grid_add(grid, result->equal && !result->slower ? PAINT_GOOD : PAINT_BAD,
             "%s\t%s\t%.3f\t%.3f\t%.3f\t%.3f-%.3f\t%s",
             !result->equal   ? "DIFFERS"
             : result->slower ? "SLOWER"
                              : "agrees",
             what->name, frames_stats_of(run, SPECIAL).median, frames_stats_of(run, GENERAL).median,
             result->ratio.median, result->ratio.least, result->ratio.most, paid);
}

static void measure(struct bench *bench, const struct special_scene *what,
                    struct frames_session *session, struct row_grid *grid)
{
    struct reason reason = {""};
    struct special_result result = {.equal = false};
    struct scene scene;
    enum status status = open_scene(what, &scene, &reason);
    if (status == STATUS_UNSUPPORTED) {
        screen_text(&bench->screen_is, "%s\n", reason.text);
        return;
    }
    session->progress = &bench->progress;
    session->label = what->name;
    session->about.base = SIZE_MAX;
    if (!status)
        status = enter(bench, &scene, what->dull && what->lights == 0, session, &reason);
    if (!status)
        status = check(session, &result.equal, &reason);
    struct frames_settings settings = {.frames = bench->picture.frames
                                                     ? (uint32_t)bench->picture.frames
                                                 : bench->quick ? 20
                                                                : FRAMES_DEFAULT,
                                       .turns = FRAMES_TURNS,
                                       .warm_up = FRAMES_WARM_UP};
    if (!status)
        status = frames_session_measure(session, &settings, &reason);
    progress_end(&bench->progress);
    bench_failed(bench, what->name, status, &reason);
    if (!status && session->run.done > 0) {
        take_result(session, &result);
        add_result(grid, what, session, &result);
        add_row(bench, what, session, &result);
        if (!result.equal || result.slower)
            bench_worse(bench, EXIT_MISMATCH);
    }
    frames_session_free(session);
    scene_free(&scene);
}

static int run(struct bench *bench)
{
    static const struct column columns[] = {{"verdict", .left = true},
                                            {"scene", .left = true},
                                            {.title = "special", .least = TIME_WIDTH},
                                            {.title = "general", .least = TIME_WIDTH},
                                            {.title = "ratio", .least = 6},
                                            {"least-most", .rank = 1, .least = SPAN_WIDTH},
                                            {"paid", .rank = 2, .least = 6},
                                            {"least-most", .rank = 3, .least = SPAN_WIDTH}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    if (bench->layout.count > 1 || bench->scene_count > 0)
        return usage_error("bench", "special: one layout, and its own scenes");
    if (!engine_find("vulkan")->renderer) {
        puts("engine vulkan draws no frames of its own: there is no pipeline to compare");
        return EXIT_SKIPPED;
    }
    struct frames_session *session = calloc(1, sizeof *session);
    if (!session)
        return EXIT_INTERNAL;
    frames_catch_signals();
    for (size_t i = 0; i < ARRAY_COUNT(scenes) && !frames_signal_code(); i++)
        measure(bench, &scenes[i], session, &grid);
    screen_text(&bench->screen_is,
                "ms per frame; ratio: the general pipeline's time to the special one's; paid: that "
                "of 4 bounces to 1, where no ray bounces\n");
    grid_print(&grid, &bench->screen_is);
    free(session);
    return frames_signal_code();
}

const struct benchmark bench_special = {
    .name = "special",
    .shown = "same bits, and no special pipeline is slower",
    .refuted = "bits differ, or a special pipeline is slower",
    .summary = "the pipeline that a scene gets against the general one: same bits, ratio of times",
    .takes = "layout csv json frames size out quick driver device workgroup" BENCH_OUTSIDE
        BENCH_SCREEN,
    .about = about,
    .run = run,
    .alone = true,
    .rows_out = true,
};

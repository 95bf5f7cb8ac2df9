/* Frames of an orbiting camera: engines and layouts take turns. */
#include "cmd/bench/cmd_bench_frames.h"

#include "cmd/bench/cmd_bench.h"
#include "ref/base/command.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

static const char about[] =
    "an orbiting camera at a fixed angle per frame, every engine and layout drawing the "
    "same frame before the next. Engines without a renderer are asked ray by ray: then "
    "only the rays are timed, not the shading, and the clock says so. --scene takes "
    "one; the files are benchmark.* unless --out says otherwise, written anew every 10 "
    "frames. Without --engine and --layout: vulkan on f32 and rf16.";

struct plans {
    struct painter_plan plan[FRAMES_CONTESTANTS];
    char handler[FRAMES_CONTESTANTS][48];
    size_t count;
};

static enum status add(struct plans *plans, const struct painter_plan *model,
                       const struct engine *engine, const struct layout *layout,
                       struct reason *reason)
{
    if (plans->count == FRAMES_CONTESTANTS)
        return fail(reason, STATUS_INPUT, "more than %d engines and layouts", FRAMES_CONTESTANTS);
    struct painter_plan *plan = &plans->plan[plans->count];
    char *handler = plans->handler[plans->count];
    snprintf(handler, sizeof plans->handler[0], "%.30s%s%s", engine->name, layout ? " " : "",
             layout ? layout->name : "");
    *plan = *model;
    plan->handler = handler;
    plan->engine = engine;
    plan->layout = layout;
    plans->count++;
    return STATUS_OK;
}

/* Adds the user's engines and layouts, by default vulkan on f32 and rf16. */
static enum status make_plans(const struct bench *bench, const struct painter_plan *model,
                              struct plans *plans, struct reason *reason)
{
    static const char *const own_engines[] = {"vulkan", NULL};
    static const char *const own_layouts[] = {"f32", "rf16", NULL};
    const void *chosen[LIST_MOST], *layout[LIST_MOST];
    size_t engine_count = bench_members(TABLE_ENGINES, &bench->engine, own_engines, chosen);
    size_t layout_count = bench_members(TABLE_LAYOUTS, &bench->layout, own_layouts, layout);
    enum status status = STATUS_OK;
    for (size_t e = 0; e < engine_count && !status; e++) {
        const struct engine *engine = chosen[e];
        if (!engine->needs_packed)
            status = add(plans, model, engine, NULL, reason);
        for (size_t l = 0; engine->needs_packed && l < layout_count && !status; l++)
            status = add(plans, model, engine, layout[l], reason);
    }
    return status;
}

static const char *base_of(const struct bench *bench)
{
    return bench->picture.out ? bench->picture.out : "benchmark";
}

static enum status measure(struct bench *bench, const char *spec, const struct scene *scene,
                           struct reason *reason)
{
    struct bvh bvh;
    enum status status = bench_tree_make(bench, scene, &bvh, reason);
    if (status)
        return status;
    bool rtrs = bench->picture.profile == PROFILE_RTRS;
    struct painter_plan model = {
        .tree = &bvh,
        .box = bench->box.count ? box_tests[bench->box.index[0]] : box_tests[0],
        .tri = bench->tri.count ? tri_tests[bench->tri.index[0]] : tri_tests[0],
        .look = {.profile = rtrs ? PROFILE_RTRS : PROFILE_REPAIRED,
                 .bounces = (uint32_t)bench->picture.bounces,
                 .ambience = 0.1f},
        .width = (uint32_t)bench->picture.width,
        .height = (uint32_t)bench->picture.height,
        .tile = 16,
    };
    struct frames_settings settings = {
        .frames = bench->picture.frames ? (uint32_t)bench->picture.frames : FRAMES_DEFAULT,
        .turns = (uint32_t)bench->picture.turns,
        .warm_up = (uint32_t)bench->picture.warm_up,
    };
    struct plans *plans = calloc(1, sizeof *plans);
    status = plans ? make_plans(bench, &model, plans, reason)
                   : fail(reason, STATUS_MEMORY, "no memory for the run");
    if (!status)
        bench->row_count += plans->count;
    if (!status)
        bench_worse(bench,
                    frames_command("bench", plans->plan, plans->count, spec, scene, &bench->engines,
                                   &settings, base_of(bench), &bench->screen_is));
    free(plans);
    bvh_free(&bvh);
    return status;
}

static int run(struct bench *bench)
{
    struct reason reason = {""};
    const char *spec = bench->scene_count ? bench->scene[0] : bench_frames.scenes;
    if (bench->scene_count > 1 || bench->box.count > 1 || bench->tri.count > 1)
        return usage_error("bench", "frames: one scene, one box test and one triangle test");
    struct scene scene = {0};
    enum status status = frames_try(base_of(bench), &reason);
    if (!status)
        status = scene_open(spec, bench->seed, &scene, &reason);
    if (!status)
        status = measure(bench, spec, &scene, &reason);
    scene_free(&scene);
    bench_failed(bench, NULL, status, &reason);
    return bench->code;
}

const struct benchmark bench_frames = {
    .name = "frames",
    .shown = "times, no picture is judged",
    .summary = "frames of an orbiting camera: ms per frame, engines and layouts by turns",
    .takes = "scene seed engine layout tri box bvh frames size out turns warm-up bounces "
             "profile" BENCH_MACHINE BENCH_OUTSIDE " wide",
    .about = about,
    .scenes = "rtrs",
    .run = run,
    .alone = true,
    .undrawn = true,
};

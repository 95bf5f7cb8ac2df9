/* Options of pictures. */
#include "cmd/common/cmd_use.h"
#include "bench/frames/frames.h"
#include "ref/base/command.h"
#include "cmd/render/cmd_render.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct render_handler render_handlers[] = {
    {"naive",
     {{"median", "f32", "robust", "mt", 4}, {"rtrs", "rtrs_direct", "rtrs", "mt_rtrs", 2}}},
    {"bvh", {{"median", "f32", "robust", "mt", 4}, {"rtrs", "rtrs_direct", "rtrs", "mt_rtrs", 2}}},
    {"bvh-rf", {{"median", "rf16", "robust", "mt", 4}, {"rtrs", "rtrs_rf", "rtrs", "mt_rtrs", 4}}},
    {"blank",
     {{"median", "f32", "robust", "mt", 4}, {"rtrs", "rtrs_direct", "rtrs", "mt_rtrs", 2}}},
    {NULL, {{0}, {0}}},
};

struct render_settings render_settings_default(void)
{
    return (struct render_settings){
        .engine_options = engine_options_default(),
        .build = {.eps = BUILD_EPS_DEFAULT},
        .benchmark = {FRAMES_DEFAULT, FRAMES_TURNS, FRAMES_WARM_UP, NULL},
    };
}

static enum status take_handler(const char *name, struct render_settings *out,
                                struct reason *reason)
{
    for (const struct render_handler *handler = render_handlers; handler->name; handler++)
        if (strcmp(handler->name, name) == 0) {
            out->handler = handler;
            return STATUS_OK;
        }
    return fail(reason, STATUS_INPUT, "--handler: '%s' is not naive, bvh, bvh-rf or blank", name);
}

/* Reads --handler NAME, or --handler-NAME as in RTRS. A value after it is a box size if it parses
 * as a number, even if a file has that name; else the path of a tree file. */
static enum status take_handlers(void *options, const struct option_value *given,
                                 struct reason *reason)
{
    struct render_settings *out = options;
    const char *dash = strchr(given->row->name, '-');
    struct reason unread;
    float eps;
    if (dash && given->text && parse_float("--eps", given->text, &eps, &unread))
        out->bvh = given->text;
    else if (dash && given->text)
        out->build.eps = eps;
    if (out->handler)
        return fail(reason, STATUS_INPUT, "--%s: a handler is named already", given->row->name);
    return take_handler(dash ? dash + 1 : given->text, out, reason);
}

/* Reads one layout, or two for a mode that compares. */
static enum status take_layouts(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct render_settings *out = options;
    struct list list = {.count = 0};
    out->layout_auto = strcmp(given->text, "auto") == 0;
    if (out->layout_auto)
        return STATUS_OK;
    enum status status = table_parse(TABLE_LAYOUTS, "--layout", given->text, &list, reason);
    if (status)
        return status;
    if (list.count > 2)
        return fail(reason, STATUS_INPUT,
                    "--layout: '%s' names %zu layouts, at most two are compared", given->text,
                    list.count);
    out->layout = layouts_all[list.index[0]];
    out->versus = list.count > 1 ? layouts_all[list.index[1]] : NULL;
    return STATUS_OK;
}

static enum status take_turn(void *options, const struct option_value *given, struct reason *reason)
{
    struct render_settings *out = options;
    const bool fixed = strcmp(given->row->name, "camera-fixed") == 0;
    if (out->turn == (fixed ? RENDER_ORBIT : RENDER_FIXED))
        return fail(reason, STATUS_INPUT, "--camera-fixed and --camera-orbit: one of them");
    out->turn = fixed ? RENDER_FIXED : RENDER_ORBIT;
    return STATUS_OK;
}

static const char *const profiles[] = {
    [PROFILE_REPAIRED] = "repaired", [PROFILE_RTRS] = "rtrs", NULL};
static const char *const plans[] = {
    [FRAME_AUTO] = "auto", [FRAME_WHOLE] = "whole", [FRAME_STEPS] = "steps", NULL};
static const char *const handlers[] = {"naive", "bvh", "bvh-rf", "blank", NULL};

#define ROWS_OF struct render_settings

const struct option_row render_rows[] = {
    {"path", "SCENE", "a mesh file (.json .obj .ply .stl, also .gz) or a generator", OF_FILE(scene),
     .shown = RENDER_SCENE_DEFAULT},
    SEED_ROW(seed),
    {"width", "W",
     "pixels. Without a workgroup size it is the greatest common divisor of width and height, or "
     "16 if that is larger",
     OF_COUNT(width, 1, FRAME_SIDE_MOST), .letter = 'w'},
    {"height", "H", "pixels; both are given, or neither", OF_COUNT(height, 1, FRAME_SIDE_MOST),
     .letter = 'h'},
    {"workgroup-size", "N", "invocations along a side, at most 16; alone: a picture of 800x600",
     OF_COUNT(tile, 1, FRAME_SIDE_MOST), .standard = FRAME_TILE_MOST},
    {"profile", "P", "repaired: what is right; rtrs: the published shader, faults included",
     OF_CHOICE(look.profile, profiles), .value = "repaired"},
    {"bounces", "N", "segments of a path", OF_COUNT(look.bounces, 0, FRAME_BOUNCES_MOST),
     .value = "4"},
    {"ambience", "A", "light from everywhere; the published shader does not read it",
     OF_REAL(look.ambience, 0, INFINITY), .value = "0"},
    {"camera-light-strength", "S", "a light at the eye; 1 in a scene without light",
     OF_REAL(look.camera_light, 0, INFINITY), .value = "0"},
    {"camera-fixed", NULL, "in place of what the scene has", OF_ACT(take_turn)},
    {"camera-orbit", NULL, "likewise", OF_ACT(take_turn)},
    {"handler", "H",
     "naive: every triangle; bvh: 32-byte nodes (rtrs: 48); bvh-rf: 16-byte nodes; blank: no "
     "triangle",
     OF_OWN(take_handlers), .choice = handlers, .shown = "bvh"},
    {"handler-naive", NULL, "as RTRS spells it", OF_ACT(take_handlers)},
    {"handler-bvh", "EPS|FILE", "likewise, with --eps or --bvh", OF_OWN(take_handlers),
     .file = true, .optional = true},
    {"handler-bvh-rf", "EPS|FILE", "likewise", OF_OWN(take_handlers), .file = true,
     .optional = true},
    {"handler-blank", NULL, "likewise", OF_ACT(take_handlers)},
    {"engine", "E", "see raydiff list engines", OF_MEMBER(engine, TABLE_ENGINES), .shown = "cpu"},
    {"layout", "L", "in place of the handler's, see raydiff list; auto is the first that fits",
     OF_OWN(take_layouts), .table = 1 + TABLE_LAYOUTS},
    {"builder", "B", "in place of the handler's", OF_MEMBER(builder, TABLE_BUILDERS)},
    {"box", "T", "box test, in place of the handler's", OF_MEMBER(box, TABLE_BOX_TESTS)},
    {"tri", "T", "triangle test, in place of the handler's", OF_MEMBER(tri, TABLE_TRI_TESTS)},
    {"leaf", "N", "items per leaf, in place of the handler's", OF_COUNT(build.leaf, 1, UINT32_MAX)},
    {"eps", "E", "builder rtrs: smallest box that is split",
     OF_REAL(build.eps, -INFINITY, INFINITY), .standard = BUILD_EPS_DEFAULT},
    {"waves", NULL, "all rays of a step through the engine, even if it draws on its own",
     OF_FLAG(waves)},
    {"plan", "P", "an engine that draws on its own: whole paths, steps, or auto",
     OF_CHOICE(plan, plans), .value = "auto"},
    {"general", NULL, "an engine that draws on its own: with the pipeline that suits every scene",
     OF_FLAG(general)},
    TREE_ROW(bvh),
    {0},
};

static uint32_t common_divisor(uint32_t a, uint32_t b)
{
    while (b) {
        uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* RTRS has three forms: a workgroup size alone draws at the window's size, a picture size alone
 * sets the workgroup size, or both are given. A workgroup of more than 256 invocations becomes 16 x
 * 16. */
static enum status finish_size(const char *command, struct render_settings *s,
                               struct reason *reason)
{
    if ((s->width == 0) != (s->height == 0))
        return fail(reason, STATUS_INPUT, "%s is missing: give both or neither",
                    s->width ? "--height" : "--width");
    if (s->tile > FRAME_TILE_MOST)
        fprintf(stderr,
                "raydiff %s: --workgroup-size %u is %u invocations, over 256: taken as %u\n",
                command, s->tile, s->tile * s->tile, FRAME_TILE_MOST);
    if (s->tile == 0)
        s->tile = s->width ? common_divisor(s->width, s->height) : FRAME_TILE_MOST;
    if (s->tile > FRAME_TILE_MOST)
        s->tile = FRAME_TILE_MOST;
    s->resizable = s->width == 0;
    if (s->width == 0) {
        s->width = RENDER_WINDOW_WIDTH;
        s->height = RENDER_WINDOW_HEIGHT;
    }
    return STATUS_OK;
}

enum status render_engine(const struct render_settings *settings, const struct engine *engine,
                          const struct engine **out, struct reason *reason)
{
    static const char *const of[][2] = {{"cpu", "brute"},
                                        {"brute", "brute"},
                                        {"vulkan", "vulkan_brute"},
                                        {"vulkan_brute", "vulkan_brute"}};
    *out = engine;
    if (strcmp(settings->handler->name, "naive") != 0)
        return STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(of); i++)
        if (strcmp(engine->name, of[i][0]) == 0) {
            *out = engine_find(of[i][1]);
            return STATUS_OK;
        }
    return fail(reason, STATUS_INPUT,
                "--handler naive tests every triangle and needs engine cpu or vulkan, not %s",
                engine->name);
}

enum status render_settings_finish(const char *command, struct render_settings *s,
                                   struct reason *reason)
{
    enum status status = finish_size(command, s, reason);
    if (!status && !s->handler)
        status = take_handler("bvh", s, reason);
    if (status)
        return status;
    status = tree_check_options(s->bvh, 1, reason);
    if (status)
        return status;
    size_t i = s->look.profile;
    static char standard[] = RENDER_SCENE_DEFAULT;
    s->scene = s->scene ? s->scene : standard;
    s->builder = s->builder ? s->builder : builder_find(s->handler->member[i].builder);
    s->build.leaf = s->build.leaf ? s->build.leaf : s->handler->member[i].leaf;
    if (!s->layout && !s->layout_auto && !s->bvh)
        s->layout = layout_find(s->handler->member[i].layout);
    s->box = s->box ? s->box : box_test_find(s->handler->member[i].box);
    s->tri = s->tri ? s->tri : tri_test_find(s->handler->member[i].tri);
    return render_engine(s, s->engine ? s->engine : engine_reference(true), &s->engine, reason);
}

enum status render_options_check(const struct render_settings *s, const struct list *engine,
                                 struct reason *reason)
{
    struct list layout = list_of_one(TABLE_LAYOUTS, s->layout);
    const struct list builder = list_of_one(TABLE_BUILDERS, s->builder);
    bool draws = false;
    list_add(&layout, TABLE_LAYOUTS, s->versus);
    for (size_t i = 0; i < engine->count; i++)
        draws = draws || (engines[engine->index[i]]->renderer && !s->waves);
    const struct option_use members = {.engine = engine,
                                       .layout = &layout,
                                       .builder = &builder,
                                       .scene = (char *const[]){s->scene},
                                       .scene_count = 1};
    const struct option_use look = {.by = "the published shader",
                                    .never = s->look.profile == PROFILE_RTRS ? "ambience" : ""};
    const struct option_use of_plans = {.by = "engines that do not draw on their own",
                                        .never = draws ? "" : "plan general"};
    enum status status = options_check(&members, reason);
    if (!status)
        status = options_check(&look, reason);
    return status ? status : options_check(&of_plans, reason);
}

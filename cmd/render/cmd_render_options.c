/* Options of pictures. */
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "cmd/render/cmd_render.h"

#include <stdio.h>
#include <string.h>

const char render_options_help[] =
    "  --path SCENE    a mesh file (.json .obj .ply, also .gz) or a generator    [rtrs]\n"
    "  --seed S        of a generator                                            [1]\n"
    "  -w, --width W   pixels, 1 to 16384; with -h, --height H. Without a workgroup size it is\n"
    "                  their greatest common divisor, or 16 if that is larger\n"
    "  --workgroup-size N  invocations along a side, 1 to 16; alone: a picture of 800x600 [16]\n"
    "  --profile P     repaired: what is right; rtrs: the published shader, faults included\n"
    "                                                                            [repaired]\n"
    "  --bounces N     segments of a path, 0 to 64                               [4]\n"
    "  --ambience A    light from everywhere; the published shader reads it not  [0]\n"
    "  --camera-light-strength S  a light at the eye; 1 in a scene without light [0]\n"
    "  --camera-fixed, --camera-orbit  in place of what the scene says\n"
    "  --fps N         pictures a second of a window                             [60]\n"
    "  --handler H     naive: every triangle; bvh: 32-byte nodes (rtrs: 48); bvh-rf: 16-byte\n"
    "                  nodes; blank: no triangle                                 [bvh]\n"
    "  --handler-naive, --handler-bvh [EPS|FILE], --handler-bvh-rf [EPS|FILE], --handler-blank\n"
    "                  RTRS's spelling, FILE is --bvh\n"
    "  --engine E      see raydiff list engines                                  [cpu]\n"
    "  --layout L, --builder B, --box T, --tri T, --leaf N, --eps E   see raydiff list; in place\n"
    "                  of the handler's. --layout auto is the first that fits\n"
    "  --waves         all rays of a step through the engine, even if it draws on its own\n"
    "  --plan P        an engine that draws on its own: whole paths, steps, or auto [auto]\n"
    "  --general       with the pipeline that suits every scene\n" BUILD_OPTIONS_HELP
        TREE_OPTION_HELP;

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
        .seed = 1,
        .look = {.profile = PROFILE_REPAIRED, .bounces = 4},
        .engine_options = engine_options_default(),
        .build = {.eps = BUILD_EPS_DEFAULT},
        .fps = 60,
        .out = "render.png",
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

/* As RTRS: what reads as a number is one, whatever files there are. */
static enum status take_handler_from(const char *handler, char *text, struct render_settings *out,
                                     struct reason *reason)
{
    struct reason unread;
    float eps;
    if (parse_float("--eps", text, &eps, &unread))
        out->bvh = text;
    else
        out->build.eps = eps;
    return take_handler(handler, out, reason);
}

static enum status take_profile(const char *text, struct render_settings *out,
                                struct reason *reason)
{
    bool rtrs = strcmp(text, "rtrs") == 0;
    if (!rtrs && strcmp(text, "repaired") != 0)
        return fail(reason, STATUS_INPUT, "--profile: '%s' is neither rtrs nor repaired", text);
    out->look.profile = rtrs ? PROFILE_RTRS : PROFILE_REPAIRED;
    return STATUS_OK;
}

static enum status take_plan(const char *text, struct render_settings *out, struct reason *reason)
{
    static const char *const name[] = {
        [FRAME_AUTO] = "auto", [FRAME_WHOLE] = "whole", [FRAME_STEPS] = "steps"};
    for (size_t i = 0; i < ARRAY_COUNT(name); i++)
        if (strcmp(text, name[i]) == 0) {
            out->plan = (enum frame_plan)i;
            return STATUS_OK;
        }
    return fail(reason, STATUS_INPUT, "--plan: '%s' is not auto, whole or steps", text);
}

static enum status take_strength(const char *flag, const char *text, float *out,
                                 struct reason *reason)
{
    enum status status = parse_float(flag, text, out, reason);
    if (!status && *out < 0)
        return fail(reason, STATUS_INPUT, "%s: '%s' is below 0", flag, text);
    return status;
}

/* One, or two for a mode that compares. */
static enum status take_layouts(const char *text, struct render_settings *out,
                                struct reason *reason)
{
    struct list list = {.count = 0};
    out->layout_auto = strcmp(text, "auto") == 0;
    out->layout = out->versus = NULL;
    if (out->layout_auto)
        return STATUS_OK;
    enum status status = table_parse(TABLE_LAYOUTS, "--layout", text, &list, reason);
    if (status)
        return status;
    if (list.count > 2)
        return fail(reason, STATUS_INPUT, "--layout: '%s' are %zu, at most two are compared", text,
                    list.count);
    out->layout = layouts_all[list.index[0]];
    out->versus = list.count > 1 ? layouts_all[list.index[1]] : NULL;
    return STATUS_OK;
}

/* Members of tables. */
static enum status take_member(int option, const char *text, struct render_settings *out,
                               struct reason *reason)
{
    size_t i = 0;
    enum status status = STATUS_OK;
    switch (option) {
    case OPT_RENDER_ENGINE:
        status = table_parse_one(TABLE_ENGINES, "--engine", text, &i, reason);
        out->engine = status ? NULL : engines[i];
        return status;
    case OPT_RENDER_LAYOUT:
        return take_layouts(text, out, reason);
    case OPT_RENDER_BUILDER:
        status = table_parse_one(TABLE_BUILDERS, "--builder", text, &i, reason);
        out->builder = status ? NULL : builders_all[i];
        return status;
    case OPT_RENDER_BOX:
        status = table_parse_one(TABLE_BOX_TESTS, "--box", text, &i, reason);
        out->box = status ? NULL : box_tests[i];
        return status;
    default:
        status = table_parse_one(TABLE_TRI_TESTS, "--tri", text, &i, reason);
        out->tri = status ? NULL : tri_tests[i];
        return status;
    }
}

static enum status take_number(int option, const char *text, struct render_settings *out,
                               struct reason *reason)
{
    uint64_t n = 0;
    enum status status;
    switch (option) {
    case OPT_RENDER_SEED:
        return parse_count("--seed", text, 0, UINT64_MAX, &out->seed, reason);
    case OPT_RENDER_WIDTH:
        status = parse_count("--width", text, 1, FRAME_SIDE_MOST, &n, reason);
        out->width = (uint32_t)n;
        return status;
    case OPT_RENDER_HEIGHT:
        status = parse_count("--height", text, 1, FRAME_SIDE_MOST, &n, reason);
        out->height = (uint32_t)n;
        return status;
    case OPT_RENDER_TILE:
        status = parse_count("--workgroup-size", text, 1, FRAME_SIDE_MOST, &n, reason);
        out->tile = (uint32_t)n;
        return status;
    case OPT_RENDER_BOUNCES:
        status = parse_count("--bounces", text, 0, FRAME_BOUNCES_MOST, &n, reason);
        out->look.bounces = (uint32_t)n;
        return status;
    case OPT_RENDER_LEAF:
        status = parse_count("--leaf", text, 1, UINT32_MAX, &n, reason);
        out->build.leaf = (uint32_t)n;
        return status;
    case OPT_RENDER_AMBIENCE:
        return take_strength("--ambience", text, &out->look.ambience, reason);
    case OPT_RENDER_EYE:
        out->eye_given = true;
        return take_strength("--camera-light-strength", text, &out->look.camera_light, reason);
    case OPT_RENDER_EPS:
        return parse_float("--eps", text, &out->build.eps, reason);
    default:
        status = parse_float("--fps", text, &out->fps, reason);
        if (!status && !(out->fps > 0))
            return fail(reason, STATUS_INPUT, "--fps: '%s' is not above 0", text);
        return status;
    }
}

enum status render_option_take(int option, char *text, struct render_settings *out,
                               struct reason *reason)
{
    switch (option) {
    case OPT_RENDER_PATH:
        out->scene = text;
        return STATUS_OK;
    case OPT_BVH:
        out->bvh = text;
        return STATUS_OK;
    case OPT_RENDER_PROFILE:
        return take_profile(text, out, reason);
    case OPT_RENDER_PLAN:
        return take_plan(text, out, reason);
    case OPT_RENDER_CAMERA_FIXED:
    case OPT_RENDER_CAMERA_ORBIT:
        out->turn = option == OPT_RENDER_CAMERA_FIXED ? RENDER_FIXED : RENDER_ORBIT;
        return STATUS_OK;
    case OPT_RENDER_WAVES:
        out->waves = true;
        return STATUS_OK;
    case OPT_RENDER_GENERAL:
        out->general = true;
        return STATUS_OK;
    case OPT_RENDER_HANDLER:
        return take_handler(text, out, reason);
    case OPT_RENDER_NAIVE:
        return take_handler("naive", out, reason);
    case OPT_RENDER_BVH:
        return take_handler("bvh", out, reason);
    case OPT_RENDER_BVH_RF:
        return take_handler("bvh-rf", out, reason);
    case OPT_RENDER_BLANK:
        return take_handler("blank", out, reason);
    case OPT_RENDER_BVH_FROM:
        return take_handler_from("bvh", text, out, reason);
    case OPT_RENDER_BVH_RF_FROM:
        return take_handler_from("bvh-rf", text, out, reason);
    case OPT_RENDER_ENGINE:
    case OPT_RENDER_LAYOUT:
    case OPT_RENDER_BUILDER:
    case OPT_RENDER_BOX:
    case OPT_RENDER_TRI:
        return take_member(option, text, out, reason);
    case OPT_BINS:
    case OPT_RADIUS:
    case OPT_SPLIT_BUDGET:
    case OPT_SPLIT_ALPHA:
    case OPT_OPTIMIZE:
        return build_option_take(option, text, &out->build, &out->build_flag, reason);
    default:
        if (option >= OPT_RENDER_FIRST && option <= OPT_RENDER_LAST)
            return take_number(option, text, out, reason);
        return engine_option_take(option, text, &out->engine_options, reason);
    }
}

int render_options_take(const char *command, void (*print_help)(void), const struct option *table,
                        option_fn *take, void *user, int argc, char **argv, int *first)
{
    static char width[] = "--width", height[] = "--height", bvh[] = "--handler-bvh-from",
                bvh_rf[] = "--handler-bvh-rf-from";
    for (int i = 1; i + 1 < argc && strcmp(argv[i], "--") != 0; i++) {
        bool word = argv[i + 1][0] != '-';
        if (strcmp(argv[i], "-w") == 0)
            argv[i] = width;
        else if (strcmp(argv[i], "-h") == 0)
            argv[i] = height;
        else if (strcmp(argv[i], "--handler-bvh") == 0 && word)
            argv[i] = bvh;
        else if (strcmp(argv[i], "--handler-bvh-rf") == 0 && word)
            argv[i] = bvh_rf;
    }
    return options_take(command, print_help, table, take, user, argc, argv, first);
}

static uint32_t common_divisor(uint32_t a, uint32_t b)
{
    while (b) {
        uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* RTRS's three forms: a workgroup size alone is a window's size, a picture's size alone gives
 * the workgroup's, or both. A workgroup of more than 256 invocations becomes one of 16 x 16. */
static enum status finish_size(const char *command, struct render_settings *s,
                               struct reason *reason)
{
    if ((s->width == 0) != (s->height == 0))
        return fail(reason, STATUS_INPUT, "%s is missing: both or neither are given",
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
                "--handler naive is every triangle, on engine cpu or vulkan, not on %s",
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
    return render_engine(s, s->engine ? s->engine : engine_find("cpu"), &s->engine, reason);
}

enum status render_options_check(const struct render_settings *s, const struct list *engine,
                                 struct reason *reason)
{
    struct list layout = {.count = 0}, builder = {.count = 0};
    bool draws = false;
    for (size_t i = 0; layouts_all[i]; i++)
        if (layouts_all[i] == s->layout || layouts_all[i] == s->versus)
            layout.index[layout.count++] = i;
    for (size_t i = 0; builders_all[i]; i++)
        if (builders_all[i] == s->builder)
            builder.index[builder.count++] = i;
    for (size_t i = 0; i < engine->count; i++)
        draws = draws || (engines[engine->index[i]]->frame && !s->waves);
    const struct option_use members = {.engine = engine,
                                       .layout = &layout,
                                       .builder = &builder,
                                       .scene = (char *const[]){s->scene},
                                       .scene_count = 1};
    const struct option_use look = {.by = "the published shader",
                                    .never = s->look.profile == PROFILE_RTRS ? "ambience" : ""};
    const struct option_use plans = {.by = "engines that do not draw on their own",
                                     .never = draws ? "" : "plan general"};
    enum status status = options_check(&members, reason);
    if (!status)
        status = options_check(&look, reason);
    return status ? status : options_check(&plans, reason);
}
